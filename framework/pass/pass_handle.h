// A pass on the host's side of the plugin boundary: calls go through the plugin's wrappers, errors come out as the
// host's own, and the library stays as long as the pass.
#pragma once

#include <weir/pass/plugin_library.h>

#include <memory>
#include <string>

namespace weir {

class PassHandle {
 public:
  /// A new pass of this entry; `library` is null for passes of the program itself. Throws InputError or RuntimeError,
  /// as the pass's constructor did, naming the type.
  PassHandle(std::shared_ptr<const PluginLibrary> library, const WeirPassEntry& functions, std::string type);
  ~PassHandle();
  PassHandle(const PassHandle&) = delete;
  PassHandle& operator=(const PassHandle&) = delete;

  /// What the pass or a function of `context` throws comes out as InputError if it was one, else as RuntimeError, with
  /// its whole text behind the pass's type and plugin.
  void prepare(PrepareContext& context);
  /// Likewise. Allocates nothing of its own unless the pass fails.
  void record(RecordContext& context);

 private:
  std::string where(const char* function) const;

  std::shared_ptr<const PluginLibrary> library_;  ///< first, so that it goes last
  WeirPassEntry functions_;
  std::string type_;
  Pass* pass_ = nullptr;
};

using PassPtr = std::unique_ptr<PassHandle>;

}  // namespace weir
