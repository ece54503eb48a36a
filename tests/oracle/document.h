// A glTF file as JSON and bytes, and its accessors as plain numbers. Written from the glTF 2.0 specification alone: the
// oracle shares no reader with the framework, so that a misreading of a file is not made twice.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace weir::oracle {

using Json = nlohmann::json;

/// Numbers of an accessor, element by element.
struct Values {
  size_t count = 0, components = 0;
  std::vector<double> numbers;
  double at(size_t element, size_t component) const { return numbers[element * components + component]; }
  explicit operator bool() const { return count > 0; }
};

class Document {
 public:
  /// .gltf or .glb. Throws InputError: unreadable, not glTF 2.0, or an extension that the oracle doesn't know.
  explicit Document(const std::string& path);

  const Json& json() const { return json_; }
  const std::string& path() const { return path_; }

  /// Normalised integers become numbers in [0,1] or [-1,1]; sparse accessors are refused. Throws InputError.
  Values accessor(size_t index) const;
  /// Encoded bytes of an image, from its view or file.
  std::vector<unsigned char> imageBytes(size_t image) const;

  /// Throws InputError "path: place: what".
  [[noreturn]] void fail(const std::string& place, const std::string& what) const;

 private:
  struct View {
    const unsigned char* bytes;
    size_t length, stride;
  };
  View view(size_t index) const;
  std::vector<unsigned char> readUri(const std::string& uri, const std::string& place) const;

  std::string path_;
  Json json_;
  std::vector<std::vector<unsigned char>> buffers_;
};

}  // namespace weir::oracle
