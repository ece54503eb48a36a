#include "synthetic.h"

#include <fmt/format.h>

#include <stdexcept>
#include <vector>

namespace weir::bench {
namespace {

PortType buffer(const char* name) {
  static constexpr Field kFields[] = {{"vec4", "a"}, {"uvec4", "b"}};
  PortType type;
  type.layout = makeLayout(name, 1, 0, kFields, 2);
  return type;
}

/// One block. `{n}` is its number, `{m}` that of the block before it, or its own in the first: whose last frame it then
/// reads.
constexpr const char* kBlockText = R"(
    "tonemap{n}": {{ "type": "bench.Tonemap", "inputs": {{ "color": "resolve{n}.color" }},
                   "params": {{ "exposure": 0.5, "curve": "filmic" }} }},
    "gbuffer{n}": {{ "type": "bench.Gbuffer", "inputs": {{ "feedback": "tonemap{m}.color@previous" }},
                   "params": {{ "jitter": true }} }},
    "initial{n}": {{ "type": "bench.Initial", "inputs": {{ "surface": "gbuffer{n}.surface" }},
                   "params": {{ "candidates": 32, "visibility": true }} }},
    "temporal{n}": {{ "type": "bench.Temporal",
                    "inputs": {{ "surface": "gbuffer{n}.surface", "motion": "gbuffer{n}.motion",
                                "previousSurface": "gbuffer{n}.surface@previous",
                                "reservoirs": "initial{n}.reservoirs",
                                "history": "spatial{n}.reservoirs@previous" }},
                    "params": {{ "confidenceCap": 20, "mis": "pairwise" }} }},
    "spatial{n}": {{ "type": "bench.Spatial", "enabled": false,
                   "inputs": {{ "surface": "gbuffer{n}.surface", "reservoirs": "temporal{n}.reservoirs" }},
                   "params": {{ "iterations": 2, "neighbours": 4, "radius": 30.5 }} }},
    "shade{n}": {{ "type": "bench.Shade",
                 "inputs": {{ "surface": "gbuffer{n}.surface", "emission": "gbuffer{n}.emission",
                             "reservoirs": "spatial{n}.reservoirs" }} }},
    "half{n}": {{ "type": "bench.Half", "inputs": {{ "color": "shade{n}.color" }}, "params": {{ "taps": 13 }} }},
    "quarter{n}": {{ "type": "bench.Quarter", "inputs": {{ "half": "half{n}.half" }}, "params": {{ "taps": 13 }} }},
    "debug{n}": {{ "type": "bench.Tonemap", "inputs": {{ "color": "gbuffer{n}.emission" }} }},
    "resolve{n}": {{ "type": "bench.Resolve",
                   "inputs": {{ "color": "shade{n}.color", "half": "half{n}.half", "quarter": "quarter{n}.quarter",
                               "motion": "gbuffer{n}.motion", "history": "resolve{n}.color@previous" }},
                   "params": {{ "blend": 0.1, "bloom": 0.04 }} }})";

}  // namespace

PassDescription& SyntheticPasses::add(const char* type) {
  PassDescription& description = types_[type];
  description.type = type;
  return description;
}

SyntheticPasses::SyntheticPasses() {
  PassDescription& gbuffer = add("bench.Gbuffer");
  gbuffer.input("feedback", storageImage(Format::RGBA8)).optional();
  gbuffer.output("surface", buffer("Surface"));
  gbuffer.output("emission", storageImage(Format::RGBA32F));
  gbuffer.output("motion", storageImage(Format::RG32F));
  gbuffer.output("depth", storageImage(Format::R32F));
  gbuffer.param("jitter", false);

  PassDescription& initial = add("bench.Initial");
  initial.input("surface", buffer("Surface"));
  initial.input("mask", storageImage(Format::R32F)).optional();
  initial.output("reservoirs", buffer("Reservoir"));
  initial.param("candidates", 16).range(1, 1024);
  initial.param("visibility", true);

  PassDescription& temporal = add("bench.Temporal");
  temporal.input("surface", buffer("Surface"));
  temporal.input("previousSurface", buffer("Surface"));
  temporal.input("motion", storageImage(Format::RG32F));
  temporal.input("reservoirs", buffer("Reservoir"));
  temporal.input("history", buffer("Reservoir"));
  temporal.output("reservoirs", buffer("Reservoir")).passesThrough("reservoirs");
  temporal.param("confidenceCap", 20.0f).range(1, 1024);
  temporal.param("mis", "balance").oneOf({"biased", "z", "balance", "pairwise"}).specialises();
  temporal.param("shift", "none").oneOf({"none", "reconnection", "hybrid"});

  PassDescription& spatial = add("bench.Spatial");
  spatial.input("surface", buffer("Surface"));
  spatial.input("reservoirs", buffer("Reservoir"));
  spatial.output("reservoirs", buffer("Reservoir")).passesThrough("reservoirs");
  spatial.param("iterations", 1).range(1, 8);
  spatial.param("neighbours", 4).range(1, 32);
  spatial.param("radius", 30.0f).range(1, 200);
  spatial.param("mis", "balance").oneOf({"biased", "z", "balance", "pairwise"});

  PassDescription& shade = add("bench.Shade");
  shade.input("surface", buffer("Surface"));
  shade.input("emission", storageImage(Format::RGBA32F));
  shade.input("reservoirs", buffer("Reservoir"));
  shade.output("color", storageImage(Format::RGBA32F));
  shade.output("albedo", storageImage(Format::RGBA8));

  PassDescription& half = add("bench.Half");
  half.input("color", storageImage(Format::RGBA32F));
  half.output("half", storageImage(Format::RGBA16F)).scale(1, 2);
  half.param("taps", 4).range(1, 64);

  PassDescription& quarter = add("bench.Quarter");
  quarter.input("half", storageImage(Format::RGBA16F)).scale(1, 2);
  quarter.output("quarter", storageImage(Format::RGBA16F)).scale(1, 4);
  quarter.param("taps", 4).range(1, 64);

  PassDescription& resolve = add("bench.Resolve");
  resolve.input("color", storageImage(Format::RGBA32F));
  resolve.input("half", storageImage(Format::RGBA16F)).scale(1, 2);
  resolve.input("quarter", storageImage(Format::RGBA16F)).scale(1, 4);
  resolve.input("motion", storageImage(Format::RG32F));
  resolve.input("history", storageImage(Format::RGBA32F));
  resolve.output("color", storageImage(Format::RGBA32F)).passesThrough("color");
  resolve.param("blend", 0.05f).range(0, 1);
  resolve.param("bloom", 0.0f).range(0, 1);

  PassDescription& tonemap = add("bench.Tonemap");
  tonemap.input("color", storageImage(Format::RGBA32F));
  tonemap.output("color", storageImage(Format::RGBA8));
  tonemap.param("exposure", 0.0f).range(-20, 20).unit("EV");
  tonemap.param("curve", "filmic").oneOf({"linear", "filmic", "aces"});
  for (const auto& [type, description] : types_) description.check();
}

graph::PassCatalog SyntheticPasses::catalog() const {
  graph::PassCatalog catalog;
  catalog.find = [this](const std::string& type) {
    const auto found = types_.find(type);
    return found == types_.end() ? nullptr : &found->second;
  };
  catalog.types = [this] {
    std::vector<std::string> names;
    for (const auto& [type, description] : types_) names.push_back(type);
    return names;
  };
  return catalog;
}

std::string syntheticGraph(int passes) {
  if (passes < kBlock || passes % kBlock != 0)
    throw std::invalid_argument(fmt::format("{} passes; expected a multiple of {}", passes, kBlock));
  const int blocks = passes / kBlock;
  std::string text = "{\n  \"version\": 1,\n  \"name\": \"synthetic\",\n  \"passes\": {", outputs;
  for (int n = 0; n < blocks; ++n) {
    text += fmt::format(kBlockText, fmt::arg("n", n), fmt::arg("m", n > 0 ? n - 1 : 0));
    text += n + 1 < blocks ? "," : "";
    outputs += fmt::format("{}\"color{}\": \"tonemap{}.color\"", n > 0 ? ", " : "", n, n);
  }
  return text + "\n  },\n  \"outputs\": { " + outputs + " }\n}\n";
}

}  // namespace weir::bench
