// What pictures are compared with, from a file: shared by `verify` and `bench`.
#pragma once

#include <weir/graph/compile.h>
#include <weir/image/image.h>
#include <weir/render/stage.h>

#include <cstdint>
#include <string>

namespace weir::render {

/// InputError unless each side is 1 … 16384 pixels.
void requireSize(uint32_t width, uint32_t height);
/// InputError, with the nearest name, unless the graph has that output and it is a picture. `file`: of the graph.
void requirePicture(const graph::CompiledGraph& graph, const std::string& file, const std::string& output);
/// Reads radiance, of that size or of any. InputError: a PNG, another size, pixels that are not finite.
image::Picture readRadiance(const std::string& file, uint32_t width, uint32_t height);
image::Picture readRadiance(const std::string& file);
/// InputError when the picture's header names another scene, camera, lights, shading or moment than the stage shows.
/// `animation`: as in pictures' headers.
void requireSameSubject(const Stage& stage, const std::string& animation, const std::string& file,
                        const image::Picture& picture);

}  // namespace weir::render
