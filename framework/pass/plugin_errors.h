// The host's end of the plugin boundary: receives what a plugin's function reports, and throws it as an error of ours.
#pragma once

#include <weir/pass/plugin.h>

#include <string>

namespace weir {

/// Lives for one call into a plugin. Allocates nothing while nothing is reported.
class PluginErrors {
 public:
  PluginErrors() : sink_{this, &PluginErrors::report} {}
  PluginErrors(const PluginErrors&) = delete;
  PluginErrors& operator=(const PluginErrors&) = delete;

  const WeirErrorSink* sink() const { return &sink_; }
  WeirErrorKind kind() const { return kind_; }  ///< WEIR_ERROR_NONE when all went well
  /// The exception's text; of something that is no exception, words that say so.
  std::string text() const;
  /// Throws InputError for what the plugin threw as InputError, else RuntimeError: "<where>: <text>".
  [[noreturn]] void raise(const std::string& where) const;

 private:
  static void report(void* host, WeirErrorKind kind, const char* text) noexcept;

  WeirErrorSink sink_;
  WeirErrorKind kind_ = WEIR_ERROR_NONE;
  std::string text_;
};

}  // namespace weir
