#include "view/app/scene_loader.h"

#include <chrono>
#include <exception>
#include <utility>

namespace weir::view {

void SceneLoader::load(const render::StageOptions& options, float aspect) {
  options_ = options;
  aspect_ = aspect;
  if (loading())
    again_ = true;  // one at a time: scenes are large
  else
    begin();
}

void SceneLoader::begin() {
  again_ = false;
  future_ = std::async(std::launch::async, [options = options_, aspect = aspect_]() -> Result {
    try {
      return {std::make_unique<render::Stage>(render::makeStage(options, aspect)), ""};
    } catch (const std::exception& error) {
      return {nullptr, error.what()};
    }
  });
}

std::optional<SceneLoader::Loaded> SceneLoader::take() {
  if (!loading() || future_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return std::nullopt;
  Result result = future_.get();
  if (again_) {
    begin();
    return std::nullopt;
  }
  return Loaded{options_, std::move(result.stage), std::move(result.error)};
}

}  // namespace weir::view
