// examples/embed beside `weir render`: the same graph, scene, size, seed and frames give the same picture to the bit.
#include <gtest/gtest.h>
#include <weir/image/image.h>

#include <cstdlib>
#include <fstream>

#include "support/device.h"
#include "support/pass_test.h"

namespace weir::test {
namespace {

constexpr int kBorder = 4;

struct Pfm {
  uint32_t width = 0, height = 0;
  std::vector<float> rgb;
  const float* at(uint32_t x, uint32_t y) const { return &rgb[3 * (size_t{height - 1 - y} * width + x)]; }
};

Pfm readPfm(const std::string& path) {
  Pfm p;
  std::ifstream file(path, std::ios::binary);
  std::string magic, scale;
  file >> magic >> p.width >> p.height >> scale;
  file.get();
  p.rgb.resize(size_t{3} * p.width * p.height);
  file.read(reinterpret_cast<char*>(p.rgb.data()), static_cast<std::streamsize>(p.rgb.size() * sizeof(float)));
  EXPECT_TRUE(file.good() && magic == "PF" && scale == "-1.0") << path;
  return p;
}

TEST(EmbedExample, GivesThePictureOfWeirRender) {
  const TemporaryFolder folder;
  const std::string bin = std::string(WEIR_BINARY_DIR) + "/bin/", log = folder.path() + "/log";
  const std::string graph = sourcePath("graphs/restir_di.json"), scene = sourcePath("scenes/cornell.glb");
  // With validation: any message makes it fail.
  ASSERT_EQ(std::system((bin + "weir_embed_example " + graph + " " + scene + " " + folder.path() +
                         "/node.pfm --size 40x24 --frames 5 --seed 9 --device llvmpipe --validate >" + log + " 2>&1")
                            .c_str()),
            0)
      << std::ifstream(log).rdbuf();
  ASSERT_EQ(std::system((bin + "weir render " + graph + " --scene " + scene +
                         " --size 40x24 --frames 5 --seed 9 --device cpu --out color=" + folder.path() +
                         "/render.exr >" + log + " 2>&1")
                            .c_str()),
            0)
      << std::ifstream(log).rdbuf();
  const Pfm node = readPfm(folder.path() + "/node.pfm");
  const image::Picture render = image::readExr(folder.path() + "/render.exr");
  ASSERT_EQ(node.width, render.width + 2 * kBorder);
  ASSERT_EQ(node.height, render.height + 2 * kBorder);
  float brightest = 0.0f;
  for (uint32_t y = 0; y < render.height; ++y) {
    for (uint32_t x = 0; x < render.width; ++x) {
      for (int c = 0; c < 3; ++c) {
        const float expected = render.rgba[4 * (size_t{y} * render.width + x) + c];
        ASSERT_EQ(node.at(x + kBorder, y + kBorder)[c], expected) << x << " " << y << " channel " << c;
        brightest = std::max(brightest, expected);
      }
    }
  }
  EXPECT_GT(brightest, 0.5f);
  EXPECT_EQ(node.at(0, 0)[2], 0.75f);  // the host's border
  EXPECT_EQ(node.at(node.width - 1, node.height - 1)[0], 0.25f);
}

TEST(EmbedExample, SaysWhatIsWrong) {
  const std::string bin = std::string(WEIR_BINARY_DIR) + "/bin/weir_embed_example ";
  const TemporaryFolder folder;
  const std::string log = folder.path() + "/log";
  const int status = std::system((bin + sourcePath("graphs/template.json") + " no/such.glb " + folder.path() +
                                  "/x.pfm --device llvmpipe >" + log + " 2>&1")
                                     .c_str());
  EXPECT_EQ(WEXITSTATUS(status), 2);
  std::ifstream file(log);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  EXPECT_NE(text.find("no/such.glb"), std::string::npos) << text;
}

}  // namespace
}  // namespace weir::test
