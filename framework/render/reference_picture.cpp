#include <fmt/format.h>
#include <weir/core/error.h>
#include <weir/core/text.h>
#include <weir/image/evidence.h>
#include <weir/image/metrics.h>
#include <weir/render/reference_picture.h>

#include <functional>
#include <vector>

namespace weir::render {

void requireSize(uint32_t width, uint32_t height) {
  if (width == 0 || height == 0 || width > 16384 || height > 16384)
    throw InputError(fmt::format("--size {}x{}: each side must be 1 … 16384", width, height));
}

void requirePicture(const graph::CompiledGraph& graph, const std::string& file, const std::string& output) {
  std::vector<std::string> known;
  for (const graph::GraphOutput& each : graph.outputs) known.push_back(each.name);
  const graph::GraphOutput* found = graph.findOutput(output);
  if (found == nullptr) {
    const std::string nearest = nearestName(output, known);
    throw InputError(fmt::format("graph {} has no output '{}'{}", file, output,
                                 nearest.empty() ? "" : " (nearest: '" + nearest + "')"));
  }
  if (graph.resources[found->resource].type.kind != PortKind::Image)
    throw InputError(fmt::format("output '{}' of graph {} is a buffer, not a picture", output, file));
}

namespace {

image::Picture readRadianceOf(const std::string& file, const std::function<void(const image::Picture&)>& check) {
  if (image::fileKind(file) == image::FileKind::Png)
    throw InputError(fmt::format("'{}' is a PNG: display values are no reference for radiance", file));
  image::Picture picture = image::readPicture(file);
  check(picture);
  if (const image::NonFinite bad = image::findNonFinite(picture); bad.pixels > 0)
    throw InputError(
        fmt::format("'{}' has {} pixels that are not finite, the first at {}, {}", file, bad.pixels, bad.x, bad.y));
  return picture;
}

}  // namespace

image::Picture readRadiance(const std::string& file, uint32_t width, uint32_t height) {
  return readRadianceOf(file, [&](const image::Picture& picture) {
    if (picture.width != width || picture.height != height)
      throw InputError(
          fmt::format("'{}' is {}x{} pixels, --size {}x{}", file, picture.width, picture.height, width, height));
  });
}

image::Picture readRadiance(const std::string& file) {
  return readRadianceOf(file, [](const image::Picture&) {});
}

void requireSameSubject(const Stage& stage, const std::string& animation, const std::string& file,
                        const image::Picture& picture) {
  image::Picture own;
  own.attributes = {{"weir.scene", stage.sceneLabel},
                    {"weir.camera", stage.cameraLabel},
                    {"weir.lights", stage.lightsLabel},
                    {"weir.shading", stage.shadingLabel},
                    {"weir.animation", animation}};
  const std::vector<std::string> conflicts = image::attributeConflicts(own, picture);
  if (!conflicts.empty())
    throw InputError(
        fmt::format("'{}' shows something else than is rendered here:\n  {}", file, fmt::join(conflicts, "\n  ")));
}

}  // namespace weir::render
