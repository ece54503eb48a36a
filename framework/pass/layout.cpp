// Layouts, formats, and whether what one port writes can be read through another.
#include <weir/pass/description.h>

#include <fmt/format.h>

namespace weir {

std::string Layout::glsl() const {
  std::string text = fmt::format("struct {} {{\n", name);
  for (const LayoutField& field : fields) text += fmt::format("  {} {};\n", field.type, field.name);
  return text + "};\n";
}

Layout makeLayout(const char* name, uint32_t version, uint32_t emptyWord, const Field* fields, size_t count) {
  Layout layout;
  layout.name = name;
  layout.version = version;
  layout.emptyWord = emptyWord;
  layout.stride = std430Stride(fields, count);
  for (size_t i = 0; i < count; ++i) layout.fields.push_back({fields[i].type, fields[i].name});
  // Separators keep ("ab", "c") apart from ("a", "bc").
  uint64_t hash = fnv1a(fmt::format("{} v{}", name, version));
  for (const LayoutField& field : layout.fields) hash = fnv1a(fmt::format(";{} {}", field.type, field.name), hash);
  layout.hash = hash;
  return layout;
}

const char* formatName(Format format) {
  switch (format) {
    case Format::R32F:
      return "R32F";
    case Format::RG32F:
      return "RG32F";
    case Format::RGBA32F:
      return "RGBA32F";
    case Format::RGBA16F:
      return "RGBA16F";
    case Format::RGBA8:
      return "RGBA8";
    case Format::R32U:
      return "R32U";
  }
  return "unknown format";
}

uint32_t formatBytes(Format format) {
  switch (format) {
    case Format::R32F:
      return 4;
    case Format::RG32F:
      return 8;
    case Format::RGBA32F:
      return 16;
    case Format::RGBA16F:
      return 8;
    case Format::RGBA8:
      return 4;
    case Format::R32U:
      return 4;
  }
  return 0;
}

PortType storageImage(Format format) {
  PortType type;
  type.kind = PortKind::Image;
  type.format = format;
  return type;
}

bool compatible(const PortType& output, const PortType& input) {
  if (output.kind != input.kind) return false;
  if (output.kind == PortKind::Image) return output.format == input.format;
  const Layout &a = output.layout, &b = input.layout;
  return a.name == b.name && a.version == b.version && a.stride == b.stride && a.hash == b.hash;
}

std::string describe(const PortType& type) {
  if (type.kind == PortKind::Image) return fmt::format("image {}", formatName(type.format));
  const Layout& layout = type.layout;
  return fmt::format("{} v{} ({} bytes, hash {:#018x})", layout.name, layout.version, layout.stride, layout.hash);
}

}  // namespace weir
