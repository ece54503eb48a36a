// The rules that a pass description must keep. A breach is a defect of the plugin, found when the plugin is loaded and
// not when a graph happens to use the pass.
#include <weir/core/error.h>
#include <weir/pass/description.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace weir {
namespace {

bool isLetter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

/// Names become GLSL identifiers and JSON keys.
bool isIdentifier(const std::string& name) {
  return !name.empty() && isLetter(name[0]) && std::all_of(name.begin(), name.end(), [](char c) {
    return isLetter(c) || (c >= '0' && c <= '9') || c == '_';
  });
}

class Checker {
 public:
  explicit Checker(const PassDescription& description) : d_(description) {}

  void check() const {
    names(d_.inputs, "input");
    names(d_.outputs, "output");
    names(d_.params, "parameter");
    for (const PortDescription& port : d_.inputs) input(port);
    for (const PortDescription& port : d_.outputs) output(port);
    for (const ParamDescription& p : d_.params) param(p);
  }

 private:
  template <typename... T>
  [[noreturn]] void fail(fmt::format_string<T...> text, T&&... args) const {
    throw InputError(fmt::format("pass '{}': ", d_.type) + fmt::format(text, std::forward<T>(args)...));
  }

  template <typename T>
  void names(const std::vector<T>& items, const char* what) const {
    std::set<std::string> seen;
    for (const T& item : items) {
      if (!isIdentifier(item.name))
        fail("{} name '{}' is not an identifier (letters, digits and '_', starting with a letter)", what, item.name);
      if (!seen.insert(item.name).second) fail("{} '{}' is declared twice", what, item.name);
    }
  }

  void port(const PortDescription& p, const char* what) const {
    if (p.type.scaleNumerator == 0 || p.type.scaleDenominator == 0)
      fail("{} '{}' has scale {}/{}; both must be at least 1", what, p.name, p.type.scaleNumerator,
           p.type.scaleDenominator);
    if (p.type.perPixel == 0) fail("{} '{}' has no element a pixel", what, p.name);
    if (p.type.kind == PortKind::Image && p.type.fixedCount != 0)
      fail("{} '{}' is an image with a count of elements; only buffers have one", what, p.name);
    if (p.type.kind == PortKind::Buffer && p.type.layout.stride == 0)
      fail("{} '{}' has a layout '{}' without fields or with a field of unknown type", what, p.name,
           p.type.layout.name);
  }

  void input(const PortDescription& p) const {
    port(p, "input");
    if (!p.passesThrough.empty()) fail("input '{}' passes something through; only outputs can", p.name);
    if (!p.type.perPixelFromParam.empty() || !p.type.perPixelFromInput.empty())
      fail("input '{}' takes its count from elsewhere; only outputs can (use anyCount)", p.name);
  }

  void output(const PortDescription& p) const {
    port(p, "output");
    if (!p.required) fail("output '{}' is optional; only inputs can be", p.name);
    if (p.type.anyPerPixel) fail("output '{}' has any count; only inputs can (use times or countOf)", p.name);
    if (!p.passesThrough.empty() && !d_.findInput(p.passesThrough))
      fail("output '{}' passes through '{}', which is not an input", p.name, p.passesThrough);
    const bool fromParam = !p.type.perPixelFromParam.empty(), fromInput = !p.type.perPixelFromInput.empty();
    if (p.type.kind == PortKind::Image && (fromParam || fromInput || p.type.perPixel != 1))
      fail("output '{}' is an image; only buffers have a count of elements a pixel", p.name);
    if (fromParam && fromInput) fail("output '{}' takes its count both from a parameter and from an input", p.name);
    if ((fromParam || fromInput) && p.type.fixedCount != 0)
      fail("output '{}' has a fixed count and one that depends on the pixel", p.name);
    if (fromParam) {
      const ParamDescription* from = d_.findParam(p.type.perPixelFromParam);
      if (!from || from->type != ParamType::Int)
        fail("output '{}' has as many elements as '{}' says, which is not an integer parameter", p.name,
             p.type.perPixelFromParam);
    }
    if (fromInput) {
      const PortDescription* from = d_.findInput(p.type.perPixelFromInput);
      if (!from || from->type.kind != PortKind::Buffer || from->type.fixedCount != 0 || !from->required)
        fail("output '{}' has as many elements as input '{}', which is not a required per-pixel buffer input", p.name,
             p.type.perPixelFromInput);
    }
  }

  /// T is the parameter's own type: 0.7f lies in [0.7, 1] although it is less than 0.7.
  template <typename T>
  void number(const ParamDescription& p, T value) const {
    if (!std::isfinite(static_cast<double>(value))) fail("parameter '{}' has a default that is not finite", p.name);
    if ((p.low && value < static_cast<T>(*p.low)) || (p.high && value > static_cast<T>(*p.high)))
      fail("parameter '{}' has default {} outside its range [{}, {}]", p.name, value, *p.low, *p.high);
  }

  void param(const ParamDescription& p) const {
    const bool numeric = p.type == ParamType::Int || p.type == ParamType::Float;
    if (p.low || p.high) {
      if (!numeric) fail("parameter '{}' has a range but is no number", p.name);
      if (!p.low || !p.high || !(*p.low <= *p.high)) fail("parameter '{}' has an empty range", p.name);
    }
    switch (p.type) {
      case ParamType::Bool:
        return expect(p, std::holds_alternative<bool>(p.defaultValue));
      case ParamType::Int:
        expect(p, std::holds_alternative<int32_t>(p.defaultValue));
        return number<double>(p, std::get<int32_t>(p.defaultValue));
      case ParamType::Float:
        expect(p, std::holds_alternative<float>(p.defaultValue));
        return number(p, std::get<float>(p.defaultValue));
      case ParamType::String:
        return expect(p, std::holds_alternative<std::string>(p.defaultValue));
      case ParamType::Enum:
        return enumeration(p);
    }
    fail("parameter '{}' has an unknown type", p.name);
  }

  void expect(const ParamDescription& p, bool right) const {
    if (!right) fail("parameter '{}' is declared {} but its default is not", p.name, paramTypeName(p.type));
  }

  void enumeration(const ParamDescription& p) const {
    expect(p, std::holds_alternative<std::string>(p.defaultValue));
    std::set<std::string> seen;
    for (const std::string& choice : p.choices)
      if (choice.empty() || !seen.insert(choice).second)
        fail("parameter '{}' has the choice '{}' twice or an empty one", p.name, choice);
    if (!seen.count(std::get<std::string>(p.defaultValue)))
      fail("parameter '{}' has default '{}', which is none of its choices", p.name,
           std::get<std::string>(p.defaultValue));
  }

  const PassDescription& d_;
};

}  // namespace

void PassDescription::check() const {
  Checker(*this).check();
}

}  // namespace weir
