// A scene that is read beside the window: up to the upload, everything happens on a thread of its own.
#pragma once

#include <weir/render/stage.h>

#include <future>
#include <memory>
#include <optional>
#include <string>

namespace weir::view {

class SceneLoader {
 public:
  /// Begins to read; what is being read already is forgotten when it is there.
  void load(const render::StageOptions& options, float aspect);
  bool loading() const { return future_.valid(); }
  const render::StageOptions& options() const { return options_; }

  struct Loaded {
    render::StageOptions options;
    std::unique_ptr<render::Stage> stage;  ///< null: see error
    std::string error;
  };
  /// The scene when it is there; never waits.
  std::optional<Loaded> take();

 private:
  struct Result {
    std::unique_ptr<render::Stage> stage;
    std::string error;
  };
  void begin();
  render::StageOptions options_;
  float aspect_ = 1.0f;
  bool again_ = false;  ///< another one is wanted than the one that is being read
  std::future<Result> future_;
};

}  // namespace weir::view
