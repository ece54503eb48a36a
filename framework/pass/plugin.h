// What a plugin library exports: one C function that returns plain data. Passes are C++ objects all the same, so host
// and plugin must be built alike; the ABI version and the build tag say whether they were, and are compared before
// anything is called.
//
//   #include <weir/pass/plugin.h>
//   #include <restir_di/initial.h>
//   WEIR_PLUGIN("restir_di", weir::passEntry<weir::restir_di::Initial>("Initial"))
#pragma once

#include <weir/pass/description.h>
#include <weir/pass/pass.h>

#include <cstdint>

extern "C" {

/// One pass. `describe` fills in ports and parameters and may throw; `create` and `destroy` come in pairs, so that an
/// object is freed by the library that made it.
struct WeirPassEntry {
  const char* name;  ///< without the plugin: "Initial"
  void (*describe)(weir::PassDescription&);
  weir::Pass* (*create)();
  void (*destroy)(weir::Pass*);
};

/// abiVersion and buildTag stay first for ever: they are read before the rest is trusted.
struct WeirPluginDescriptor {
  uint32_t abiVersion;
  const char* buildTag;
  const char* name;  ///< as in the manifest
  uint32_t passCount;
  const WeirPassEntry* passes;
};

using WeirPluginFunction = const WeirPluginDescriptor* (*)();
}

namespace weir {

/// T has `static void describe(PassDescription&)` and a default constructor.
template <typename T>
constexpr WeirPassEntry passEntry(const char* name) {
  return {name, [](PassDescription& description) { T::describe(description); }, []() -> Pass* { return new T; },
          [](Pass* pass) { delete pass; }};
}

}  // namespace weir

/// WEIR_PLUGIN("name", weir::passEntry<A>("A"), weir::passEntry<B>("B")): once in a plugin library.
#define WEIR_PLUGIN(pluginName, ...)                                                                \
  extern "C" __attribute__((visibility("default"))) const WeirPluginDescriptor* weir_plugin() {     \
    static const WeirPassEntry entries[] = {__VA_ARGS__};                                           \
    static const WeirPluginDescriptor descriptor = {WEIR_ABI_VERSION, WEIR_BUILD_TAG, pluginName,   \
                                                    sizeof(entries) / sizeof(entries[0]), entries}; \
    return &descriptor;                                                                             \
  }
