// A shader's text and everything that it includes, found and read once: what is hashed is what is compiled.
#pragma once

#include <weir/shader/compiler.h>

#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace weir::shader {

class Sources {
 public:
  struct File {
    std::string path;  ///< for messages; of a virtual file its name
    std::string text;
    bool isVirtual = false;
    bool once = false;  ///< has #pragma once, which glslang itself ignores
  };

  /// `request` must outlive this.
  explicit Sources(const CompileRequest& request);

  /// What `#include` of `name` in `includer` means: virtual files, then (unless `system`) the includer's own folder,
  /// then the include folders. nullptr when there is none.
  const File* resolve(std::string_view name, std::string_view includer, bool system);
  /// Where `resolve` looks, in words, for the message that says a file isn't there.
  std::vector<std::string> places(std::string_view name, std::string_view includer, bool system) const;

  /// Follows every #include of the request's text, whatever #if it stands in. What cannot be found is left to the
  /// compiler to complain about, since an #if may keep it out.
  void followAll();

  /// Everything resolved so far, by path.
  const std::map<std::string, std::unique_ptr<File>, std::less<>>& files() const { return files_; }

 private:
  struct Include {
    std::string name;
    bool system = false;
  };
  static std::vector<Include> scan(std::string_view text);
  const File* read(const std::string& path);

  const CompileRequest& request_;
  std::map<std::string, std::unique_ptr<File>, std::less<>> files_;  ///< null: looked for and not there
};

/// Compiles without any cache. Appends nothing to `request`; throws CompileError.
std::vector<uint32_t> compileToSpirv(const CompileRequest& request, Sources& sources);

}  // namespace weir::shader
