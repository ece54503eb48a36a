#include <weir/scene/gltf_import.h>

#include <algorithm>
#include <bit>
#include <cstring>

namespace weir::scene {
namespace {

// Zeros cost no bytes in the file, so their number needs a bound of its own.
constexpr uint64_t kMaxZeroElements = 1u << 22;

uint64_t componentSize(int type) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return 1;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return 2;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
      return 4;
    default:
      return 0;
  }
}

template <class T>
T readAs(const uint8_t* at) {
  static_assert(std::endian::native == std::endian::little, "glTF is little-endian");
  T value;
  std::memcpy(&value, at, sizeof value);
  return value;
}

uint32_t readUnsigned(const uint8_t* at, int type) {
  if (type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE) return *at;
  if (type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT) return readAs<uint16_t>(at);
  return readAs<uint32_t>(at);
}

}  // namespace

AccessorView::AccessorView(GltfImport& import, int accessor) {
  const auto& a = import.model.accessors[accessor];
  const std::string place = "/accessors/" + std::to_string(accessor);
  componentType_ = a.componentType;
  normalized_ = a.normalized;
  count_ = a.count;
  switch (a.type) {
    case TINYGLTF_TYPE_SCALAR:
      components_ = 1;
      break;
    case TINYGLTF_TYPE_VEC2:
      components_ = 2;
      break;
    case TINYGLTF_TYPE_VEC3:
      components_ = 3;
      break;
    case TINYGLTF_TYPE_VEC4:
      components_ = 4;
      break;
    case TINYGLTF_TYPE_MAT4:
      // Columns of other component types would be padded; inverse bind matrices are floats.
      if (componentType_ != TINYGLTF_COMPONENT_TYPE_FLOAT) import.file.fail(place, "a matrix that is not of floats");
      components_ = 16;
      break;
    default:
      import.file.fail(place, "a matrix is no vertex attribute");
  }
  const uint64_t one = componentSize(componentType_);
  if (one == 0) import.file.fail(place, "unknown componentType " + std::to_string(componentType_));
  elementSize_ = one * components_;
  dropNormalizedWhereMeaningless();

  // All numbers below fit in 53 bits (schema); count · stride is checked by division.
  const auto slice = [&](int view, uint64_t offset, uint64_t stride, uint64_t count, uint64_t size,
                         const std::string& what) {
    const auto bytes = import.file.bufferView(view);
    if (offset > bytes.size() || size > bytes.size() - offset || (count - 1) > (bytes.size() - offset - size) / stride)
      import.file.fail(what, std::to_string(count) + " elements of " + std::to_string(size) + " bytes at a stride of " +
                                 std::to_string(stride) + " from byte " + std::to_string(offset) +
                                 " do not fit in the " + std::to_string(bytes.size()) + " bytes of the view");
    return bytes.subspan(offset);
  };

  if (a.bufferView >= 0) {
    stride_ = import.model.bufferViews[a.bufferView].byteStride;
    if (stride_ == 0) stride_ = elementSize_;
    if (stride_ < elementSize_) import.file.fail(place, "elements are larger than the view's byteStride");
    bytes_ = slice(a.bufferView, a.byteOffset, stride_, count_, elementSize_, place);
  } else if (count_ > kMaxZeroElements) {
    import.file.fail(place, std::to_string(count_) + " elements without a bufferView");
  }

  if (!a.sparse.isSparse) return;
  const std::string sparse = place + "/sparse";
  const uint64_t count = static_cast<uint64_t>(a.sparse.count);
  const int type = a.sparse.indices.componentType;
  if (count > count_) import.file.fail(sparse, "has more elements than the accessor");
  if (type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE && type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
      type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT)
    import.file.fail(sparse + "/indices", "unknown componentType " + std::to_string(type));
  const uint64_t indexSize = componentSize(type);
  const auto indices =
      slice(a.sparse.indices.bufferView, a.sparse.indices.byteOffset, indexSize, count, indexSize, sparse + "/indices");
  sparseValues_ = slice(a.sparse.values.bufferView, a.sparse.values.byteOffset, elementSize_, count, elementSize_,
                        sparse + "/values");
  sparseIndices_.resize(count);
  for (uint64_t i = 0; i < count; ++i) {
    sparseIndices_[i] = readUnsigned(indices.data() + i * indexSize, type);
    if (sparseIndices_[i] >= count_ || (i > 0 && sparseIndices_[i] <= sparseIndices_[i - 1]))
      import.file.fail(sparse + "/indices", "not strictly increasing indices below " + std::to_string(count_));
  }
}

AccessorView::AccessorView(const DracoGeometry::Attribute& attribute, uint64_t count, bool normalized)
    : bytes_(attribute.bytes),
      count_(count),
      components_(attribute.components),
      componentType_(attribute.componentType),
      normalized_(normalized) {
  elementSize_ = stride_ = componentSize(componentType_) * components_;
  dropNormalizedWhereMeaningless();
}

void AccessorView::dropNormalizedWhereMeaningless() {
  // A mild and common fault.
  if (componentType_ == TINYGLTF_COMPONENT_TYPE_FLOAT || componentType_ == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT)
    normalized_ = false;
}

const uint8_t* AccessorView::element(uint64_t i) const {
  if (!sparseIndices_.empty()) {
    const auto found = std::lower_bound(sparseIndices_.begin(), sparseIndices_.end(), i);
    if (found != sparseIndices_.end() && *found == i)
      return sparseValues_.data() + static_cast<uint64_t>(found - sparseIndices_.begin()) * elementSize_;
  }
  return bytes_.empty() ? nullptr : bytes_.data() + i * stride_;
}

float AccessorView::value(uint64_t i, int c) const {
  const uint8_t* at = element(i);
  if (!at) return 0.0f;
  switch (componentType_) {
    case TINYGLTF_COMPONENT_TYPE_BYTE: {
      const float v = readAs<int8_t>(at + c);
      return normalized_ ? std::max(v / 127.0f, -1.0f) : v;
    }
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE: {
      const float v = at[c];
      return normalized_ ? v / 255.0f : v;
    }
    case TINYGLTF_COMPONENT_TYPE_SHORT: {
      const float v = readAs<int16_t>(at + 2 * c);
      return normalized_ ? std::max(v / 32767.0f, -1.0f) : v;
    }
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT: {
      const float v = readAs<uint16_t>(at + 2 * c);
      return normalized_ ? v / 65535.0f : v;
    }
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return static_cast<float>(readAs<uint32_t>(at + 4 * c));
    default:
      return readAs<float>(at + 4 * c);
  }
}

uint32_t AccessorView::index(uint64_t i) const {
  const uint8_t* at = element(i);
  return at ? readUnsigned(at, componentType_) : 0u;
}

}  // namespace weir::scene
