#include <weir/pass/plugin.h>

extern "C" __attribute__((visibility("default"))) const WeirPluginDescriptor* weir_plugin() {
  throw 42;
}
