#include "support/pass_test.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <weir/graph/compile.h>
#include <weir/pass/registry.h>

#include <algorithm>

#include "support/device.h"

namespace weir::test {
namespace {

/// The plugin interface describes passes by plain functions; the source's ports follow from the pass under test.
struct SourcePorts {
  const PassDescription* pass = nullptr;
  std::map<std::string, uint32_t> counts;
};
thread_local SourcePorts sourcePorts;

class Source final : public Pass {
 public:
  static void describe(PassDescription& d) {
    for (const PortDescription& input : sourcePorts.pass->inputs) {
      PortType type = input.type;
      type.anyPerPixel = false;
      const auto count = sourcePorts.counts.find(input.name);
      if (count != sourcePorts.counts.end()) type.perPixel = count->second;
      d.output(input.name, type);
    }
  }
  void prepare(PrepareContext& /*context*/) override {}
  void record(RecordContext& /*context*/) override {}
};

}  // namespace

struct PassTest::Machine {
  std::shared_ptr<gpu::Device> device;
  ExpectNoValidationMessages guard;
  Registry registry;
  shader::Compiler compiler;
  scene::PreparedScene prepared;
  std::unique_ptr<scene::StateMaker> states;  // only with a clip
  scene::SceneState state;
  std::unique_ptr<scene::SceneGpu> scene;
  std::unique_ptr<execute::Executor> executor;

  explicit Machine(std::shared_ptr<gpu::Device> d)
      : device(std::move(d)), guard(*device), registry({std::filesystem::path(binaryPath("bin"))}) {}
};

PassTest::PassTest(std::string type) : type_(std::move(type)) {}
PassTest::~PassTest() = default;

PassTest& PassTest::size(uint32_t width, uint32_t height) {
  width_ = width;
  height_ = height;
  return *this;
}
PassTest& PassTest::scene(scene::Scene scene) {
  scene_ = std::move(scene);
  return *this;
}
PassTest& PassTest::limits(const scene::PrepareLimits& limits) {
  limits_ = limits;
  return *this;
}
PassTest& PassTest::clip(const std::string& name) {
  clip_ = name;
  return *this;
}
PassTest& PassTest::at(double seconds) {
  seconds_ = seconds;
  return *this;
}
PassTest& PassTest::plugin(const std::string& name, std::vector<WeirPassEntry> passes,
                           const std::string& shaderFolder) {
  plugins_.push_back({name, shaderFolder, std::move(passes)});
  return *this;
}
PassTest& PassTest::param(const std::string& name, const std::string& value) {
  sets_.push_back("it." + name + "=" + value);
  return *this;
}
PassTest& PassTest::count(const std::string& input, uint32_t perPixel) {
  counts_[input] = perPixel;
  return *this;
}
PassTest& PassTest::leaveOpen(const std::string& input) {
  open_.push_back(input);
  return *this;
}
PassTest& PassTest::backend(trace::Backend backend) {
  backend_ = backend;
  return *this;
}
PassTest& PassTest::withoutRayTracing() {
  hideRayTracing_ = true;
  return *this;
}
PassTest& PassTest::feedBack(const std::string& input, const std::string& output) {
  feedBack_[input] = output;
  return *this;
}
PassTest& PassTest::camera(const scene::Camera& camera) {
  frame_.camera = camera;
  return *this;
}
PassTest& PassTest::frame(uint32_t index) {
  frame_.index = index;
  return *this;
}
PassTest& PassTest::seed(uint32_t seed) {
  frame_.seed = seed;
  return *this;
}

void PassTest::resetHistory() {
  executor().resetHistory();
}

const scene::PreparedScene& PassTest::prepared() {
  build();
  return machine_->prepared;
}

execute::Executor& PassTest::executor() {
  build();
  return *machine_->executor;
}

std::string PassTest::json() const {
  std::string inputs, outputs;
  for (const PortDescription& input : sourcePorts.pass->inputs) {
    if (std::ranges::count(open_, input.name) != 0) continue;
    const auto fed = feedBack_.find(input.name);
    const std::string from = fed == feedBack_.end() ? "source." + input.name : "it." + fed->second + "@previous";
    inputs += fmt::format("{}\"{}\": \"{}\"", inputs.empty() ? "" : ", ", input.name, from);
    outputs += fmt::format("\"source-{0}\": \"source.{0}\", ", input.name);
  }
  for (const PortDescription& output : sourcePorts.pass->outputs) {
    outputs +=
        fmt::format("{0}\"{1}\": \"it.{1}\"", &output == &sourcePorts.pass->outputs.front() ? "" : ", ", output.name);
  }
  return fmt::format(R"({{"version": 1, "name": "pass test", "passes": {{
    "source": {{"type": "test.Source"}}, "it": {{"type": "{}", "inputs": {{{}}}}}}}, "outputs": {{{}}}}})",
                     type_, inputs, outputs);
}

void PassTest::build() {
  if (machine_) return;
  std::shared_ptr<gpu::Device> device;
  if (hideRayTracing_) {
    gpu::DeviceOptions options;
    options.choice = deviceChoice();
    options.validation = true;
    options.hideRayTracing = true;
    device = std::make_shared<gpu::Device>(options);
  } else {
    device = validatedDevice();
  }
  machine_ = std::make_unique<Machine>(device);
  Machine& m = *machine_;
  for (const OwnPlugin& own : plugins_) m.registry.add(own.name, own.passes, own.shaders);
  sourcePorts = {m.registry.find(type_), counts_};
  if (sourcePorts.pass == nullptr) throw InputError(type_ + ": " + m.registry.problem(type_));
  const WeirPassEntry source[] = {passEntry<Source>("Source")};
  m.registry.add("test", source);

  std::vector<graph::Diagnostic> diagnostics;
  graph::Description description = graph::parse(json(), "pass test", diagnostics);
  graph::apply(description, {.set = sets_, .enable = {}, .disable = {}}, diagnostics);
  graph::CompileOptions compileOptions;
  compileOptions.width = width_;
  compileOptions.height = height_;
  compileOptions.keepAll = true;  // inputs are filled before the frame, outputs are read after it
  graph::CompiledGraph compiled = graph::compile(description, m.registry.catalog(), compileOptions, diagnostics);
  if (!diagnostics.empty()) throw graph::GraphError(diagnostics);

  m.prepared = scene::prepareScene(scene_, limits_, clip_.empty() ? nullptr : &scene::chooseClip(scene_, clip_));
  if (!clip_.empty()) m.states = std::make_unique<scene::StateMaker>(scene_, m.prepared);
  const bool traces = device->capabilities().accelerationStructure;
  m.scene = std::make_unique<scene::SceneGpu>(*device, scene_, m.prepared, traces);
  execute::ExecutorOptions options;
  options.backend = backend_ ? *backend_ : trace::chooseBackend("auto", *device);
  m.executor =
      std::make_unique<execute::Executor>(*device, m.compiler, m.registry, *m.scene, std::move(compiled), options);
  // Unfilled inputs hold zeros, not what the memory held before.
  for (const PortDescription& input : sourcePorts.pass->inputs) {
    if (std::ranges::count(open_, input.name) != 0 || feedBack_.contains(input.name)) continue;
    const std::vector<std::byte> zeros(m.executor->readResource("source." + input.name).size());
    m.executor->writeResource("source." + input.name, zeros);
  }
  for (const auto& [port, bytes] : pending_) m.executor->writeResource("source." + port, bytes);
  pending_.clear();
}

PassTest& PassTest::inputBytes(const std::string& port, std::span<const std::byte> bytes) {
  if (machine_) {
    const size_t size = machine_->executor->readResource("source." + port).size();
    if (size != bytes.size())
      throw InputError(fmt::format("{}: {} bytes given, {} expected", port, bytes.size(), size));
    machine_->executor->writeResource("source." + port, bytes);
  } else {
    pending_[port] = {bytes.begin(), bytes.end()};
  }
  return *this;
}

std::vector<std::byte> PassTest::outputBytes(const std::string& port) {
  return executor().readResource("it." + port);
}

void PassTest::run(uint32_t frames) {
  build();
  if (machine_->states) {
    machine_->state = machine_->states->at(scene::evaluate(scene_, scene::chooseClip(scene_, clip_), seconds_));
    frame_.state = &machine_->state;
  }
  for (uint32_t i = 0; i < frames; ++i) {
    machine_->executor->frame(frame_);
    ++frame_.index;
  }
  machine_->executor->finish();
}

}  // namespace weir::test
