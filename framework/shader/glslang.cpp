// The one file that speaks to glslang.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glslang/Public/ResourceLimits.h>
#include <glslang/Public/ShaderLang.h>
#include <glslang/SPIRV/GlslangToSpv.h>
#include <weir/shader/digest.h>
#include <weir/shader/sources.h>

#include <algorithm>
#include <mutex>
#include <set>

namespace weir::shader {
namespace {

EShLanguage languageOf(Stage stage) {
  switch (stage) {
    case Stage::RayGeneration:
      return EShLangRayGen;
    case Stage::ClosestHit:
      return EShLangClosestHit;
    case Stage::AnyHit:
      return EShLangAnyHit;
    case Stage::Miss:
      return EShLangMiss;
    case Stage::Vertex:
      return EShLangVertex;
    case Stage::Fragment:
      return EShLangFragment;
    case Stage::Compute:
      break;
  }
  return EShLangCompute;
}

/// Answers glslang's requests from `Sources`, and says why when it can't.
class Includer final : public glslang::TShader::Includer {
 public:
  Includer(Sources& sources, const std::string& root) : sources_(sources), stack_{root} {}

  IncludeResult* includeLocal(const char* name, const char* includer, size_t) override {
    return include(name, includer, false);
  }

  /// glslang asks here too after `includeLocal` failed: then that failure's words are the better ones.
  IncludeResult* includeSystem(const char* name, const char* includer, size_t) override {
    if (!failure_.empty()) return failed();
    IncludeResult* result = include(name, includer, true);
    return result ? result : failed();
  }

  void releaseInclude(IncludeResult* result) override {
    if (!result) return;
    if (!result->headerName.empty()) stack_.pop_back();
    delete result;
  }

 private:
  IncludeResult* include(const std::string& name, const std::string& includer, bool system) {
    const Sources::File* file = sources_.resolve(name, includer, system);
    if (!file) {
      failure_ =
          fmt::format("there is no such file: looked for {}", fmt::join(sources_.places(name, includer, system), ", "));
      return nullptr;
    }
    if (std::ranges::find(stack_, file->path) != stack_.end()) {
      failure_ = fmt::format("it includes itself: {} > {}", fmt::join(stack_, " > "), file->path);
      return nullptr;
    }
    static constexpr size_t kDeepest = 64;
    if (stack_.size() > kDeepest) {
      failure_ = fmt::format("includes are nested deeper than {}", kDeepest);
      return nullptr;
    }
    const bool skip = !seen_.insert(file).second && file->once;
    stack_.push_back(file->path);
    return new IncludeResult(file->path, skip ? "" : file->text.data(), skip ? 0 : file->text.size(), nullptr);
  }

  IncludeResult* failed() {
    words_ = std::exchange(failure_, {});
    return new IncludeResult("", words_.data(), words_.size(), nullptr);
  }

  Sources& sources_;
  std::vector<std::string> stack_;  ///< the files that are open now, the shader first
  std::set<const Sources::File*> seen_;
  std::string failure_, words_;
};

/// Findings of the whole shader (its version, no entry point) come without a place.
bool hasLineNumber(std::string_view finding) {
  for (size_t at = finding.find(':'); at != std::string_view::npos; at = finding.find(':', at + 1)) {
    const size_t end = finding.find_first_not_of("0123456789", at + 1);
    if (end != std::string_view::npos && end > at + 1 && finding[end] == ':') return true;
  }
  return false;
}

/// "ERROR: file:line: text" becomes "file:line: text"; summaries and warnings are left out.
std::string findings(const std::string& log, const std::string& name) {
  std::string text;
  size_t at = 0;
  while (at < log.size()) {
    const size_t end = std::min(log.find('\n', at), log.size());
    std::string line = log.substr(at, end - at);
    at = end + 1;
    if (!line.starts_with("ERROR: ") || line.ends_with("No code generated.")) continue;
    line.erase(0, 7);
    while (line.ends_with(' ')) line.pop_back();
    if (!hasLineNumber(line)) line = name + ": " + line;
    text += (text.empty() ? "" : "\n") + line;
  }
  return text.empty() ? fmt::format("{}: glslang failed without saying why: {}", name, log) : text;
}

std::string preambleOf(const CompileRequest& request) {
  std::string text = "#extension GL_GOOGLE_include_directive : require\n";
  for (const auto& [name, value] : request.defines) text += fmt::format("#define {} {}\n", name, value);
  return text;
}

}  // namespace

std::vector<uint32_t> compileToSpirv(const CompileRequest& request, Sources& sources) {
  static std::once_flag once;  // glslang keeps tables for the whole process
  std::call_once(once, [] { glslang::InitializeProcess(); });

  const EShLanguage language = languageOf(request.stage);
  glslang::TShader shader(language);
  const char* text = request.source.data();
  const int length = static_cast<int>(request.source.size());
  const char* name = request.name.c_str();
  const std::string preamble = preambleOf(request);
  shader.setStringsWithLengthsAndNames(&text, &length, &name, 1);
  shader.setPreamble(preamble.c_str());
  shader.setEnvInput(glslang::EShSourceGlsl, language, glslang::EShClientVulkan, 100);
  shader.setEnvClient(glslang::EShClientVulkan, glslang::EShTargetVulkan_1_3);
  shader.setEnvTarget(glslang::EShTargetSpv, glslang::EShTargetSpv_1_6);

  // Cascading: all errors, not the first one alone.
  const auto messages =
      static_cast<EShMessages>(EShMsgSpvRules | EShMsgVulkanRules | EShMsgSuppressWarnings | EShMsgCascadingErrors);
  Includer includer(sources, request.name);
  if (!shader.parse(GetDefaultResources(), 460, ECoreProfile, false, false, messages, includer)) {
    throw CompileError(findings(shader.getInfoLog(), request.name));
  }
  glslang::TProgram program;
  program.addShader(&shader);
  if (!program.link(messages)) throw CompileError(findings(program.getInfoLog(), request.name));

  glslang::SpvOptions options;
  options.disableOptimizer = true;  // drivers optimise themselves; ours would only make edits slower to see
  options.generateDebugInfo = kShaderDebugInfo;
  std::vector<uint32_t> spirv;
  glslang::GlslangToSpv(*program.getIntermediate(language), spirv, &options);
  return spirv;
}

std::string compilerVersion() {
  const glslang::Version version = glslang::GetVersion();
  return fmt::format("glslang {}.{}.{}{} generator {} debug {}", version.major, version.minor, version.patch,
                     version.flavor, glslang::GetSpirvGeneratorVersion(), kShaderDebugInfo);
}

}  // namespace weir::shader
