// Between C and C++: exceptions become a status and a message, structures of the caller's become values. Not for
// others.
#pragma once

#include <fmt/format.h>
#include <weir/core/error.h>
#include <weir/embed/objects.h>
#include <weir/gpu/device.h>

#include <exception>
#include <new>
#include <string>
#include <utility>
#include <vector>

namespace weir::embed {

/// A status that is none of the two errors.
struct OtherStatus {
  WeirStatus status;
  std::string text;
};

/// Runs `work`; nothing gets out. `weir` null: the handle that the caller gave was.
template <typename Work>
WeirStatus call(Weir* weir, Work&& work) noexcept {
  if (weir == nullptr) return WEIR_BAD_INPUT;
  try {
    weir->message.clear();
    weir->lines.clear();
    try {
      work();
      return WEIR_OK;
    } catch (const OtherStatus& other) {
      weir->message = other.text;
      return other.status;
    } catch (const InputError& error) {
      weir->message = error.what();
      return WEIR_BAD_INPUT;
    } catch (const std::exception& error) {
      weir->message = error.what();
    } catch (...) {
      weir->message = "something that is no std::exception was thrown";
    }
  } catch (...) {
    // Not even the message could be kept.
  }
  return WEIR_FAILED;
}

/// The Weir of an object that may be null.
inline Weir* weirOf(WeirContext* context) {
  return context == nullptr ? nullptr : &context->weir;
}
inline Weir* weirOf(WeirScene* scene) {
  return scene == nullptr ? nullptr : &scene->context.weir;
}
inline Weir* weirOf(WeirGraph* graph) {
  return graph == nullptr ? nullptr : &graph->weir();
}

/// Throws InputError unless the pointer is there.
template <typename T>
T& given(T* pointer, const char* what) {
  if (pointer == nullptr) throw InputError(fmt::format("{} is NULL", what));
  return *pointer;
}

/// A structure of embed.h, once its size says that caller and library mean the same one.
template <typename T>
const T& sized(const T* structure, const char* name) {
  const T& value = given(structure, name);
  if (value.size != sizeof(T))
    throw InputError(fmt::format("{}.size is {}; expected sizeof({}) = {} (header and library of one release)", name,
                                 value.size, name, sizeof(T)));
  return value;
}

inline std::string text(const char* value) {
  return value == nullptr ? std::string() : std::string(value);
}

inline std::vector<std::string> texts(const WeirTexts& from, const char* name) {
  std::vector<std::string> result;
  if (from.count > 0) (void)given(from.texts, name);
  for (uint32_t i = 0; i < from.count; ++i) {
    if (from.texts[i] == nullptr) throw InputError(fmt::format("{}[{}] is NULL", name, i));
    result.emplace_back(from.texts[i]);
  }
  return result;
}

inline void refuseWhile(uint32_t children, const char* what) {
  if (children > 0) throw OtherStatus{WEIR_IN_USE, fmt::format("{} of its {} still there", children, what)};
}

gpu::HostDevice hostDevice(const Weir& weir, const WeirHost& host);
GraphSource graphSource(const WeirGraphInfo& info);
graph::CompiledGraph compile(Weir& weir, const GraphSource& source);

}  // namespace weir::embed
