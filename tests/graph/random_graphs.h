// Random graphs, planned for random devices: what the tests of memory and barriers are run over.
#pragma once

#include "fakes.h"

#include <fmt/format.h>

#include <array>
#include <random>
#include <string>
#include <vector>

namespace weir::graph::test {

/// What ports can carry here: images and buffers, of the frame's size, half and quarter of it.
inline PortType portOf(int kind) {
  const auto scaled = [](PortType type, uint32_t denominator) {
    type.scaleDenominator = denominator;
    return type;
  };
  switch (kind) {
    case 0:
      return storageImage(Format::R32F);
    case 1:
      return scaled(storageImage(Format::RGBA16F), 2);
    case 2:
      return scaled(storageImage(Format::RGBA32F), 4);
    case 3:
      return buffer("Element");
    default:
      return scaled(buffer("Element"), 2);
  }
}
inline constexpr int kPortKinds = 5;

struct NodeType {
  const char* name;
  std::vector<int> outputs;  ///< kinds
};
inline const std::vector<NodeType>& nodeTypes() {
  static const std::vector<NodeType> kTypes = {
      {"r.A", {0, 0}}, {"r.B", {1, 3}}, {"r.C", {2, 0, 4}}, {"r.D", {3}}, {"r.E", {4, 1, 2}}};
  return kTypes;
}

/// Every type has two inputs of each kind, all optional, and its outputs pass the first of their kind through.
inline Fakes randomFakes() {
  Fakes fakes;
  for (const NodeType& type : nodeTypes()) {
    PassDescription& d = fakes.add(type.name);
    for (int kind = 0; kind < kPortKinds; ++kind)
      for (const char* which : {"a", "b"}) d.input(fmt::format("{}{}", which, kind), portOf(kind)).optional();
    for (size_t o = 0; o < type.outputs.size(); ++o)
      d.output(fmt::format("o{}", o), portOf(type.outputs[o])).passesThrough(fmt::format("a{}", type.outputs[o]));
  }
  return fakes;
}

class RandomGraphs {
 public:
  explicit RandomGraphs(uint32_t seed) : random_(seed) {}

  /// The next graph that compiles. Those that don't have a disabled pass with nothing to stand for it, or look two
  /// frames back.
  CompiledGraph next() {
    for (;; ++refused) {
      json = text();
      Result r;
      r.description = parse(json, "random.json", r.diagnostics);
      CompileOptions options;
      options.width = 61;
      options.height = 37;
      options.keepAll = below(24) == 0;
      r.graph = compile(r.description, catalog_, options, r.diagnostics);
      if (!r.diagnostics.empty()) continue;
      if (below(3) == 0) {
        options.keep = {r.graph.resources[below(static_cast<int>(r.graph.resources.size()))].name};
        r.graph = compile(r.description, catalog_, options, r.diagnostics);
      }
      return r.graph;
    }
  }

  /// What passes turn out to be on a device: where they run, what scratch memory they take.
  void prepare(CompiledGraph& graph) {
    const bool mixed = below(3) > 0;
    for (uint32_t p = 0; p < graph.passes.size(); ++p) {
      graph.passes[p].stages = mixed ? static_cast<Stages>(1 + below(7)) : kComputeStage;
      for (int i = below(4); i > 2; --i) addScratch(graph, p);
    }
  }

  /// What resources ask of memory: odd sizes, alignments of their own, sometimes memory of another type.
  std::vector<MemoryNeed> needs(const CompiledGraph& graph) {
    std::vector<MemoryNeed> needs;
    const bool kinds = below(4) == 0;
    for (const Resource& r : graph.resources) {
      MemoryNeed need;
      need.alignment = uint64_t{1} << below(13);
      need.bytes = r.bytes + static_cast<uint64_t>(below(3) == 0 ? below(5000) : 0);
      if (kinds) need.kinds = std::array{0x1u, 0x3u, 0x6u, 0xffffffffu}[below(4)];
      needs.push_back(need);
    }
    return needs;
  }

  /// Plans it all anew, as the executor does once it knows these things. Sometimes nothing is shared, or blocks are
  /// small.
  void plan(CompiledGraph& graph) {
    prepare(graph);
    planMemory(graph, needs(graph), below(16) != 0, below(4) == 0 ? 20'000 : ~uint64_t{0});
    planBarriers(graph);
  }

  int below(int n) { return static_cast<int>(random_() % static_cast<unsigned>(n)); }
  std::string json;  ///< of the last one
  int refused = 0;

 private:
  void addScratch(CompiledGraph& graph, uint32_t pass) {
    Resource r;
    r.name = graph.passes[pass].name + " scratch";
    r.type = portOf(below(kPortKinds));
    r.width = graph.width;
    r.height = graph.height;
    r.bytes = 4ull * r.width * r.height;
    r.scratch = true;
    r.producer = r.firstUse = r.lastUse = pass;
    graph.passes[pass].scratch.push_back(static_cast<uint32_t>(graph.resources.size()));
    graph.resources.push_back(std::move(r));
  }

  std::string text() {
    const int passes = 1 + below(14);
    std::vector<int> types;
    std::vector<std::string> names;
    for (int i = 0; i < passes; ++i) {
      types.push_back(below(static_cast<int>(nodeTypes().size())));
      // The name says nothing of the place in the order, so that sorting by name is no help.
      names.push_back(fmt::format("p{}", (i * 7 + 3) % 17));
    }
    /// An output of that kind of a pass below `end`, or nothing.
    const auto source = [&](int kind, int end) -> std::string {
      std::vector<std::string> found;
      for (int p = 0; p < end; ++p)
        for (size_t o = 0; o < nodeTypes()[types[p]].outputs.size(); ++o)
          if (kind < 0 || nodeTypes()[types[p]].outputs[o] == kind) found.push_back(fmt::format("{}.o{}", names[p], o));
      return found.empty() ? "" : found[below(static_cast<int>(found.size()))];
    };
    const int density = 2 + below(4);
    std::string text;
    for (int i = 0; i < passes; ++i) {
      std::string inputs;
      for (int kind = 0; kind < kPortKinds; ++kind)
        for (const char* which : {"a", "b"}) {
          if (below(density) != 0) continue;
          const bool previous = below(5) == 0;
          const std::string from = source(kind, previous ? passes : i);
          if (from.empty()) continue;
          inputs += fmt::format("{}\"{}{}\": \"{}{}\"", inputs.empty() ? "" : ", ", which, kind, from,
                                previous ? "@previous" : "");
        }
      text += fmt::format("{}\"{}\": {{\"type\": \"{}\"{}, \"inputs\": {{{}}}}}", i ? ",\n" : "", names[i],
                          nodeTypes()[types[i]].name, below(9) ? "" : ", \"enabled\": false", inputs);
    }
    std::string outputs;
    for (int o = below(3); o >= 0; --o)
      outputs += fmt::format("{}\"q{}\": \"{}{}\"", outputs.empty() ? "" : ", ", o, source(-1, passes),
                             below(6) ? "" : "@previous");
    return "{\"version\": 1, \"passes\": {" + text + "}, \"outputs\": {" + outputs + "}}";
  }

  Fakes fakes_ = randomFakes();
  PassCatalog catalog_ = fakes_.catalog();
  std::mt19937 random_;
};

}  // namespace weir::graph::test
