// The plugins that tests/pass/options.cmake builds, and a folder for copies of them.
#pragma once

#include <gtest/gtest.h>
#include <weir/core/error.h>
#include <weir/pass/registry.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace weir {

namespace fs = std::filesystem;

inline fs::path folderOf(const std::string& plugin) {
  return fs::path(TEST_PLUGIN_FOLDER) / plugin;
}

inline std::string libraryOf(const std::string& plugin) {
  return (folderOf(plugin) / ("libweir_" + plugin + ".so")).string();
}

class Plugins : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    scratch = fs::temp_directory_path() / (std::string("weir_plugins_") + test->name());
    fs::remove_all(scratch);
    fs::create_directories(scratch);
  }
  void TearDown() override { fs::remove_all(scratch); }

  fs::path write(const std::string& name, const std::string& text) const {
    fs::create_directories((scratch / name).parent_path());
    std::ofstream(scratch / name) << text;
    return scratch / name;
  }
  static std::string manifest(const std::string& name, const std::string& library, const std::string& abi = "",
                              const std::string& tag = WEIR_BUILD_TAG) {
    return "{\"name\": \"" + name + "\", \"library\": \"" + library +
           "\", \"abi\": " + (abi.empty() ? std::to_string(WEIR_ABI_VERSION) : abi) + ", \"buildTag\": \"" + tag +
           "\"}";
  }
  fs::path scratch;
};

inline void expectRefused(Registry& registry, const std::string& type, const std::vector<std::string>& words) {
  EXPECT_EQ(registry.find(type), nullptr);
  const std::string problem = registry.problem(type);
  for (const std::string& word : words) EXPECT_NE(problem.find(word), std::string::npos) << word << " in: " << problem;
  try {
    registry.create(type);
    ADD_FAILURE() << type << " must not be made";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find(problem), std::string::npos) << error.what();
  }
}

}  // namespace weir
