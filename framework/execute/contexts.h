// What a pass is given in prepare() and record(): its PassRuntime, seen through the public interfaces.
#pragma once

#include <weir/execute/pass_runtime.h>

namespace weir::execute {

/// The answers that both contexts share.
template <typename Base>
class Answers : public Base {
 public:
  explicit Answers(PassRuntime& runtime) : runtime_(runtime) {}
  bool boolean(std::string_view param) const override { return get<bool>(param); }
  int integer(std::string_view param) const override { return get<int32_t>(param); }
  float number(std::string_view param) const override { return get<float>(param); }
  std::string text(std::string_view param) const override { return get<std::string>(param); }
  bool connected(std::string_view input) const override;
  uint32_t width() const override { return runtime_.shared_.graph->width; }
  uint32_t height() const override { return runtime_.shared_.graph->height; }
  std::string sceneFolder() const override { return runtime_.shared_.sceneFolder; }
  LightSummary lights() const override;

 protected:
  PassRuntime& runtime_;

 private:
  template <typename T>
  T get(std::string_view param) const;
};

class Preparing final : public Answers<PrepareContext> {
 public:
  using Answers::Answers;
  void scratch(const std::string& name, const PortType& type) override;
  void texture(const std::string& name, TextureData data) override;
  void lightTree() override;
  Kernel kernel(const std::string& file, const KernelOptions& options) override;
  Kernel rayKernel(const std::string& file, const KernelOptions& options) override;
  Kernel rasterKernel(const std::string& file, const std::string& target, const KernelOptions& options) override;

 private:
  void beforeKernels(const std::string& what) const;
};

class Recording final : public Answers<RecordContext> {
 public:
  Recording(PassRuntime& runtime, const FrameCursor& cursor) : Answers(runtime), cursor_(cursor) {}
  void launch(Kernel kernel, uint32_t index) override { launch(kernel, width(), height(), index); }
  void launch(Kernel kernel, uint32_t launchWidth, uint32_t launchHeight, uint32_t index) override;
  void draw(Kernel kernel) override;

 private:
  const PassRuntime::PreparedKernel& kernelOf(Kernel kernel) const;
  void begin(const PassRuntime::PreparedKernel& kernel, uint32_t w, uint32_t h, uint32_t index);
  void bindLane(const PassRuntime::PreparedKernel& kernel, uint32_t lane) const;
  void drawLane(const PassRuntime::PreparedKernel& kernel, uint32_t lane) const;
  void barrier(VkPipelineStageFlags2 before, VkAccessFlags2 beforeAccess, VkPipelineStageFlags2 after,
               VkAccessFlags2 afterAccess);
  const FrameCursor& cursor_;
  bool first_ = true;
};

}  // namespace weir::execute
