#include "common/layouts.h"
#include "restir_di/restir_di.h"

#include <weir/core/error.h>

#include <string>

namespace weir::passes {

void Initial::describe(PassDescription& d) {
  d.doc("Light candidates by power or place, resampled into each pixel's reservoirs (RIS)");
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
          "With picks by power: share of the candidates picked uniformly among all lights, which bounds the error of "
          "dim lights close by");
  d.param("picks", "auto")
      .oneOf({"auto", "power", "place"})
      .doc(
          "How lights are picked: by power, wherever they are, or by power and distance from what a tile of 16 x 16 "
          "pixels shows, with a light tree, for tiles alone and lights that no clip moves; auto: by place where tiles "
          "are on and there are 1000 lights or more that have one and stay");
  d.param("tiles", "auto")
      .oneOf({"auto", "on", "off"})
      .doc(
          "Whether the pixels of a tile of 16 x 16 pick lights for all of them and share the picks, whose cost hardly "
          "grows "
          "with the number of lights, or each pick all their candidates themselves; auto: where bsdfRays is 0, on");
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

namespace {

constexpr uint32_t kManyLights = 1000;  // from here on, places pay

/// Whether the tiles pick lights by place. InputError where that is asked for and can't be.
bool picksByPlace(const PrepareContext& c, bool tiled) {
  const std::string picks = c.text("picks");
  const LightSummary lights = c.lights();
  if (picks == "auto") return tiled && !lights.moves && lights.placed >= kManyLights;
  if (picks == "power") return false;
  if (!tiled)
    throw InputError(
        "picks 'place' are made for tiles, and go neither with tiles 'off' nor with bsdfRays above 0; expected picks "
        "'auto' or 'power', or tiles 'on' and bsdfRays 0");
  if (lights.moves)
    throw InputError(
        "picks 'place' need lights that stay, and the clip moves some of this scene's; expected picks 'auto' or "
        "'power'");
  return true;
}

}  // namespace

void Initial::prepare(PrepareContext& c) {
  ordered_ = false;
  const std::string tiles = c.text("tiles");
  const bool byPlace = picksByPlace(c, tiles != "off" && c.integer("bsdfRays") == 0);
  if (c.integer("bsdfRays") > 0) {
    if (tiles == "on")
      throw InputError(
          "tiles 'on' and bsdfRays above 0 can't go together: what traces rays shares no memory; expected tiles 'auto' "
          "or 'off', or bsdfRays 0");
    kernel_ = c.rayKernel("initial.glsl", {.defines = {{"BSDF_RAYS", "1"}}});
    return;
  }
  if (tiles != "off") {
    KernelOptions options;
    options.group = {.side = 16, .whole = true};
    ordered_ = c.boolean("visibility");
    if (ordered_) {
      rays_.scratch(c);
      options.defines.emplace_back("ORDERS_RAYS", "1");
    }
    if (byPlace) c.lightTree();
    kernel_ = c.kernel("initial_tiles.glsl", options);
    if (ordered_) rays_.prepare(c, "initial_visibility.glsl");
    return;
  }
  kernel_ = c.boolean("visibility") ? c.rayKernel("initial.glsl") : c.kernel("initial.glsl");
}

void Initial::record(RecordContext& c) {
  c.launch(kernel_);
  if (ordered_) rays_.launch(c);
}

}  // namespace weir::passes
