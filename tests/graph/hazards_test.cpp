// Random graphs, executed by a model of memory that is stricter than Vulkan: every copy of every resource needs
// barriers of its own.
#include "fakes.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <random>

namespace weir::graph::test {
namespace {

constexpr int kInputs = 3;

/// One copy of a resource.
struct Memory {
  int writtenInFrame = -1;
  bool unwritten = true;     ///< nothing to be careful about yet
  bool visible = false;      ///< the write can be read
  bool writeIsOver = false;  ///< the write can be overwritten
  bool readsAreOver = true;  ///< all reads since the write are known to be over

  void barrier(Access before, Access after) {
    if (before == Access::Write && after == Access::Read) visible = true;
    if (before == Access::Write && after == Access::Write) writeIsOver = true;
    // A chain: the write was made visible to the reads, which are now over.
    if (before == Access::Read && after == Access::Write) readsAreOver = true, writeIsOver |= visible;
  }
};

class Machine {
 public:
  explicit Machine(const CompiledGraph& graph) : graph_(graph), memory_(graph.resources.size()) {}

  void frame(int number) {
    for (const CompiledPass& pass : graph_.passes) {
      for (const Barrier& b : pass.barriers) copy(b.resource, b.previous, number).barrier(b.before, b.after);
      for (const Binding& input : pass.inputs)
        if (input.resource != kNone)
          read(copy(input.resource, input.previous, number), number - (input.previous ? 1 : 0), pass.name);
      for (const Binding& output : pass.outputs) write(copy(output.resource, false, number), number, pass.name);
    }
    if (number % 2 == 0) return;  // outputs are looked at now and then, with barriers on both sides
    for (const GraphOutput& output : graph_.outputs) {
      Memory& m = copy(output.resource, output.previous, number);
      m.barrier(Access::Write, Access::Read);
      read(m, number - (output.previous ? 1 : 0), "output " + output.name);
      m.barrier(Access::Read, Access::Write);
    }
  }
  std::string fault;
  int barriers = 0;

 private:
  Memory& copy(uint32_t resource, bool previous, int number) {
    if (!graph_.resources[resource].history) {
      if (previous) fault = "a resource without history is read as previous";
      return memory_[resource][0];
    }
    return memory_[resource][static_cast<size_t>(previous ? number + 1 : number) % 2];
  }
  void read(Memory& m, int wantedFrame, const std::string& pass) {
    if (m.unwritten && wantedFrame < 0) return;  // the clear, which execution takes care of
    if (m.writtenInFrame != wantedFrame) fault = pass + " reads a value of another frame";
    if (!m.visible) fault = pass + " reads what is not visible yet";
    m.readsAreOver = false;
  }
  void write(Memory& m, int number, const std::string& pass) {
    if (!m.unwritten && !m.readsAreOver) fault = pass + " overwrites what may still be read";
    if (!m.unwritten && !m.writeIsOver) fault = pass + " overwrites what may still be written";
    m = {number, false, false, false, true};
  }

  const CompiledGraph& graph_;
  std::vector<std::array<Memory, 2>> memory_;
};

Fakes fakesForRandom() {
  Fakes fakes;
  PassDescription& node = fakes.add("r.Node");
  for (const char* port : {"a", "b", "c"}) node.input(port, storageImage(Format::R32F)).optional();
  node.output("x", storageImage(Format::R32F)).passesThrough("a");
  node.output("y", storageImage(Format::R32F)).passesThrough("b");
  return fakes;
}

std::string randomGraph(std::mt19937& random) {
  const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  const int passes = 1 + below(12);
  // The name says nothing of the place in the order, so that sorting by name is no help.
  std::vector<std::string> names;
  for (int i = 0; i < passes; ++i) names.push_back(fmt::format("p{}", (i * 7 + 3) % 13));
  const auto reference = [&](int pass, bool previous) {
    return "\"" + names[pass] + (below(2) ? ".x" : ".y") + (previous ? "@previous\"" : "\"");
  };
  std::string text;
  for (int i = 0; i < passes; ++i) {
    std::string inputs;
    for (int k = 0; k < kInputs; ++k) {
      const int kind = below(4);
      if (kind == 0 || (kind < 3 && i == 0)) continue;
      inputs += (inputs.empty() ? "\"" : ", \"") + std::string(1, static_cast<char>('a' + k)) +
                "\": " + (kind < 3 ? reference(below(i), false) : reference(below(passes), true));
    }
    text += (i ? ",\n" : "") +
            ("\"" + names[i] + "\": {\"type\": \"r.Node\"" + (below(8) ? "" : ", \"enabled\": false")) +
            ", \"inputs\": {" + inputs + "}}";
  }
  std::string outputs = "\"o\": " + reference(below(passes), false);
  if (below(3) == 0) outputs += ", \"q\": " + reference(below(passes), true);
  return "{\"version\": 1, \"passes\": {" + text + "}, \"outputs\": {" + outputs + "}}";
}

TEST(Hazards, NoneInRandomGraphs) {
  const Fakes fakes = fakesForRandom();
  std::mt19937 random(20240607);
  int compiled = 0, refused = 0, withHistory = 0;
  while (compiled < 2000) {
    const std::string json = randomGraph(random);
    const Result r = run(json, fakes);
    if (!r.diagnostics.empty()) {  // a disabled pass with nothing to stand for it, or two frames back
      ASSERT_LT(++refused, 20000);
      continue;
    }
    ++compiled;
    Machine machine(r.graph);
    for (int frame = 0; frame < 5; ++frame) machine.frame(frame);
    ASSERT_EQ(machine.fault, "") << json << "\n" << explain(r.graph);
    for (const Resource& resource : r.graph.resources) withHistory += resource.history ? 1 : 0;
  }
  EXPECT_GT(withHistory, 500) << "the generator must make interesting graphs";
}

TEST(Hazards, TheModelSeesAMissingBarrier) {
  const Fakes fakes = fakesForRandom();
  std::mt19937 random(7);
  int removed = 0;
  while (removed < 300) {
    const std::string json = randomGraph(random);
    Result r = run(json, fakes);
    if (!r.diagnostics.empty()) continue;
    for (CompiledPass& pass : r.graph.passes)
      for (size_t b = 0; b < pass.barriers.size(); ++b) {
        const Barrier kept = pass.barriers[b];
        pass.barriers.erase(pass.barriers.begin() + static_cast<std::ptrdiff_t>(b));
        Machine machine(r.graph);
        for (int frame = 0; frame < 5; ++frame) machine.frame(frame);
        // A copy that is read in the frame it is written in is visible already when it is read as previous one frame
        // later; that barrier is only there for the clear. Outputs have barriers from outside.
        const bool spare =
            (kept.previous && kept.after == Access::Read) || r.graph.resources[kept.resource].graphOutput;
        if (!spare) {
          ASSERT_NE(machine.fault, "") << json << "\n" << explain(r.graph) << r.graph.resources[kept.resource].name;
        }
        pass.barriers.insert(pass.barriers.begin() + static_cast<std::ptrdiff_t>(b), kept);
        ++removed;
      }
  }
}

}  // namespace
}  // namespace weir::graph::test
