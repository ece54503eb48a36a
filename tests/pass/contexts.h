// A host for passes that are called without a graph: it notes what they ask for, or fails as the real one does.
#pragma once

#include <weir/core/error.h>
#include <weir/pass/pass.h>

#include <string>
#include <string_view>
#include <vector>

namespace weir {

template <typename Base>
class Answering : public Base {
 public:
  bool boolean(std::string_view) const override { return true; }
  int integer(std::string_view param) const override {
    throw InputError("it asks for parameter '" + std::string(param) +
                     "', which it doesn't declare (nearest: 'amount')");
  }
  float number(std::string_view) const override { return 1; }
  std::string text(std::string_view) const override { return "a"; }
  bool connected(std::string_view) const override { return true; }
  uint32_t width() const override { return 64; }
  uint32_t height() const override { return 64; }
  std::string sceneFolder() const override { return {}; }
  LightSummary lights() const override { return {}; }
};

class NotingPrepare final : public Answering<PrepareContext> {
 public:
  void scratch(const std::string&, const PortType&) override {}
  void texture(const std::string&, TextureData) override {}
  void lightTree() override {}
  Kernel kernel(const std::string& file, const KernelOptions&) override {
    if (!failure.empty()) throw RuntimeError(failure);
    kernels.push_back(file);
    return {};
  }
  Kernel rayKernel(const std::string& file, const KernelOptions& options) override { return kernel(file, options); }
  Kernel rasterKernel(const std::string& file, const std::string&, const KernelOptions& options) override {
    return kernel(file, options);
  }
  std::vector<std::string> kernels;
  std::string failure;  ///< of every kernel, unless empty
};

class NotingRecord final : public Answering<RecordContext> {
 public:
  void launch(Kernel, uint32_t index) override { last = index; }
  void launch(Kernel, uint32_t, uint32_t, uint32_t index) override { last = index; }
  void draw(Kernel) override {}
  uint32_t last = 0;  ///< index of the last launch
};

}  // namespace weir
