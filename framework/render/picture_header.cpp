#include <fmt/format.h>
#include <weir/render/picture_header.h>

#include <filesystem>

namespace weir::render {

std::map<std::string, std::string> pictureHeader(const PictureFacts& facts, const Stage& stage,
                                                 const graph::CompiledGraph& graph) {
  std::map<std::string, std::string> h;
  h["weir.scene"] = stage.sceneLabel;
  h["weir.camera"] = facts.camera;
  h["weir.lights"] = facts.lights;
  h["weir.shading"] = stage.shadingLabel;
  h["weir.animation"] = facts.animation;
  h["weir.graph"] = fmt::format("{} ({})", graph.name, std::filesystem::path(facts.graphFile).filename().string());
  std::string params;
  for (const graph::CompiledPass& pass : graph.passes) {
    for (const auto& [name, value] : pass.params) params += fmt::format("{}.{}={} ", pass.name, name, toText(value));
  }
  h["weir.params"] = params;
  h["weir.seed"] = std::to_string(facts.seed);
  h["weir.restarts"] = std::to_string(facts.restarts);
  h["weir.size"] = fmt::format("{}x{}", graph.width, graph.height);
  h["weir.frames"] = fmt::format("{} from {}, mean of last {}, {} restarts", facts.frames, facts.firstFrame,
                                 facts.average, facts.restarts);
  return h;
}

std::string cameraLabel(const scene::Camera& c) {
  return fmt::format("eye {:.9g} {:.9g} {:.9g} forward {:.9g} {:.9g} {:.9g} up {:.9g} {:.9g} {:.9g} vfov {:.9g}",
                     c.eye.x, c.eye.y, c.eye.z, c.forward.x, c.forward.y, c.forward.z, c.up.x, c.up.y, c.up.z,
                     glm::degrees(c.verticalFov));
}

}  // namespace weir::render
