#include "common/layouts.h"
#include "restir_di/restir_di.h"
#include "restir_di/tiles.h"

#include <string>

namespace weir::passes {

void Initial::describe(PassDescription& d) {
  d.doc("Light candidates by power, resampled into each pixel's reservoirs (RIS)");
  d.input("surface", perPixel<PackedSurface>());
  d.output("reservoirs", perPixel<Reservoir>()).times("samples").doc("One or more reservoirs a pixel");
  d.param("candidates", 32).range(1, 1024).doc("Lights that each pixel looks at");
  d.param("bsdfCandidates", 1)
      .range(0, 64)
      .doc("In scenes with an environment: directions by the BSDF that each pixel looks at, too, for what is glossy");
  d.param("bsdfRays", 0)
      .range(0, 64)
      .doc(
          "Rays by the BSDF that each pixel shoots: lights that they meet are candidates, too. Hidden lights are found "
          "by "
          "the others alone, so that unbiased reuse needs its visibilityRays then");
  d.param("samples", 1).range(1, 4).doc("Reservoirs a pixel; they share the candidates");
  d.param("uniformShare", 0.1f)
      .range(0, 1)
      .doc(
          "Share of the candidates picked uniformly among all lights, the rest by power: bounds the error of dim "
          "lights close by");
  d.param("tiles", "auto")
      .oneOf({"auto", "on", "off"})
      .doc(
          "Candidates from tiles of lights drawn beforehand, whose cost doesn't grow with the number of lights, or "
          "from "
          "the whole table; auto: tiles from 4096 lights on");
  d.param("triangles", "solidAngle")
      .oneOf({"area", "solidAngle"})
      .specialises()
      .doc(
          "How a point on an emissive triangle is drawn: by area, or by solid angle where it is close for its size (no "
          "fireflies close to it)");
  d.param("lobeShare", 0.25f)
      .range(0, 0.9)
      .doc(
          "On surfaces with α below 0.25: share of the points on emissive triangles that are looked for along the "
          "specular lobe (no fireflies in reflections)");
  d.param("visibility", true)
      .specialises()
      .doc("Shoot a shadow ray to each chosen sample: hidden ones are not passed on");
  d.needs(Need::SceneGeometry).needs(Need::SceneMaterials).needs(Need::SceneLights).needs(Need::SceneAcceleration);
  d.needs(Need::FrameCamera).needs(Need::FrameIndex);
}

void Initial::prepare(PrepareContext& c) {
  KernelOptions options;
  const bool rays = c.integer("bsdfRays") > 0;
  if (rays) options.defines.emplace_back("BSDF_RAYS", "1");
  const LightSummary lights = c.lights();
  tiled_ = usesTiles(c.text("tiles"), lights);
  if (tiled_) {
    c.scratch("tiles", fixedBuffer<TileSample>(kTileEntries));
    c.scratch("tileIndices", fixedBuffer<TileIndex>(kTileEntries));
    options.defines.emplace_back("TILE_SIZE", std::to_string(kTileSize));
    options.defines.emplace_back("TILE_COUNT", std::to_string(kTileCount));
    if (!lights.pointsOnly) {
      c.scratch("tileLights", fixedBuffer<TileLight>(kTileEntries));
      options.defines.emplace_back("TILE_LIGHTS", "1");
    }
    presample_ = c.kernel("presample.glsl", options);
  }
  kernel_ = rays || c.boolean("visibility") ? c.rayKernel("initial.glsl", options) : c.kernel("initial.glsl", options);
}

void Initial::record(RecordContext& c) {
  if (tiled_) c.launch(presample_, kTileSize, kTileCount, 0);
  c.launch(kernel_);
}

}  // namespace weir::passes
