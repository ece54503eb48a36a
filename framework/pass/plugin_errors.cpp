#include <weir/core/error.h>
#include <weir/pass/plugin_errors.h>

namespace weir {

void PluginErrors::report(void* host, WeirErrorKind kind, const char* text) noexcept {
  auto& errors = *static_cast<PluginErrors*>(host);
  if (errors.kind_ != WEIR_ERROR_NONE) return;  // the first one is the cause
  errors.kind_ = kind == WEIR_ERROR_NONE ? WEIR_ERROR_UNKNOWN : kind;
  try {
    if (text != nullptr) errors.text_ = text;
  } catch (const std::exception&) {
    errors.text_.clear();  // no memory left for the text; the kind remains
  }
}

std::string PluginErrors::text() const {
  if (kind_ == WEIR_ERROR_NONE || !text_.empty()) return text_;
  return kind_ == WEIR_ERROR_UNKNOWN ? "it threw something that is no exception" : "it threw an error without a text";
}

void PluginErrors::raise(const std::string& where) const {
  const std::string message = where + ": " + text();
  if (kind_ == WEIR_ERROR_INPUT) throw InputError(message);
  throw RuntimeError(message);
}

}  // namespace weir
