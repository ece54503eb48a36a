// One pass of the output plugin alone: a graph of a source, whose picture the test writes, and the pass.
#pragma once

#include <gtest/gtest.h>
#include <weir/execute/executor.h>
#include <weir/graph/compile.h>
#include <weir/pass/plugin.h>
#include <weir/pass/registry.h>

#include <cstring>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "support/device.h"

namespace weir::test {

/// A picture that nobody but the test writes.
class Given final : public Pass {
 public:
  static void describe(PassDescription& d) { d.output("color", storageImage(Format::RGBA32F)); }
  void prepare(PrepareContext&) override {}
  void record(RecordContext&) override {}
};

class OnePass {
 public:
  /// `pass`: the JSON of the pass "it", which reads "given.color".
  OnePass(const std::string& pass, uint32_t width, uint32_t height)
      : device_(validatedDevice()),
        guard_(*device_),
        registry_({std::filesystem::path(binaryPath("bin"))}),
        compiler_("-"),
        scene_(*device_, scene::Scene{}, scene::prepareScene(scene::Scene{}), false) {
    const WeirPassEntry given[] = {passEntry<Given>("Given")};
    registry_.add("test", given);
    const std::string json = R"({"version": 1, "name": "one", "passes": {"given": {"type": "test.Given"}, "it": )" +
                             pass + R"(}, "outputs": {"color": "it.color", "given": "given.color"}})";
    std::vector<graph::Diagnostic> diagnostics;
    const graph::Description description = graph::parse(json, "test", diagnostics);
    graph::CompiledGraph compiled = graph::compile(description, registry_.catalog(), width, height, diagnostics);
    for (const graph::Diagnostic& d : diagnostics) ADD_FAILURE() << d.message;
    executor_ = std::make_unique<execute::Executor>(*device_, compiler_, registry_, scene_, std::move(compiled),
                                                    execute::ExecutorOptions{});
  }

  /// One frame of this RGBA picture; the result is the pass's colour.
  std::vector<float> show(const std::vector<float>& rgba) {
    give(rgba);
    return read<float>("it.color");
  }
  /// Only runs the frame.
  void give(const std::vector<float>& rgba) {
    write<float>("given.color", rgba);
    executor_->frame({{}, frame_++, 0, false});
  }
  template <typename T>
  std::vector<T> read(const std::string& resource) {
    const std::vector<std::byte> bytes = executor_->readResource(resource);
    std::vector<T> values(bytes.size() / sizeof(T));
    std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
    return values;
  }
  template <typename T>
  void write(const std::string& resource, const std::vector<T>& values) {
    executor_->writeResource(resource, std::as_bytes(std::span(values)));
  }

 private:
  std::shared_ptr<gpu::Device> device_;
  ExpectNoValidationMessages guard_;
  Registry registry_;
  shader::Compiler compiler_;
  scene::SceneGpu scene_;
  std::unique_ptr<execute::Executor> executor_;
  uint32_t frame_ = 0;
};

}  // namespace weir::test
