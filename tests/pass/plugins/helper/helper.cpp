extern "C" __attribute__((visibility("default"))) const char* weirTestHelperText() {
  return "from the helper";
}
