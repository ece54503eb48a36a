// A picture from a file as the reference: what fits is taken, what does not is said.
#include <weir/core/error.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>

#include "view/compare/file_reference.h"
#include "view_compare/theatre.h"

namespace weir::test {
namespace {

class FileReferenceTest : public Theatre {
 protected:
  FileReferenceTest() {
    picture_.width = 8;
    picture_.height = 6;
    for (size_t i = 0; i < size_t{4} * 8 * 6; ++i) picture_.rgba.push_back(i % 4 == 3 ? 1.0f : 0.25f * float(i));
  }
  std::string write(const std::string& name) {
    std::string file = folder_.path() + "/" + name;
    image::writeExr(file, picture_);
    return file;
  }
  view::FileReference open(const std::string& file) { return {*device_, file, stage_, "none", 8, 6}; }
  std::string problem(const std::string& file) {
    try {
      open(file);
    } catch (const InputError& error) {
      return error.what();
    }
    return "none";
  }

  TemporaryFolder folder_;
  image::Picture picture_;
};

TEST_F(FileReferenceTest, IsThePictureOnBothSides) {
  picture_.attributes["weir.scene"] = stage_.sceneLabel;
  picture_.attributes["weir.camera"] = stage_.cameraLabel;
  view::FileReference reference = open(write("a.exr"));
  EXPECT_EQ(reference.warning(), "");
  EXPECT_EQ(reference.latest()->picture.rgba, picture_.rgba);
  EXPECT_EQ(reference.latest()->frames, 0u);
  EXPECT_EQ(read(*reference.image()).rgba, picture_.rgba);
  EXPECT_EQ(reference.step(10.0), 0u);
  EXPECT_NE(reference.words().find("a.exr, 8x6"), std::string::npos) << reference.words();
}

TEST_F(FileReferenceTest, WhatShowsSomethingElseIsAWarning) {
  picture_.attributes["weir.camera"] = "another one";
  view::FileReference reference = open(write("a.exr"));
  EXPECT_NE(reference.warning().find("another one"), std::string::npos) << reference.warning();
  EXPECT_EQ(reference.warning().find("pixels"), std::string::npos);
  const uint64_t view = reference.view();
  reference.restart(shown_, 8, 6);
  EXPECT_EQ(reference.warning().find("has moved"), std::string::npos);
  shown_.camera.eye.x += 1.0f;
  reference.restart(shown_, 100, 50);
  EXPECT_EQ(reference.view(), view) << "it is the same picture";
  EXPECT_NE(reference.warning().find("8x6 pixels and 100x50"), std::string::npos) << reference.warning();
  EXPECT_NE(reference.warning().find("has moved"), std::string::npos);
  shown_.camera.eye.x -= 1.0f;
  reference.restart(shown_, 8, 6);
  EXPECT_EQ(reference.warning().find("has moved"), std::string::npos) << "and is back";
}

TEST_F(FileReferenceTest, BadFilesAreRefusedInWords) {
  EXPECT_NE(problem(folder_.path() + "/missing.exr").find("missing.exr"), std::string::npos);
  EXPECT_NE(problem(folder_.write("text.exr", "no picture")).find("text.exr"), std::string::npos);
  image::writePng(folder_.path() + "/a.png", picture_, image::Encoding::Radiance);
  EXPECT_NE(problem(folder_.path() + "/a.png").find("PNG"), std::string::npos);
  const std::string whole = shader::readFile(write("whole.exr"));
  EXPECT_NE(problem(folder_.write("half.exr", whole.substr(0, whole.size() / 2))).find("half.exr"), std::string::npos);
  picture_.rgba[5] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_NE(problem(write("nan.exr")).find("not finite"), std::string::npos);
}

}  // namespace
}  // namespace weir::test
