// What a plugin library exports: one C function that returns plain data. Passes are C++ objects all the same, so host
// and plugin must be built alike; the ABI version and the build tag say whether they were, and are compared before
// anything is called.
//
//   #include <weir/pass/plugin.h>
//   #include <restir_di/initial.h>
//   WEIR_PLUGIN("restir_di", weir::passEntry<weir::restir_di::Initial>("Initial"))
//
// No exception crosses the boundary. Every function of a plugin is wrapped by passEntry<T>, inside the plugin, in one
// that catches whatever is thrown, by the pass or by a function of the host that the pass called, and hands it over as
// a kind and a text; the host throws its own InputError or RuntimeError from that.
#pragma once

#include <weir/core/error.h>
#include <weir/pass/description.h>
#include <weir/pass/pass.h>

#include <cstdint>
#include <exception>
#include <memory>

extern "C" {

enum WeirErrorKind : uint32_t {
  WEIR_ERROR_NONE = 0,
  WEIR_ERROR_INPUT,    ///< weir::InputError: the user can mend it
  WEIR_ERROR_RUNTIME,  ///< weir::RuntimeError
  WEIR_ERROR_OTHER,    ///< another std::exception
  WEIR_ERROR_UNKNOWN   ///< thrown, but no std::exception: there is no text
};

/// Where a plugin's function puts what went wrong. `report` is the host's; it copies the text (may be null) into what
/// `host` points to and throws nothing.
struct WeirErrorSink {
  void* host;
  void (*report)(void* host, WeirErrorKind kind, const char* text) noexcept;
};

/// One pass. `describe` fills in ports and parameters; `create` and `destroy` come in pairs, so that an object is freed
/// by the library that made it. What fails is reported before the function returns, and `create` then returns null.
/// `destroy` has nothing to report: destructors of passes throw nothing.
struct WeirPassEntry {
  const char* name;  ///< without the plugin: "Initial"
  void (*describe)(weir::PassDescription&, const WeirErrorSink*) noexcept;
  weir::Pass* (*create)(const WeirErrorSink*) noexcept;
  void (*destroy)(weir::Pass*) noexcept;
  void (*prepare)(weir::Pass*, weir::PrepareContext&, const WeirErrorSink*) noexcept;
  void (*record)(weir::Pass*, weir::RecordContext&, const WeirErrorSink*) noexcept;
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

/// Calls and reports what is thrown. Compiled into the plugin, so that an exception is caught, and its object freed, by
/// the library that knows its type.
template <typename Call>
void guardedCall(const WeirErrorSink* errors, const Call& call) noexcept {
  try {
    call();
  } catch (const InputError& error) {
    errors->report(errors->host, WEIR_ERROR_INPUT, error.what());
  } catch (const RuntimeError& error) {
    errors->report(errors->host, WEIR_ERROR_RUNTIME, error.what());
  } catch (const std::exception& error) {
    errors->report(errors->host, WEIR_ERROR_OTHER, error.what());
  } catch (...) {
    errors->report(errors->host, WEIR_ERROR_UNKNOWN, nullptr);
  }
}

/// T has `static void describe(PassDescription&)` and a default constructor.
template <typename T>
constexpr WeirPassEntry passEntry(const char* name) {
  return {name,
          [](PassDescription& description, const WeirErrorSink* errors) noexcept {
            guardedCall(errors, [&] { T::describe(description); });
          },
          [](const WeirErrorSink* errors) noexcept {
            Pass* made = nullptr;
            guardedCall(errors, [&] { made = std::make_unique<T>().release(); });
            return made;
          },
          [](Pass* pass) noexcept { delete pass; },
          [](Pass* pass, PrepareContext& context, const WeirErrorSink* errors) noexcept {
            guardedCall(errors, [&] { pass->prepare(context); });
          },
          [](Pass* pass, RecordContext& context, const WeirErrorSink* errors) noexcept {
            guardedCall(errors, [&] { pass->record(context); });
          }};
}

}  // namespace weir

/// WEIR_PLUGIN("name", weir::passEntry<A>("A"), weir::passEntry<B>("B")): once in a plugin library.
#define WEIR_PLUGIN(pluginName, ...)                                                                     \
  extern "C" __attribute__((visibility("default"))) const WeirPluginDescriptor* weir_plugin() noexcept { \
    static constexpr WeirPassEntry entries[] = {__VA_ARGS__};                                            \
    static constexpr WeirPluginDescriptor descriptor = {WEIR_ABI_VERSION, WEIR_BUILD_TAG, pluginName,    \
                                                        sizeof(entries) / sizeof(entries[0]), entries};  \
    return &descriptor;                                                                                  \
  }
