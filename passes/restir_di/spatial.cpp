#include "common/layouts.h"
#include "restir_di/restir_di.h"

#include <algorithm>
#include <cctype>
#include <string>

namespace weir::passes {

void describeReuse(PassDescription& d) {
  d.param("mis", "pairwise")
      .oneOf({"biased", "z", "balance", "pairwise"})
      .specialises()
      .doc(
          "MIS weights: biased (by confidence alone, darkens at edges), z (by the confidence of those that could have "
          "found the sample), balance (balance heuristic, cost grows with the square of the neighbours) or defensive "
          "pairwise; all but biased are unbiased with visibilityRays in every reuse, or with neither those nor "
          "Initial.visibility");
  d.param("zThreshold", 0.01f)
      .range(0, 1)
      .doc(
          "By z: a surface counts among those that could have found a sample where the sample's target is at least so "
          "much of what it is at this pixel. 0: wherever it isn't zero (Bitterli et al. 2020), with no bound on the "
          "variance");
  d.param("visibilityRays", false)
      .specialises()
      .doc(
          "Include visibility in the MIS weights and retest the survivor; without, reuse is unbiased only if "
          "Initial.visibility is off and Initial.bsdfRays 0");
  d.param("sparseRays", true)
      .doc(
          "With visibilityRays, by pairwise: ask one neighbour alone, picked by chance, whether it sees the own "
          "sample, "
          "and let what that changes stand for all; else a ray for each neighbour. Unbiased either way");
  d.param("depthThreshold", 0.1f).range(0, 10).doc("Greatest difference of distance, relative to the distance");
  d.param("normalThreshold", 25.0f).range(0, 180).unit("degrees").doc("Greatest angle between shading normals");
  d.param("albedoThreshold", 1.0f)
      .range(0, 1)
      .doc("Greatest difference of diffuse albedo in any channel; 1 accepts all");
}

Kernel reuseKernel(PrepareContext& c, const char* file, KernelOptions options) {
  std::string mis = c.text("mis");
  std::ranges::transform(mis, mis.begin(),
                         [](unsigned char letter) { return static_cast<char>(std::toupper(letter)); });
  options.defines.emplace_back("MIS_" + mis, "1");
  if (!c.boolean("visibilityRays")) return c.kernel(file, options);
  options.defines.emplace_back("VISIBILITY_RAYS", "1");
  return c.rayKernel(file, options);
}

void Spatial::describe(PassDescription& d) {
  d.doc("Merges each pixel's reservoirs with those of pixels around it");
  d.input("surface", perPixel<PackedSurface>());
  d.input("reservoirs", perPixel<Reservoir>()).anyCount();
  d.output("reservoirs", perPixel<Reservoir>()).countOf("reservoirs").passesThrough("reservoirs");
  d.output("light", storageImage(Format::RGBA32F))
      .radiance()
      .absentWhenDisabled()
      .doc("Of all that each pixel merged what it would send to the viewer if all were seen, for Shade");
  d.param("iterations", 1).range(1, 4).doc("How often; each works on what the one before it left");
  d.param("neighbours", 4).range(1, 16).doc("Pixels that are tried in each iteration");
  d.param("radius", 30.0f).range(1, 1024).unit("px").doc("They lie uniformly in a disc of this radius");
  describeReuse(d);
  d.needs(Need::SceneGeometry).needs(Need::SceneMaterials).needs(Need::SceneLights).needs(Need::SceneAcceleration);
  d.needs(Need::FrameCamera).needs(Need::FrameIndex);
}

void Spatial::prepare(PrepareContext& c) {
  // input → a → b → … → output: two buffers of our own are enough for any number of iterations.
  const int iterations = c.integer("iterations");
  PortType type = perPixel<Reservoir>();
  type.perPixelFromInput = "reservoirs";
  const char* buffers[] = {"a", "b"};
  for (int i = 0; i < 2 && i + 1 < iterations; ++i) c.scratch(buffers[i], type);
  for (int i = 0; i < iterations; ++i) {
    KernelOptions options;
    if (i > 0) options.bind.emplace_back("in_reservoirs", std::string("scratch_") + buffers[(i - 1) % 2]);
    if (i + 1 < iterations) options.bind.emplace_back("out_reservoirs", std::string("scratch_") + buffers[i % 2]);
    kernels_[i] = reuseKernel(c, "spatial.glsl", options);
  }
}

void Spatial::record(RecordContext& c) {
  for (int i = 0; i < c.integer("iterations"); ++i) c.launch(kernels_[i], static_cast<uint32_t>(i));
}

}  // namespace weir::passes
