// A rebuilt plugin takes the old one's place: description and code; and the old one is really gone.
#include <weir/core/error.h>
#include <weir/pass/registry.h>

#include <gtest/gtest.h>

#include <set>

#include "pass/contexts.h"
#include "pass/plugin_files.h"

namespace weir {
namespace {

/// The files under which the plugin's libraries are mapped into this process. A name says "(deleted)" when the file is
/// gone, as it should be.
std::set<std::string> mapped() {
  std::set<std::string> files;
  std::ifstream maps("/proc/self/maps");
  for (std::string line; std::getline(maps, line);)
    if (line.find("libweir_reload.so") != std::string::npos) files.insert(line.substr(line.find('/')));
  return files;
}

class Reload : public Plugins {
 protected:
  void SetUp() override {
    Plugins::SetUp();
    install("version1");
    ASSERT_TRUE(mapped().empty());
  }
  /// Writes over the library in place, as a linker may do: that must not reach the code that runs.
  void install(const std::string& version) const {
    const fs::path from = folderOf("reload-" + version);
    fs::copy_file(from / "libweir_reload.so", library(), fs::copy_options::overwrite_existing);
    fs::copy_file(from / "weir_reload.json", scratch / "weir_reload.json", fs::copy_options::overwrite_existing);
  }
  fs::path library() const { return scratch / "libweir_reload.so"; }
  static uint32_t record(const PassPtr& pass) {
    NotingRecord context;
    pass->record(context);
    return context.last;
  }
  static std::string prepare(const PassPtr& pass) {
    NotingPrepare context;
    pass->prepare(context);
    return context.kernels.at(0);
  }
  static std::string refusal(Registry& registry, const std::string& plugin = "reload") {
    try {
      registry.reload(plugin);
    } catch (const InputError& error) {
      return error.what();
    }
    ADD_FAILURE() << "it must be refused";
    return {};
  }
};

TEST_F(Reload, DescriptionAndCodeChangeAndThePassMadeBeforeRunsOn) {
  Registry registry({scratch});
  PassPtr old = registry.create("reload.It");
  const PassDescription* oldDescription = registry.find("reload.It");
  const PassDescription* gone = registry.find("reload.Gone");
  EXPECT_EQ(record(old), 101u);
  const std::set<std::string> first = mapped();
  ASSERT_EQ(first.size(), 1u);

  install("version2");
  EXPECT_EQ(registry.find("reload.It"), oldDescription) << "only reload() looks at the files";
  registry.reload("reload");
  const PassDescription* now = registry.find("reload.It");
  ASSERT_NE(now, nullptr);
  EXPECT_NE(now, oldDescription);
  EXPECT_EQ(now->text, "Version 2");
  EXPECT_EQ(registry.find("reload.Gone"), nullptr);
  EXPECT_EQ(registry.problem("reload.Gone"), "plugin 'reload' has no pass 'Gone'");
  EXPECT_EQ(registry.types(), (std::vector<std::string>{"reload.Added", "reload.It"}));

  PassPtr made = registry.create("reload.It");
  EXPECT_EQ(record(made), 201u) << "its static variables are its own";
  EXPECT_EQ(prepare(made), "version 2");
  EXPECT_EQ(record(old), 102u);
  EXPECT_EQ(prepare(old), "version 1");
  EXPECT_EQ(mapped().size(), 2u);

  old.reset();
  const std::set<std::string> second = mapped();
  ASSERT_EQ(second.size(), 1u) << "the old library goes with its last pass";
  EXPECT_EQ(second.count(*first.begin()), 0u);
  EXPECT_EQ(record(made), 202u);

  // The descriptions of the library that is gone are whole.
  EXPECT_EQ(oldDescription->text, "Version 1");
  EXPECT_EQ(oldDescription->type, "reload.It");
  EXPECT_EQ(oldDescription->outputs.at(0).type.layout.glsl(), "struct Versioned1 {\n  float field1;\n};\n");
  EXPECT_EQ(std::get<std::string>(oldDescription->params.at(0).defaultValue), "1");
  EXPECT_EQ(oldDescription->params.at(0).choices, (std::vector<std::string>{"1", "other"}));
  EXPECT_EQ(gone->type, "reload.Gone");
  EXPECT_EQ(now->outputs.at(0).type.layout.glsl(), "struct Versioned2 {\n  float field2;\n};\n");
}

TEST_F(Reload, NothingStaysMappedAndNoFileStays) {
  {
    Registry registry({scratch});
    const PassPtr pass = registry.create("reload.It");
    EXPECT_EQ(record(pass), 101u);
    ASSERT_EQ(mapped().size(), 1u);
    std::string copy = *mapped().begin();
    EXPECT_EQ(copy.find(scratch.string()), std::string::npos) << "a private copy";
    EXPECT_NE(copy.find("(deleted)"), std::string::npos) << copy;
    copy = copy.substr(0, copy.find("/copy/"));
    EXPECT_FALSE(fs::exists(copy)) << "its folder is removed";
  }
  EXPECT_TRUE(mapped().empty());
  Registry registry({scratch});
  EXPECT_EQ(record(registry.create("reload.It")), 101u) << "a library that was gone begins anew";
}

TEST_F(Reload, APassOutlivesItsRegistry) {
  PassPtr pass;
  {
    Registry registry({scratch});
    pass = registry.create("reload.It");
  }
  EXPECT_EQ(record(pass), 101u);
  pass.reset();
  EXPECT_TRUE(mapped().empty());
}

TEST_F(Reload, ABrokenOneLeavesTheOldOneInPlace) {
  Registry registry({scratch});
  const PassDescription* description = registry.find("reload.It");
  const PassPtr pass = registry.create("reload.It");
  const auto unchanged = [&] {
    EXPECT_EQ(registry.find("reload.It"), description);
    EXPECT_TRUE(registry.problems().empty());
    EXPECT_EQ(prepare(registry.create("reload.Gone")), "version 1");
    EXPECT_EQ(prepare(pass), "version 1");
    EXPECT_EQ(mapped().size(), 1u) << "what was refused is not kept";
  };
  const auto says = [&](const std::string& words) {
    const std::string message = refusal(registry);
    EXPECT_NE(message.find(words), std::string::npos) << words << " in: " << message;
    EXPECT_NE(message.find(scratch.filename().string()), std::string::npos) << message;
    unchanged();
  };

  write("libweir_reload.so", "this is no library");
  says("no ELF header");
  fs::copy_file(folderOf("reload-version2") / "libweir_reload.so", library(), fs::copy_options::overwrite_existing);
  fs::resize_file(library(), fs::file_size(library()) / 2);
  says("incomplete");
  fs::remove(library());
  says("does not exist");
  install("refused");
  says("half-finished");
  install("version2");
  write("weir_reload.json", "{");
  says("not valid JSON");
  write("weir_reload.json", manifest("other", "libweir_reload.so"));
  says("the manifest of 'other' now");
  write("weir_reload.json", manifest("reload", "libweir_reload.so", "1"));
  says("ABI 1");
  fs::remove(scratch / "weir_reload.json");
  says("can't be read");

  install("version2");
  registry.reload("reload");
  EXPECT_EQ(registry.find("reload.It")->text, "Version 2");
}

TEST_F(Reload, WhatWasRefusedCanBeMended) {
  write("weir_reload.json", "{");
  Registry registry({scratch});
  expectRefused(registry, "reload.It", {"not valid JSON"});
  EXPECT_EQ(registry.pluginFiles("reload").size(), 1u);
  install("refused");
  EXPECT_NE(refusal(registry).find("half-finished"), std::string::npos);
  install("version1");
  registry.reload("reload");
  EXPECT_EQ(registry.find("reload.It")->text, "Version 1");
  EXPECT_TRUE(registry.problems().empty());
}

TEST_F(Reload, BeforeItWasAskedFor) {
  Registry registry({scratch});
  install("version2");
  registry.reload("reload");
  EXPECT_EQ(registry.find("reload.It")->text, "Version 2");
}

TEST_F(Reload, FilesToWatch) {
  Registry registry({scratch});
  const fs::path real = fs::canonical(scratch);
  EXPECT_EQ(registry.pluginFiles("reload"),
            (std::vector<fs::path>{real / "weir_reload.json", real / "libweir_reload.so"}));
  fs::rename(library(), scratch / "moved.so");
  write("weir_reload.json", manifest("reload", "moved.so"));
  registry.reload("reload");
  EXPECT_EQ(registry.pluginFiles("reload").at(1), real / "moved.so");
  EXPECT_TRUE(registry.pluginFiles("nobody").empty());
}

class Own final : public Pass {
 public:
  static void describe(PassDescription& d) { d.output("o", storageImage(Format::R32F)); }
  void prepare(PrepareContext&) override {}
  void record(RecordContext&) override {}
};

TEST_F(Reload, WhatHasNoFilesCant) {
  Registry registry({scratch});
  const WeirPassEntry entries[] = {passEntry<Own>("Own")};
  registry.add("here", entries);
  EXPECT_NE(refusal(registry, "here").find("part of the program"), std::string::npos);
  EXPECT_NE(refusal(registry, "nobody").find("no plugin 'nobody'"), std::string::npos);
  EXPECT_TRUE(registry.pluginFiles("here").empty());
  EXPECT_THROW(registry.add("reload", entries), InputError) << "also once it is loaded";
}

}  // namespace
}  // namespace weir
