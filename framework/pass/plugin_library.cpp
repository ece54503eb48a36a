#include <weir/core/error.h>
#include <weir/pass/plugin_library.h>
#include <weir/pass/plugin_loader.h>

#include <dlfcn.h>
#include <fmt/format.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string>

namespace weir {
namespace {

namespace fs = std::filesystem;

/// A folder that only this user can enter, gone again at the end of the scope. `inner` lies two levels down: a run path
/// of $ORIGIN/.. must not lead into the folder of all temporary files, where anybody can put a library.
class PrivateFolder {
 public:
  explicit PrivateFolder(const fs::path& innerName) {
    std::error_code error;
    const fs::path temporary = fs::temp_directory_path(error);
    if (error) throw InputError(fmt::format("there is no folder for temporary files, see TMPDIR: {}", error.message()));
    std::string name = (temporary / "weir-plugin-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr)
      throw InputError(fmt::format("no temporary folder {}: {}", name, std::strerror(errno)));
    root_ = name;
    inner_ = root_ / "copy" / innerName;
    fs::create_directories(inner_);
  }
  ~PrivateFolder() {
    std::error_code ignored;
    fs::remove_all(root_, ignored);
  }
  PrivateFolder(const PrivateFolder&) = delete;
  PrivateFolder& operator=(const PrivateFolder&) = delete;
  const fs::path& inner() const { return inner_; }

 private:
  fs::path root_, inner_;
};

std::string bytesOf(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// Links from `to` to every library and folder in `from`, except to what has that name. What can't be listed or linked
/// is not there: the linker says so if it was needed.
void linkAll(const fs::path& from, const fs::path& to, const fs::path& except) {
  std::error_code error;
  for (fs::directory_iterator entry(from, error), end; !error && entry != end; entry.increment(error)) {
    std::error_code ignored;
    const fs::path name = entry->path().filename();
    const bool wanted = name.string().find(".so") != std::string::npos || entry->is_directory(ignored);
    if (wanted && name != except) fs::create_symlink(entry->path(), to / name, ignored);
  }
}

/// Copies the library. If it has a run path relative to itself, by which it finds libraries that it brought, its
/// surroundings are there too: what lies beside it and beside its folder.
fs::path copyInto(const fs::path& inner, const fs::path& library) {
  fs::path copy = inner / library.filename();
  const fs::path folder = library.parent_path();
  fs::copy_file(library, copy);
  const std::string bytes = bytesOf(copy);
  if (bytes.find("$ORIGIN") != std::string::npos) linkAll(folder, inner, library.filename());
  if (bytes.find("$ORIGIN/..") != std::string::npos)
    linkAll(folder.parent_path(), inner.parent_path(), inner.filename());
  return copy;
}

/// The linker's message, with the file that the user knows in place of the copy.
std::string lastLinkError(const std::string& copy, const std::string& library) {
  const char* error = dlerror();
  std::string text = error != nullptr ? error : "unknown reason";
  for (size_t at = text.find(copy); at != std::string::npos; at = text.find(copy, at + library.size()))
    text.replace(at, copy.size(), library);
  return text;
}

const WeirPluginDescriptor* callPlugin(void* symbol, const std::string& who) {
  try {
    return reinterpret_cast<WeirPluginFunction>(symbol)();  // WEIR_PLUGIN's can't throw; one by hand might
  } catch (const std::exception& thrown) {
    throw InputError(fmt::format("{}: weir_plugin threw: {}", who, thrown.what()));
  } catch (...) {
    throw InputError(fmt::format("{}: weir_plugin threw something that is no exception", who));
  }
}

}  // namespace

void compareBuild(const std::string& who, uint32_t abi, std::string_view buildTag) {
  if (abi != WEIR_ABI_VERSION)
    throw InputError(fmt::format("{} is built for plugin ABI {}, this Weir has ABI {}; rebuild the plugin", who, abi,
                                 WEIR_ABI_VERSION));
  if (buildTag != WEIR_BUILD_TAG)
    throw InputError(
        fmt::format("{} has build tag '{}', this Weir has '{}'; rebuild the plugin", who, buildTag, WEIR_BUILD_TAG));
}

std::shared_ptr<const PluginLibrary> PluginLibrary::open(const PluginManifest& manifest) {
  const std::string who = fmt::format("plugin '{}' ({})", manifest.name, manifest.library.string());
  compareBuild(fmt::format("plugin '{}' (manifest {})", manifest.name, manifest.file.string()), manifest.abi,
               manifest.buildTag);
  std::error_code error;
  if (!fs::exists(manifest.library, error))
    throw InputError(fmt::format("{}: the library named by {} does not exist", who, manifest.file.string()));

  const std::shared_ptr<PluginLibrary> library(new PluginLibrary);
  try {
    const fs::path real = fs::canonical(manifest.library), name = real.parent_path().filename();
    const PrivateFolder folder(name.empty() ? "weir" : name);
    library->copy_ = copyInto(folder.inner(), real);
    checkSharedLibrary(library->copy_, who);  // the copy: the file itself may be written to at this moment
    library->handle_ = dlopen(library->copy_.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (library->handle_ == nullptr)
      throw InputError(fmt::format("{} can't be loaded: {}", who,
                                   lastLinkError(library->copy_.string(), manifest.library.string())));
  } catch (const fs::filesystem_error& failed) {
    throw InputError(fmt::format("{} can't be copied: {}", who, failed.what()));
  }

  void* symbol = dlsym(library->handle_, "weir_plugin");
  if (symbol == nullptr) throw InputError(fmt::format("{} does not export the function weir_plugin", who));
  const WeirPluginDescriptor* descriptor = callPlugin(symbol, who);
  if (descriptor == nullptr) throw InputError(fmt::format("{}: weir_plugin returned nothing", who));
  compareBuild(who, descriptor->abiVersion, descriptor->buildTag != nullptr ? descriptor->buildTag : "");
  if (descriptor->name == nullptr || manifest.name != descriptor->name)
    throw InputError(fmt::format("{} calls itself '{}'; its manifest {} says '{}'", who,
                                 descriptor->name != nullptr ? descriptor->name : "", manifest.file.string(),
                                 manifest.name));
  if (descriptor->passCount > 0 && descriptor->passes == nullptr)
    throw InputError(fmt::format("{} announces {} passes and lists none", who, descriptor->passCount));
  library->descriptor_ = descriptor;
  return library;
}

PluginLibrary::~PluginLibrary() {
  if (handle_ != nullptr) dlclose(handle_);
}

}  // namespace weir
