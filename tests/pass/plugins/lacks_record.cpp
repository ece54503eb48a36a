// Entries written by hand, one without all of its functions.
#include "test_pass.h"

extern "C" __attribute__((visibility("default"))) const WeirPluginDescriptor* weir_plugin() {
  static WeirPassEntry entry = weir::passEntry<TestPass>("Nothing");
  entry.record = nullptr;
  static const WeirPluginDescriptor descriptor = {WEIR_ABI_VERSION, WEIR_BUILD_TAG, "lacks_record", 1, &entry};
  return &descriptor;
}
