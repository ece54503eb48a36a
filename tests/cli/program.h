// `weir` as a process: what scripts see of it.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <weir/image/image.h>
#include <weir/image/metrics.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>

#include "support/device.h"
#include "support/pass_test.h"

namespace weir::test {

namespace fs = std::filesystem;

struct Ran {
  int status = -1;
  std::string out, err;
};

inline bool has(const std::string& text, const std::string& words) {
  return text.find(words) != std::string::npos;
}

class Program : public testing::Test {
 protected:
  static std::string read(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  }
  /// Runs `weir` with these words, as a shell splits them.
  Ran weir(const std::string& arguments) const {
    const std::string out = logs_.path() + "/out", err = logs_.path() + "/err";
    const int status =
        std::system((std::string(WEIR_BINARY_DIR) + "/bin/weir " + arguments + " >" + out + " 2>" + err).c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read(out), read(err)};
  }
  /// Bad input: exit status 2, the words on stderr, no output and no file.
  void expectRefused(const std::string& arguments, const std::string& words) const {
    const Ran r = weir(arguments);
    EXPECT_EQ(r.status, 2) << arguments << "\n" << r.err;
    EXPECT_TRUE(has(r.err, words)) << arguments << "\nshould name " << words << ":\n" << r.err;
    EXPECT_EQ(r.out, "") << arguments;
    EXPECT_TRUE(fs::is_empty(folder.path())) << arguments << " left files behind";
  }
  /// `weir render` of a small picture into the test's folder.
  Ran render(const std::string& graph, const std::string& scene, const std::string& more) const {
    return weir("render " + graph + " --scene " + scene + " --device " + deviceChoice() + " --size 32x24 " + more);
  }
  std::string file(const std::string& name) const { return folder.path() + "/" + name; }
  /// Renders radiance into a file, and reads it.
  image::Picture radiance(const std::string& graph, const std::string& scene, const std::string& more,
                          const std::string& name = "radiance.exr") const {
    const Ran r = render(graph, scene, more + " --out radiance=" + file(name));
    EXPECT_EQ(r.status, 0) << r.err;
    return r.status == 0 ? image::readExr(file(name)) : image::Picture{};
  }

  const std::string allLights = sourcePath("graphs/all_lights.json"), restir = sourcePath("graphs/restir_di.json"),
                    cornell = sourcePath("scenes/cornell.glb"), points = sourcePath("scenes/cornell-1000-points.glb");
  TemporaryFolder folder;

 private:
  TemporaryFolder logs_;
};

inline double meanOf(const image::Picture& p) {
  double sum = 0;
  for (size_t i = 0; i < p.rgba.size(); ++i) sum += i % 4 == 3 ? 0.0f : p.rgba[i];
  return sum / (0.75 * static_cast<double>(p.rgba.size()));
}

}  // namespace weir::test
