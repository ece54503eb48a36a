// What stands in the headers of pictures: `weir compare` and others tell by it what a picture shows.
#pragma once

#include <weir/graph/compile.h>
#include <weir/render/stage.h>

#include <cstdint>
#include <map>
#include <string>

namespace weir::render {

struct PictureFacts {
  std::string graphFile;
  std::string camera, lights;      ///< labels, as the stage's
  std::string animation = "none";  ///< animationLabel(), or "none"
  uint32_t seed = 0, restarts = 1, frames = 1, firstFrame = 0, average = 1;
};

/// Attributes "weir.…" of a picture of the graph's size.
std::map<std::string, std::string> pictureHeader(const PictureFacts& facts, const Stage& stage,
                                                 const graph::CompiledGraph& graph);

/// A camera's numbers: equal for equal cameras.
std::string cameraLabel(const scene::Camera& camera);

}  // namespace weir::render
