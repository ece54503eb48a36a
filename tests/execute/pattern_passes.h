// Passes that check every element they read and write patterns that others can check; random graphs of them; and a
// machine that runs one graph after another on the tests' device.
#pragma once

#include "execute/graph_run.h"

#include <fmt/format.h>

#include <array>
#include <random>

namespace weir::test {

/// What a pixel's invocations found: elements that were not what they should be, and all that they looked at.
struct Faults {
  uint32_t wrong, checked;
};

}  // namespace weir::test

namespace weir {

template <>
struct LayoutOf<test::Faults> {
  static constexpr const char* name = "Faults";
  static constexpr uint32_t version = 1, emptyWord = 0;
  static constexpr std::array<Field, 2> fields{{{"uint", "wrong"}, {"uint", "checked"}}};
};

}  // namespace weir

namespace weir::test {

/// Kinds of ports, by the letter that their names begin with.
constexpr const char* kPatterns = "ufcwm";
inline int patternKind(const std::string& port) {
  return static_cast<int>(std::string(kPatterns).find(port[0]));
}
inline PortType patternPort(char kind) {
  PortType type;
  switch (kind) {
    case 'u':
      return storageImage(Format::R32U);
    case 'f':
      type = storageImage(Format::R32F);
      type.scaleDenominator = 2;
      return type;
    case 'c':
      type = storageImage(Format::RGBA8);
      type.scaleDenominator = 4;
      return type;
    case 'w':
      return perPixel<Word>();
    default:
      type = perPixel<Word>();
      type.scaleDenominator = 2;
      type.perPixel = 3;
      return type;
  }
}

inline uint32_t patternKey(int32_t salt, uint32_t port) {
  return hashOf(static_cast<uint32_t>(salt) * 16u + port);
}
inline uint32_t patternValue(uint32_t key, uint32_t frame, uint32_t element) {
  return hashOf(key + 0x9e3779b9u * frame + 0x85ebca6bu * element);
}

struct PatternType {
  enum Work : uint8_t { Compute, Halves, Rays, Raster };
  const char* name;
  std::vector<std::string> inputs, outputs;  ///< by kind, inputs with a digit
  Work work = Compute;
};
inline const std::vector<PatternType>& patternTypes() {
  static const std::vector<PatternType> kTypes = {{"Images", {}, {"u", "f", "c"}},
                                                  {"Buffers", {}, {"w", "m"}},
                                                  {"Two", {"u0", "w0"}, {"u", "f"}},
                                                  {"Mix", {"f0", "w0", "w1"}, {"w", "c"}},
                                                  {"Halves", {"m0", "w0"}, {"m", "u"}, PatternType::Halves},
                                                  {"Wide", {"u0", "u1", "c0"}, {"c", "w", "m"}},
                                                  {"Rays", {"w0", "f0"}, {"u", "m"}, PatternType::Rays},
                                                  {"Raster", {"u0"}, {"w", "f"}, PatternType::Raster}};
  return kTypes;
}

template <size_t kType>
class Pattern final : public Pass {
 public:
  static const PatternType& type() { return patternTypes()[kType]; }
  static void describe(PassDescription& d) {
    d.param("salt", 0);
    for (const std::string& in : type().inputs) {
      d.input(in, patternPort(in[0]));
      d.param("key_" + in, 0);
      d.param("old_" + in, false);
    }
    d.input("before", perPixel<Faults>());
    for (const std::string& out : type().outputs) {
      auto port = d.output(out, patternPort(out[0]));
      const std::string through = out + "0";
      if (std::count(type().inputs.begin(), type().inputs.end(), through) > 0) port.passesThrough(through);
    }
    d.output("faults", perPixel<Faults>());
    d.needs(Need::FrameIndex);
    if (type().work == PatternType::Rays) d.needs(Need::SceneAcceleration);
    if (type().work == PatternType::Raster) d.needs(Need::SceneGeometry).needs(Need::SceneMaterials).rasterises();
  }
  void prepare(PrepareContext& c) override {
    if (type().work == PatternType::Raster) {
      c.scratch("drawn", storageImage(Format::R32U));
      draw_ = c.rasterKernel("pattern_draw.glsl", "drawn");
    }
    if (type().work == PatternType::Halves) {
      PortType half = storageImage(Format::R32U);
      half.scaleDenominator = 2;
      c.scratch("words", perPixel<Word>());
      c.scratch("image", half);
      first_ = c.kernel("pattern.glsl", {.bind = {}, .defines = {{"FIRST_HALF", "1"}}, .sources = {}});
      second_ = c.kernel("pattern.glsl", {.bind = {}, .defines = {{"SECOND_HALF", "1"}}, .sources = {}});
      return;
    }
    first_ = type().work == PatternType::Rays ? c.rayKernel("pattern.glsl") : c.kernel("pattern.glsl");
  }
  void record(RecordContext& c) override {
    if (type().work == PatternType::Raster) c.draw(draw_);
    c.launch(first_);
    if (type().work == PatternType::Halves) c.launch(second_);
  }

 private:
  Kernel first_, second_, draw_;
};

inline std::vector<WeirPassEntry> patternEntries() {
  return [&]<size_t... kTypes>(std::index_sequence<kTypes...>) {
    return std::vector<WeirPassEntry>{passEntry<Pattern<kTypes>>(patternTypes()[kTypes].name)...};
  }
  (std::make_index_sequence<8>());
}

/// What the device can do; other types are left out.
struct PatternTypes {
  std::vector<size_t> usable;
  explicit PatternTypes(const gpu::Device& device) {
    for (size_t t = 0; t < patternTypes().size(); ++t) {
      const PatternType::Work work = patternTypes()[t].work;
      if (work == PatternType::Rays && trace::chooseBackend("auto", device) == trace::Backend::None) continue;
      if (work == PatternType::Raster && !device.capabilities().graphics) continue;
      usable.push_back(t);
    }
  }
};

/// A random graph as JSON. Every input is connected, so that there are as many pipelines as types.
inline std::string randomPatternGraph(std::mt19937& random, const PatternTypes& types) {
  const auto below = [&](size_t n) { return static_cast<size_t>(random() % n); };
  struct Node {
    size_t type;
    std::string name;
  };
  std::vector<Node> nodes;
  // The two without inputs come first, twice over now and then: whatever kind is asked for, there is one.
  const size_t passes = 3 + below(10);
  for (size_t i = 0; i < passes; ++i)
    nodes.push_back({i < 2 ? i : types.usable[below(types.usable.size())], fmt::format("p{}", (i * 7 + 3) % 13)});
  const auto source = [&](char kind, size_t end, bool near) {
    std::vector<std::string> found;
    for (size_t p = 0; p < end; ++p)
      for (const std::string& out : patternTypes()[nodes[p].type].outputs)
        if (kind == 0 || out[0] == kind) found.push_back(nodes[p].name + "." + out);
    // Mostly recent ones, so that lives are short and memory is shared.
    const size_t back = near ? below(std::min<size_t>(2, found.size())) : below(found.size());
    return found[found.size() - 1 - back];
  };
  std::string text;
  for (size_t i = 0; i < passes; ++i) {
    const PatternType& type = patternTypes()[nodes[i].type];
    std::string inputs = fmt::format("\"before\": \"{}.faults@previous\"", nodes[i].name);
    for (const std::string& in : type.inputs) {
      const bool previous = below(6) == 0;
      inputs += fmt::format(", \"{}\": \"{}{}\"", in, source(in[0], previous ? passes : i, !previous && below(3) > 0),
                            previous ? "@previous" : "");
    }
    text += fmt::format("{}\"{}\": {{\"type\": \"own.{}\", \"inputs\": {{{}}}, \"params\": {{\"salt\": {}}}{}}}",
                        i ? ",\n" : "", nodes[i].name, type.name, inputs, i + 1,
                        below(12) == 0 ? ", \"enabled\": false" : "");
  }
  std::string outputs;
  for (size_t o = 0; o <= below(3); ++o)
    outputs += fmt::format("{}\"o{}\": \"{}\"", o ? ", " : "", o, source(0, passes, false));
  for (size_t i = 2; i < passes; ++i)  // so that most of them run
    if (below(4) > 0) outputs += fmt::format(", \"f{}\": \"{}.faults\"", i, nodes[i].name);
  return "{\"version\": 1, \"name\": \"random\", \"passes\": {" + text + "}, \"outputs\": {" + outputs + "}}";
}

/// Tells each pass what its inputs must hold: whatever the compiler connected them to.
inline void tellKeys(graph::CompiledGraph& graph) {
  for (graph::CompiledPass& pass : graph.passes)
    for (const graph::Binding& input : pass.inputs) {
      if (input.port == "before") continue;
      const graph::CompiledPass& producer = graph.passes[graph.resources[input.resource].producer];
      for (const graph::Binding& output : producer.outputs)
        if (output.resource == input.resource)
          pass.params["key_" + input.port] = static_cast<int32_t>(patternKey(
              std::get<int32_t>(producer.params.at("salt")), static_cast<uint32_t>(patternKind(output.port))));
      pass.params["old_" + input.port] = input.previous;
    }
}

/// Runs one graph after another. Pipelines that the next one needs too are kept.
class PatternMachine {
 public:
  explicit PatternMachine(bool poison) : guard_(*device_), types(*device_), poison_(poison) {
    registry_.add("own", patternEntries(), sourcePath("tests/execute/shaders"));
    Builder b;
    scene::Material both;
    both.doubleSided = true;
    b.add(quad({-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, b.material(both)));
    source_ = b.scene;
    prepared_ = scene::prepareScene(source_);
    scene_ =
        std::make_unique<scene::SceneGpu>(*device_, source_, prepared_, device_->capabilities().accelerationStructure);
  }

  /// Compiled, or nothing when it does not: a disabled pass with nothing to stand for it.
  std::optional<graph::CompiledGraph> compile(const std::string& json, uint32_t width, uint32_t height) {
    std::vector<graph::Diagnostic> diagnostics;
    const graph::Description description = graph::parse(json, "random", diagnostics);
    graph::CompiledGraph compiled = graph::compile(description, registry_.catalog(), width, height, diagnostics);
    if (!diagnostics.empty()) {
      lastFinding = diagnostics[0].text();
      return {};
    }
    tellKeys(compiled);
    return compiled;
  }

  void load(graph::CompiledGraph graph) {
    if (executor_) {
      executor_->swap(std::move(graph));
      executor_->resetHistory();
    } else {
      execute::ExecutorOptions options;
      options.backend = trace::chooseBackend("auto", *device_);
      options.poison = poison_;
      executor_ =
          std::make_unique<execute::Executor>(*device_, compiler_, registry_, *scene_, std::move(graph), options);
    }
    next_ = {};
  }
  /// Submits frames without waiting for any.
  void run(uint32_t frames) {
    for (uint32_t i = 0; i < frames; ++i, ++next_.index) executor_->frame(next_);
  }
  Faults faults() {
    Faults sum{};
    for (const graph::CompiledPass& pass : graph().passes)
      for (const Faults& f : read<Faults>(pass.name + ".faults")) {
        sum.wrong += f.wrong;
        sum.checked += f.checked;
      }
    return sum;
  }
  template <typename T>
  std::vector<T> read(const std::string& resource) {
    const std::vector<std::byte> bytes = executor_->readResource(resource);
    std::vector<T> values(bytes.size() / sizeof(T));
    std::memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
    return values;
  }
  const graph::CompiledGraph& graph() const { return executor_->graph(); }
  const execute::Executor& executor() const { return *executor_; }
  uint32_t frame() const { return next_.index - 1; }

 private:
  std::shared_ptr<gpu::Device> device_ = validatedDevice();
  ExpectNoValidationMessages guard_;

 public:
  const PatternTypes types;
  std::string lastFinding;

 private:
  bool poison_;
  Registry registry_;
  shader::Compiler compiler_;
  scene::Scene source_;
  scene::PreparedScene prepared_;
  std::unique_ptr<scene::SceneGpu> scene_;
  std::unique_ptr<execute::Executor> executor_;
  execute::FrameInput next_;
};

}  // namespace weir::test
