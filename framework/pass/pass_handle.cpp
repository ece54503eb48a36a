#include <weir/core/error.h>
#include <weir/pass/pass_handle.h>
#include <weir/pass/plugin_errors.h>

#include <fmt/format.h>

#include <utility>

namespace weir {

PassHandle::PassHandle(std::shared_ptr<const PluginLibrary> library, const WeirPassEntry& functions, std::string type)
    : library_(std::move(library)), functions_(functions), type_(std::move(type)) {
  PluginErrors errors;
  pass_ = functions_.create(errors.sink());
  if (errors.kind() != WEIR_ERROR_NONE) {
    if (pass_ != nullptr) functions_.destroy(pass_);
    errors.raise(where("constructor"));
  }
  if (pass_ == nullptr) throw RuntimeError(fmt::format("{} made nothing", where("create()")));
}

PassHandle::~PassHandle() {
  functions_.destroy(pass_);
}

void PassHandle::prepare(PrepareContext& context) {
  PluginErrors errors;
  functions_.prepare(pass_, context, errors.sink());
  if (errors.kind() != WEIR_ERROR_NONE) errors.raise(where("prepare()"));
}

void PassHandle::record(RecordContext& context) {
  PluginErrors errors;
  functions_.record(pass_, context, errors.sink());
  if (errors.kind() != WEIR_ERROR_NONE) errors.raise(where("record()"));
}

std::string PassHandle::where(const char* function) const {
  return fmt::format("pass '{}' of plugin '{}', {}", type_, type_.substr(0, type_.find('.')), function);
}

}  // namespace weir
