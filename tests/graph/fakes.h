// Descriptions of passes shaped like the real ones, and helpers to run text through the compiler.
#pragma once

#include <weir/graph/compile.h>

#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace weir::graph::test {

inline PortType buffer(const char* name, uint32_t version = 1) {
  static constexpr Field kFields[] = {{"vec4", "a"}, {"uvec2", "b"}};
  PortType type;
  type.layout = makeLayout(name, version, 0, kFields, 2);
  return type;
}

/// A catalog of descriptions; keep it alive while its PassCatalog is in use.
class Fakes {
 public:
  PassDescription& add(const std::string& type) {
    PassDescription& description = descriptions_[type];
    description.type = type;
    return description;
  }
  PassCatalog catalog() const {
    PassCatalog catalog;
    catalog.find = [this](const std::string& type) {
      const auto found = descriptions_.find(type);
      return found == descriptions_.end() ? nullptr : &found->second;
    };
    catalog.types = [this] {
      std::vector<std::string> names;
      for (const auto& [type, unused] : descriptions_) names.push_back(type);
      return names;
    };
    return catalog;
  }
  void check() const {
    for (const auto& [type, description] : descriptions_) description.check();
  }

 private:
  std::map<std::string, PassDescription> descriptions_;
};

/// The passes of the documented example.
inline Fakes exampleFakes() {
  Fakes fakes;
  for (const char* type : {"gbuffer.RayTraced", "gbuffer.Raster"}) {
    PassDescription& d = fakes.add(type);
    d.output("surface", buffer("PackedSurface"));
    d.output("emission", storageImage(Format::RGBA32F));
    d.output("motion", storageImage(Format::RG32F));
    d.param("jitter", false);
    d.needs(Need::SceneGeometry).needs(Need::FrameCamera);
  }
  PassDescription& initial = fakes.add("restir_di.Initial");
  initial.doc("Draws candidates");
  initial.input("surface", buffer("PackedSurface"));
  initial.output("reservoirs", buffer("Reservoir"));
  initial.param("candidates", 32).range(1, 1024).doc("Lights drawn for each pixel");
  initial.param("visibility", true);

  PassDescription& temporal = fakes.add("restir_di.Temporal");
  temporal.input("surface", buffer("PackedSurface"));
  temporal.input("previousSurface", buffer("PackedSurface"));
  temporal.input("motion", storageImage(Format::RG32F));
  temporal.input("reservoirs", buffer("Reservoir"));
  temporal.input("history", buffer("Reservoir"));
  temporal.output("reservoirs", buffer("Reservoir")).passesThrough("reservoirs");
  temporal.param("confidenceCap", 20.0f).range(1, 1024);
  temporal.param("mis", "balance").oneOf({"biased", "z", "balance", "pairwise"}).specialises();

  PassDescription& spatial = fakes.add("restir_di.Spatial");
  spatial.input("surface", buffer("PackedSurface"));
  spatial.input("reservoirs", buffer("Reservoir"));
  spatial.output("reservoirs", buffer("Reservoir")).passesThrough("reservoirs");
  spatial.param("iterations", 1).range(1, 8);
  spatial.param("neighbours", 4).range(1, 32);
  spatial.param("radius", 30.0f).range(1, 200).unit("pixels");

  PassDescription& shade = fakes.add("restir_di.Shade");
  shade.input("surface", buffer("PackedSurface"));
  shade.input("emission", storageImage(Format::RGBA32F));
  shade.input("reservoirs", buffer("Reservoir"));
  shade.output("color", storageImage(Format::RGBA32F)).radiance();

  PassDescription& tonemap = fakes.add("output.Tonemap");
  tonemap.input("color", storageImage(Format::RGBA32F));
  tonemap.output("color", storageImage(Format::RGBA8)).display();
  tonemap.param("exposure", 0.0f).range(-20, 20).unit("EV");
  tonemap.param("label", "");
  return fakes;
}

struct Result {
  Description description;
  CompiledGraph graph;
  std::vector<Diagnostic> diagnostics;

  std::string text() const {
    std::string all;
    for (const Diagnostic& diagnostic : diagnostics) all += diagnostic.text() + "\n";
    return all;
  }
  const Diagnostic* at(const std::string& path) const {
    for (const Diagnostic& diagnostic : diagnostics)
      if (diagnostic.path == path) return &diagnostic;
    return nullptr;
  }
  std::vector<std::string> order() const {
    std::vector<std::string> names;
    for (const CompiledPass& pass : graph.passes) names.push_back(pass.name);
    return names;
  }
  const CompiledPass& pass(const std::string& name) const {
    for (const CompiledPass& pass : graph.passes)
      if (pass.name == name) return pass;
    throw std::out_of_range("no pass " + name);
  }
  const Resource& resource(const std::string& name) const {
    for (const Resource& resource : graph.resources)
      if (resource.name == name) return resource;
    throw std::out_of_range("no resource " + name);
  }
  /// What an input reads, as "pass.port" or "pass.port@previous".
  std::string source(const std::string& passName, const std::string& port) const {
    for (const Binding& input : pass(passName).inputs)
      if (input.port == port)
        return input.resource == kNone ? ""
                                       : graph.resources[input.resource].name + (input.previous ? "@previous" : "");
    throw std::out_of_range("no input " + port);
  }
};

inline Result run(const std::string& json, const Fakes& fakes, const Overrides& overrides = {}, uint32_t width = 64,
                  uint32_t height = 32) {
  Result result;
  result.description = parse(json, "graph.json", result.diagnostics);
  apply(result.description, overrides, result.diagnostics);
  result.graph = compile(result.description, fakes.catalog(), width, height, result.diagnostics);
  return result;
}

inline std::string readFixture(const std::string& name) {
  std::ifstream file(std::string(WEIR_SOURCE_DIR) + "/tests/graph/files/" + name, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const size_t at = text.find(from);
  if (at == std::string::npos) throw std::out_of_range("no '" + from + "' in the text");
  return text.replace(at, from.size(), to);
}

}  // namespace weir::graph::test
