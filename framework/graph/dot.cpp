// A compiled graph in Graphviz's language. Solid: this frame's value; dashed: last frame's; grey: skipped.
#include <weir/graph/compile.h>

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

namespace weir::graph {
namespace {

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + "\"";
}

}  // namespace

std::string dot(const CompiledGraph& graph) {
  std::string text;
  const auto say = [&]<typename... T>(fmt::format_string<T...> format, T&&... args) {
    fmt::format_to(std::back_inserter(text), format, std::forward<T>(args)...);
  };
  // Passes and outputs may share a name, so outputs have a prefix that no pass can have.
  const auto edge = [&](uint32_t resource, bool previous, const std::string& to) {
    const Resource& r = graph.resources[resource];
    const bool fromHost = r.producer == kNone;  // its own name says which "@previous" it stands for
    const std::string from = fromHost ? "host:" : graph.passes[r.producer].name;
    const std::string port = fromHost ? r.name : r.name.substr(from.size() + 1);
    say("  {} -> {} [label={}{}];\n", quoted(from), to, quoted(port + (previous ? "@previous" : "")),
        previous ? ", style=dashed, constraint=false" : "");
  };
  say("digraph {} {{\n  rankdir=LR;\n  node [shape=box, fontname=\"sans-serif\"];\n", quoted(graph.name));
  for (size_t p = 0; p < graph.passes.size(); ++p) {
    const std::string label = fmt::format("{}. {}\n{}", p + 1, graph.passes[p].name, graph.passes[p].type);
    say("  {} [label={}];\n", quoted(graph.passes[p].name), quoted(label));
  }
  for (const Skipped& s : graph.skipped)
    say("  {} [color=gray, fontcolor=gray, tooltip={}];\n", quoted(s.pass), quoted(s.reason));
  for (const GraphOutput& output : graph.outputs)
    say("  {} [label={}, shape=ellipse];\n", quoted("output:" + output.name), quoted(output.name));
  if (std::any_of(graph.resources.begin(), graph.resources.end(),
                  [](const Resource& r) { return r.producer == kNone; }))
    say("  \"host:\" [label=host, shape=ellipse];\n");
  for (const CompiledPass& pass : graph.passes)
    for (const Binding& input : pass.inputs)
      if (input.resource != kNone) edge(input.resource, input.previous, quoted(pass.name));
  for (const GraphOutput& output : graph.outputs)
    edge(output.resource, output.previous, quoted("output:" + output.name));
  return text + "}\n";
}

}  // namespace weir::graph
