// A library that is no plugin.
extern "C" int weir_plugin_is_not_here() {
  return 1;
}
