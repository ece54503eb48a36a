// What the tests of this room share: a scratch folder, pictures with a fixed seed, mutations of files.
#pragma once

#include <gtest/gtest.h>
#include <weir/core/error.h>
#include <weir/image/image.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <random>
#include <string>
#include <vector>

namespace weir::image {

/// A new empty folder that goes away with the object.
class Scratch {
 public:
  Scratch() {
    std::string name = (std::filesystem::temp_directory_path() / "weir_image_XXXXXX").string();
    if (!mkdtemp(name.data())) throw std::runtime_error("no scratch folder");
    folder_ = name;
  }
  ~Scratch() { std::filesystem::remove_all(folder_); }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  std::string operator/(const std::string& name) const { return (folder_ / name).string(); }
  bool empty() const { return std::filesystem::is_empty(folder_); }
  size_t files() const { return static_cast<size_t>(std::distance(std::filesystem::directory_iterator(folder_), {})); }

 private:
  std::filesystem::path folder_;
};

inline Picture constantPicture(uint32_t width, uint32_t height, float r, float g, float b) {
  Picture picture;
  picture.width = width;
  picture.height = height;
  picture.rgba.resize(4 * size_t{width} * height);
  const float colour[4] = {r, g, b, 1.0f};
  for (size_t i = 0; i < picture.rgba.size(); ++i) picture.rgba[i] = colour[i % 4];
  return picture;
}

inline Picture randomPicture(uint32_t width, uint32_t height, uint32_t seed) {
  Picture picture = constantPicture(width, height, 0, 0, 0);
  std::mt19937 random(seed);
  for (size_t i = 0; i < picture.rgba.size(); ++i) {
    if (i % 4 != 3) picture.rgba[i] = static_cast<float>(random()) * 0x1p-32f;
  }
  return picture;
}

/// Compares bit patterns, so that NaN equals itself.
inline bool sameBits(const std::vector<float>& a, const std::vector<float>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

inline std::vector<unsigned char> readBytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

inline void writeBytes(const std::string& path, const std::vector<unsigned char>& bytes) {
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

/// `call` must throw an InputError whose message contains every one of `parts`.
inline void expectInputError(const std::function<void()>& call, const std::vector<std::string>& parts) {
  try {
    call();
    ADD_FAILURE() << "no InputError";
  } catch (const InputError& error) {
    for (const std::string& part : parts) {
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << "'" << part << "' not in: " << error.what();
    }
  }
}

/// Truncations and byte flips with a fixed seed: `read` returns, or throws InputError that names the file. Anything
/// else that it throws fails the test.
inline void expectSurvivesMutations(const std::string& original, const std::string& mutant, int count,
                                    const std::function<void(const std::string&)>& read) {
  const std::vector<unsigned char> bytes = readBytes(original);
  ASSERT_FALSE(bytes.empty());
  std::mt19937 random(12345);
  for (int i = 0; i < count; ++i) {
    std::vector<unsigned char> changed = bytes;
    if (i % 3 == 0) {
      changed.resize(random() % bytes.size());
    } else {
      // Every other mutation aims at the first bytes, where sizes and types are.
      const size_t reach = i % 3 == 1 ? std::min<size_t>(400, bytes.size()) : bytes.size();
      const int flips = 1 + static_cast<int>(random() % 4);
      for (int f = 0; f < flips; ++f) changed[random() % reach] = static_cast<unsigned char>(random());
    }
    writeBytes(mutant, changed);
    try {
      read(mutant);
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(mutant), std::string::npos) << error.what();
    } catch (const std::exception& error) {
      ADD_FAILURE() << original << " mutation " << i << ": " << error.what();
    }
  }
}

}  // namespace weir::image
