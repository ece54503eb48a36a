// Frame after frame: history is what the last frame wrote, cleared when told, and no pass reads too early or too late.
#include "execute/graph_run.h"

namespace weir::test {
namespace {

class Counter final : public Pass {
 public:
  static void describe(PassDescription& d) {
    d.input("before", perPixel<Word>());
    d.output("after", perPixel<Word>()).passesThrough("before");
    d.param("step", 1);
  }
  void prepare(PrepareContext& c) override { kernel_ = c.kernel("counter.glsl"); }
  void record(RecordContext& c) override { c.launch(kernel_); }

 private:
  Kernel kernel_;
};

const std::vector<WeirPassEntry> kCounter = {passEntry<Counter>("Counter")};
const std::string kOne = R"({"a": {"type": "own.Counter", "inputs": {"before": "a.after@previous"}}})";
const std::string kTwo = R"({
  "a": {"type": "own.Counter", "inputs": {"before": "b.after@previous"}},
  "b": {"type": "own.Counter", "inputs": {"before": "a.after"}, "params": {"step": 10}}})";

void expectAll(GraphRun& g, const std::string& resource, uint32_t expected, const std::string& what) {
  const auto values = g.read(resource);
  ASSERT_EQ(values.size(), 256u);
  EXPECT_EQ(std::ranges::count(values, expected), 256) << what << ": " << values[0] << " instead of " << expected;
}

TEST(History, CountsFrames) {
  GraphRun g(kOne, "a.after", kCounter, {});
  for (uint32_t f = 1; f <= 7; ++f) {
    g.run();
    expectAll(g, "a.after", 1000 + f, "frame " + std::to_string(f));
  }
  g.run(40);  // none of them waited for
  expectAll(g, "a.after", 1047, "after a run");
}

TEST(History, IsClearedToTheLayoutsEmptyValue) {
  GraphRun g(kOne, "a.after", kCounter, {});
  for (const uint32_t frames : {1u, 2u, 3u, 4u}) {
    g.executor().resetHistory();
    g.run(frames);
    expectAll(g, "a.after", 1000 + frames, "reset by hand");
    g.next.cut = true;
    g.run();
    g.next.cut = false;
    expectAll(g, "a.after", 1001, "a camera cut");
  }
}

TEST(History, GoesThroughDisabledPasses) {
  GraphRun both(kTwo, "b.after", kCounter, {});
  both.run(5);
  expectAll(both, "b.after", 1055, "two counters");
  GraphRun withoutB(kTwo, "b.after", kCounter, {.overrides = {.set = {}, .enable = {}, .disable = {"b"}}});
  withoutB.run(5);
  expectAll(withoutB, "a.after", 1005, "the second one disabled");
  GraphRun withoutA(kTwo, "b.after", kCounter, {.overrides = {.set = {"b.step=3"}, .enable = {}, .disable = {"a"}}});
  withoutA.run(4);
  expectAll(withoutA, "b.after", 1012, "the first one disabled");
}

class Stage final : public Pass {
 public:
  static void describe(PassDescription& d) {
    d.input("from", perPixel<Word>()).optional();
    d.input("image", storageImage(Format::R32U)).optional();
    d.input("old", perPixel<Word>()).optional();
    d.output("to", perPixel<Word>());
    d.output("image", storageImage(Format::R32U));
    d.param("salt", 0);
    d.needs(Need::FrameIndex);
  }
  void prepare(PrepareContext& c) override {
    c.scratch("half", perPixel<Word>());
    first_ = c.kernel("stage.glsl", {.bind = {}, .defines = {{"FIRST", "1"}}, .sources = {}});
    second_ = c.kernel("stage.glsl");
  }
  void record(RecordContext& c) override {
    c.launch(first_);
    c.launch(second_);
  }

 private:
  Kernel first_, second_;
};

struct Link {
  const char *name, *from, *image, *old;  ///< names of other stages, or null
};
// Chains, a diamond, and edges across the frame both ways: 16 kernels.
const Link kLinks[] = {{"a", nullptr, nullptr, "h"}, {"b", "a", nullptr, nullptr}, {"c", "a", "a", "c"},
                       {"d", "b", "c", nullptr},     {"e", "c", "d", "b"},         {"f", "d", "b", "e"},
                       {"g", "f", "e", nullptr},     {"h", "g", "a", "a"}};

uint32_t stir(uint32_t x) {
  return hashOf(x);
}

TEST(History, ChainsOfKernelsReadWhatTheyShould) {
  constexpr uint32_t kWidth = 61, kHeight = 37, kPixels = kWidth * kHeight, kFrames = 5;  // fits no group of 8 × 8
  std::string passes;
  for (size_t i = 0; i < std::size(kLinks); ++i) {
    const Link& l = kLinks[i];
    std::string inputs;
    const auto input = [&](const char* port, const char* stage, const std::string& what) {
      if (stage != nullptr)
        inputs += (inputs.empty() ? "\"" : ", \"") + std::string(port) + "\": \"" + stage + what + "\"";
    };
    input("from", l.from, ".to");
    input("image", l.image, ".image");
    input("old", l.old, ".to@previous");
    passes += std::string(i == 0 ? "{\"" : ", \"") + l.name + R"(": {"type": "own.Stage", "inputs": {)" + inputs +
              R"(}, "params": {"salt": )" + std::to_string(i + 1) + "}}";
  }
  GraphRun g(passes + "}", "h.to", {passEntry<Stage>("Stage")}, {.width = kWidth, .height = kHeight});
  // Poison: nothing may depend on what memory held before.
  for (const Link& l : kLinks) {
    const std::vector<std::byte> poison(kPixels * 4, std::byte{0xcd});
    g.executor().writeResource(std::string(l.name) + ".to", poison);
    g.executor().writeResource(std::string(l.name) + ".image", poison);
  }
  g.next.index = 3;
  g.run(kFrames);

  std::map<std::string, std::vector<uint32_t>> now, before;
  for (const Link& l : kLinks) before[l.name].assign(kPixels, 1000);
  for (uint32_t frame = 3; frame < 3 + kFrames; ++frame) {
    for (size_t s = 0; s < std::size(kLinks); ++s) {
      const Link& l = kLinks[s];
      const auto salt = static_cast<uint32_t>((s + 1) * 0x9e3779b9u);
      std::vector<uint32_t> half(kPixels), to(kPixels);
      for (uint32_t i = 0; i < kPixels; ++i) {
        const uint32_t other = (i * 7 + 13) % kPixels;
        half[i] = i + salt + frame;
        if (l.from != nullptr) half[i] += stir(now[l.from][other]);
        if (l.image != nullptr) half[i] ^= stir((now[l.image][other] ^ 0x55aa55aau) + 1);
      }
      for (uint32_t i = 0; i < kPixels; ++i) {
        const uint32_t other = (i * 5 + 3) % kPixels;
        to[i] = stir(half[other]) + (i + salt + frame);
        if (l.old != nullptr) to[i] += 3 * before[l.old][other];
      }
      now[l.name] = to;
    }
    before = now;
  }
  for (const Link& l : kLinks) {
    EXPECT_EQ(g.read(std::string(l.name) + ".to"), now[l.name]) << l.name;
    auto image = g.read(std::string(l.name) + ".image");
    for (uint32_t& v : image) v ^= 0x55aa55aau;
    EXPECT_EQ(image, now[l.name]) << l.name << "'s image";
  }
}

}  // namespace
}  // namespace weir::test
