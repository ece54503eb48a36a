// Scenes on a host's device.
#include <weir/embed/call.h>

using namespace weir;
using namespace weir::embed;

namespace {

render::StageOptions stageOptions(const WeirSceneInfo& info) {
  render::StageOptions o;
  (void)given(info.file, "WeirSceneInfo.file");
  o.scene = info.file;
  o.lights = info.lights;
  o.lightSeed = info.lightSeed == 0 ? 1 : info.lightSeed;
  o.replaceLights = info.replaceLights != 0;
  o.environment = text(info.environment);
  o.environmentScale = info.environmentScale == 0.0f ? 1.0f : info.environmentScale;
  o.environmentRotation = info.environmentRotation;
  o.camera = text(info.camera);
  o.energyCompensation = info.energyCompensation != 0;
  o.animate = info.animate != 0;
  o.clip = text(info.clip);
  o.time = info.startTime;
  o.timeStep = info.timeStep;
  return o;
}

}  // namespace

WeirStatus weirCreateScene(WeirContext* context, const WeirSceneInfo* info, WeirScene** scene) {
  Weir* weir = weirOf(context);
  return call(weir, [&] {
    given(scene, "scene") = nullptr;
    const WeirSceneInfo& i = sized(info, "WeirSceneInfo");
    if ((i.width == 0) != (i.height == 0))
      throw InputError(fmt::format("WeirSceneInfo is {}x{}; expected both or neither", i.width, i.height));
    const float aspect = i.height == 0 ? 1.0f : static_cast<float>(i.width) / static_cast<float>(i.height);
    auto made = std::make_unique<WeirScene>(*context, stageOptions(i), aspect);
    weir->lines = made->stage.scene.warnings;
    *scene = made.release();
  });
}

WeirStatus weirDestroyScene(WeirScene* scene) {
  if (scene == nullptr) return WEIR_OK;
  const WeirStatus status = call(weirOf(scene), [&] { refuseWhile(scene->children, "graphs are"); });
  if (status == WEIR_OK) delete scene;
  return status;
}
