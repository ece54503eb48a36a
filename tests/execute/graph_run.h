// A graph of passes of the test's own, compiled and run on the tests' device.
#pragma once

#include <gtest/gtest.h>
#include <weir/execute/executor.h>
#include <weir/graph/compile.h>
#include <weir/pass/plugin.h>
#include <weir/pass/registry.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "support/device.h"
#include "support/pass_test.h"
#include "support/small_scenes.h"

namespace weir::test {

/// One 32-bit number a pixel.
struct Word {
  uint32_t value;
};

}  // namespace weir::test

namespace weir {

template <>
struct LayoutOf<test::Word> {
  static constexpr const char* name = "Word";
  static constexpr uint32_t version = 1, emptyWord = 1000;  // not zero, so that clearing shows
  static constexpr std::array<Field, 1> fields{{{"uint", "value"}}};
};

}  // namespace weir

namespace weir::test {

class GraphRun {
 public:
  struct Options {
    uint32_t width = 16, height = 16;
    scene::Scene scene = {};
    graph::Overrides overrides = {};
    std::string shaders = sourcePath("tests/execute/shaders");
    bool keepAll = true;  ///< every resource can be read after a frame; false: they share memory
    bool poison = false;
    uint32_t lanes = 1;
  };
  /// `passes` is the graph's "passes", JSON, `output` a port of one of them; the entries' types are "own.<name>".
  GraphRun(const std::string& passes, const std::string& output, const std::vector<WeirPassEntry>& entries,
           Options options)
      : guard_(*device_) {
    registry_.add("own", entries, options.shaders);
    graph::CompiledGraph compiled = compile(passes, output, options);
    source_ = std::move(options.scene);
    prepared_ = scene::prepareScene(source_);
    scene_ =
        std::make_unique<scene::SceneGpu>(*device_, source_, prepared_, device_->capabilities().accelerationStructure);
    execute::ExecutorOptions executorOptions;
    executorOptions.backend = trace::chooseBackend("auto", *device_);
    executorOptions.poison = options.poison;
    executorOptions.lanes = options.lanes;
    executor_ = std::make_unique<execute::Executor>(*device_, compiler_, registry_, *scene_, std::move(compiled),
                                                    executorOptions);
  }
  /// Another graph of the same passes, to swap to.
  graph::CompiledGraph compile(const std::string& passes, const std::string& output, const Options& options) {
    const std::string json =
        R"({"version": 1, "name": "test", "passes": )" + passes + R"(, "outputs": {"o": ")" + output + "\"}}";
    std::vector<graph::Diagnostic> diagnostics;
    graph::Description description = graph::parse(json, "test", diagnostics);
    graph::apply(description, options.overrides, diagnostics);
    graph::CompileOptions compileOptions;
    compileOptions.width = options.width;
    compileOptions.height = options.height;
    compileOptions.keepAll = options.keepAll;
    graph::CompiledGraph compiled = graph::compile(description, registry_.catalog(), compileOptions, diagnostics);
    if (!diagnostics.empty()) throw graph::GraphError(diagnostics);
    return compiled;
  }
  /// Submits frames without waiting for any.
  void run(uint32_t frames = 1) {
    for (uint32_t i = 0; i < frames; ++i) {
      executor_->frame(next);
      ++next.index;
    }
  }
  template <typename T = uint32_t>
  std::vector<T> read(const std::string& resource, uint32_t lane = 0) {
    const std::vector<std::byte> bytes = executor_->readResource(resource, lane);
    std::vector<T> values(bytes.size() / sizeof(T));
    std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
    return values;
  }
  execute::Executor& executor() { return *executor_; }
  const scene::PreparedScene& prepared() const { return prepared_; }
  const scene::SceneGpu& sceneGpu() const { return *scene_; }
  Registry& registry() { return registry_; }

  execute::FrameInput next;

 private:
  std::shared_ptr<gpu::Device> device_ = validatedDevice();
  ExpectNoValidationMessages guard_;
  Registry registry_;
  shader::Compiler compiler_;
  scene::Scene source_;
  scene::PreparedScene prepared_;
  std::unique_ptr<scene::SceneGpu> scene_;
  std::unique_ptr<execute::Executor> executor_;
};

}  // namespace weir::test
