#include "output/tonemap.h"

#include "output/view_transform.h"

namespace weir::passes {

void Tonemap::describe(PassDescription& d) {
  d.doc("Radiance to what a screen shows: exposure, then an OpenColorIO view");
  d.input("color", storageImage(Format::RGBA32F))
      .doc("Radiance; NaN counts as 0, infinities as the largest finite colour");
  d.output("color", storageImage(Format::RGBA32F)).display().doc("As the view gives it; alpha 1");
  d.param("exposure", 0.0f).range(-32, 32).unit("EV").doc("Radiance is multiplied by 2^exposure before the view");
  d.param("config", "")
      .specialises()
      .doc("OpenColorIO config file; \"\": $OCIO if set, else weir; weir: the built-in one");
  d.param("display", "").specialises().doc("Display of the config; \"\": its default");
  d.param("view", "").specialises().doc("View of the display; \"\": its default");
  d.param("space", "").specialises().doc("Colour space of the config that the input is in; \"\": linear Rec.709");
}

void Tonemap::prepare(PrepareContext& c) {
  const ViewChoice choice = {c.text("config"), c.text("display"), c.text("view"), c.text("space"), c.sceneFolder()};
  ViewTransform transform = makeViewTransform(choice);
  for (auto& [name, data] : transform.textures) c.texture(name, std::move(data));
  kernel_ = c.kernel("tonemap.glsl", {.sources = {{"view_transform.glsl", std::move(transform.glsl)}}});
}

void Tonemap::record(RecordContext& c) {
  c.launch(kernel_);
}

}  // namespace weir::passes
