// What a pass throws, wherever and whatever, comes out as an error of the host, and the host lives on.
#include <weir/core/error.h>
#include <weir/pass/registry.h>

#include <gtest/gtest.h>

#include <cstdlib>
#include <new>

#include "pass/contexts.h"
#include "pass/plugin_files.h"

namespace {
size_t allocations = 0;
}

// Counts what the whole program takes from the heap, its plugins included. Inlined, g++ would see free() after new.
[[gnu::noinline]] void* operator new(size_t bytes) {
  ++allocations;
  if (void* memory = std::malloc(bytes)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept {
  std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, size_t) noexcept {
  std::free(memory);
}

namespace weir {
namespace {

enum class Kind { None, Input, Runtime, Foreign };

struct Outcome {
  Kind kind = Kind::None;
  std::string text;
};

template <typename Call>
Outcome outcomeOf(const Call& call) {
  try {
    call();
  } catch (const InputError& error) {
    return {Kind::Input, error.what()};
  } catch (const RuntimeError& error) {
    return {Kind::Runtime, error.what()};
  } catch (...) {
    return {Kind::Foreign, "what the plugin threw has crossed the boundary"};
  }
  return {};
}

/// Makes, prepares and records a pass.
Outcome run(Registry& registry, const std::string& type, NotingPrepare prepare = {}) {
  return outcomeOf([&] {
    const PassPtr pass = registry.create(type);
    pass->prepare(prepare);
    NotingRecord record;
    pass->record(record);
  });
}

void expectWords(const Outcome& outcome, const std::vector<std::string>& words) {
  for (const std::string& word : words)
    EXPECT_NE(outcome.text.find(word), std::string::npos) << "'" << word << "' in: " << outcome.text;
}

TEST(Boundary, EveryKindOfThrowFromEveryFunction) {
  Registry registry({folderOf("throwing")});
  const struct {
    const char *name, *words;
  } places[] = {{"Constructor", "constructor"}, {"Prepare", "prepare()"}, {"Record", "record()"}};
  const struct {
    const char* name;
    Kind kind;
    const char* words;
  } kinds[] = {{"Input", Kind::Input, "the aspect must not be zero"},
               {"Runtime", Kind::Runtime, "the disk is full"},
               {"Other", Kind::Runtime, "index 7 of 3"},
               {"Int", Kind::Runtime, "no exception"}};
  for (const auto& place : places)
    for (const auto& kind : kinds) {
      const std::string type = std::string("throwing.") + place.name + kind.name;
      const Outcome outcome = run(registry, type);
      EXPECT_EQ(outcome.kind, kind.kind) << type << ": " << outcome.text;
      expectWords(outcome, {type, "plugin 'throwing'", place.words, kind.words});
    }
  EXPECT_TRUE(registry.problems().empty()) << "the plugin itself is in order";
}

TEST(Boundary, AnErrorWithoutATextIsSaid) {
  Registry registry({folderOf("throwing")});
  const Outcome outcome = run(registry, "throwing.WithoutText");
  EXPECT_EQ(outcome.kind, Kind::Runtime);
  expectWords(outcome, {"throwing.WithoutText", "without a text"});
}

TEST(Boundary, WhatTheHostThrowsInsideAPassKeepsKindAndWholeText) {
  Registry registry({folderOf("throwing")});
  NotingPrepare failing;
  for (int line = 0; line < 2000; ++line) failing.failure += "asks.glsl:" + std::to_string(line) + ": undeclared\n";
  const Outcome prepared = run(registry, "throwing.Asks", failing);
  EXPECT_EQ(prepared.kind, Kind::Runtime);
  expectWords(prepared, {failing.failure, "throwing.Asks", "prepare()"});

  const Outcome recorded = run(registry, "throwing.Asks");
  EXPECT_EQ(recorded.kind, Kind::Input) << recorded.text;
  expectWords(recorded, {"parameter 'undeclared'", "nearest: 'amount'", "record()"});
}

TEST(Boundary, APassThatThrewCanBeCalledAgain) {
  Registry registry({folderOf("throwing")});
  const PassPtr pass = registry.create("throwing.Asks");
  NotingPrepare failing, fine;
  failing.failure = "asks.glsl:1: syntax error";
  EXPECT_THROW(pass->prepare(failing), RuntimeError);
  pass->prepare(fine);
  EXPECT_EQ(fine.kernels, std::vector<std::string>{"asks.glsl"});
}

TEST(Boundary, RecordingTakesNothingFromTheHeap) {
  Registry registry({folderOf("good")});
  const PassPtr pass = registry.create("good.Nothing");
  NotingRecord record;
  const size_t before = allocations;
  for (int frame = 0; frame < 100; ++frame) pass->record(record);
  EXPECT_EQ(allocations, before);
  const std::string counted(100, 'x');
  EXPECT_EQ(allocations, before + 1) << "the counter counts";
}

}  // namespace
}  // namespace weir
