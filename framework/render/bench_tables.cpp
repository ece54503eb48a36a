#include <fmt/format.h>
#include <weir/render/bench_tables.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>

namespace weir::render {
namespace {

using Json = nlohmann::ordered_json;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// What lies at a path of keys; null where there is nothing.
Json at(const Json& j, std::initializer_list<const char*> path) {
  const Json* here = &j;
  for (const char* key : path) {
    if (!here->is_object()) return nullptr;
    const auto found = here->find(key);
    if (found == here->end()) return nullptr;
    here = &*found;
  }
  return *here;
}

double number(const Json& j) {
  return j.is_number() ? j.get<double>() : kNaN;
}

struct Figure {
  double value = kNaN, low = kNaN, high = kNaN;
};

Figure figure(const Json& j) {
  return {number(at(j, {"value"})), number(at(j, {"low"})), number(at(j, {"high"}))};
}

struct Row {
  std::string knobs;
  bool measured = false;
  double median = kNaN, noise = kNaN;  ///< ms, and the standard error of the median
  Figure frame, trimmed, mean, bias;
};

std::string knobText(const Json& record, const std::string& knob) {
  const Json parameters = at(record, {"parameters"});
  if (!parameters.is_object()) return "?";
  const auto found = parameters.find(knob);
  if (found != parameters.end())
    return found->is_string() ? found->get<std::string>() : found->dump(-1, ' ', false, Json::error_handler_t::replace);
  // Only passes that are off are listed as such.
  return knob.ends_with(".enabled") ? "true" : "-";
}

Row rowOf(const Json& record, const BenchTable& table) {
  Row row;
  row.measured = true;
  for (const std::string& knob : table.knobs)
    row.knobs.append(row.knobs.empty() ? "" : ",").append(knobText(record, knob));
  const Json gpu = at(record, {"frame", "gpu_ms"});
  row.median = number(at(gpu, {"median"}));
  // Of a normal distribution: p95 lies 1.645 σ above the median, whose standard error is 1.2533 σ / sqrt(frames).
  const double sigma = (number(at(gpu, {"p95"})) - row.median) / 1.645;
  row.noise = 1.2533 * sigma / std::sqrt(std::max(1.0, number(at(record, {"frames"}))));
  row.frame = figure(at(record, {"error", "relmse", "median"}));
  row.trimmed = figure(at(record, {"error", "relmse", "trimmed"}));
  row.mean = figure(at(record, {"error", "relmse_mean64"}));
  row.bias = figure(at(record, {"error", "bias"}));
  return row;
}

std::string shown(double value, const char* format = "{:.3f}") {
  return std::isfinite(value) ? fmt::format(fmt::runtime(format), value) : "";
}

std::string shown(const Figure& f, double scale = 1.0) {
  if (!std::isfinite(f.value)) return "";
  const double half = 0.5 * scale * (f.high - f.low);
  return fmt::format("{:.4g}", scale * f.value) + (std::isfinite(half) ? fmt::format(" ± {:.2g}", half) : "");
}

bool apart(const Figure& a, const Figure& b) {
  return a.high < b.low || b.high < a.low;
}

/// By the knob where it is a number; else, and for what is not measured, the plan's order.
void sortRows(std::vector<Row>& rows) {
  const auto value = [](const Row& row) {
    char* end = nullptr;
    const double v = std::strtod(row.knobs.c_str(), &end);
    return row.measured && end != row.knobs.c_str() && *end == '\0' && std::isfinite(v)
               ? v
               : std::numeric_limits<double>::infinity();
  };
  std::ranges::stable_sort(rows, {}, value);
}

/// What can be said of rows that differ in the knobs alone.
std::string inertness(const std::vector<Row>& rows) {
  std::vector<const Row*> known;
  for (const Row& row : rows)
    if (row.measured && std::isfinite(row.median)) known.push_back(&row);
  if (known.size() < 2) return "";
  bool time = false, error = false, errorKnown = true;
  for (const Row* a : known) {
    for (const Row* b : known) {
      const double noise = 3 * std::hypot(a->noise, b->noise);
      time = time || std::abs(a->median - b->median) > std::max(noise, 0.01 * std::min(a->median, b->median));
      error = error || apart(a->frame, b->frame) || apart(a->mean, b->mean) || apart(a->bias, b->bias);
      errorKnown = errorKnown && std::isfinite(a->frame.low) && std::isfinite(a->frame.high);
    }
  }
  if (time || error) return "";
  return errorKnown ? "**Inert?** Neither time nor error changes beyond noise.\n"
                    : "**Inert?** Time does not change beyond noise; the error's intervals are not known.\n";
}

void print(std::string& out, const BenchTable& table, const std::vector<Row>& rows) {
  out += fmt::format("### {}{}{}\n\n", table.name, table.title.empty() ? "" : ": ", table.title);
  if (!table.source.empty()) out += fmt::format("Published figures: {}.\n\n", table.source);
  out +=
      fmt::format("| {} | published, ms | here, ms | relMSE of a frame | trimmed | of the 64-frame mean | bias, % |\n",
                  fmt::join(table.knobs, ", "));
  out += "|---|---|---|---|---|---|---|\n";
  for (const Row& row : rows) {
    const auto published = table.published.find(row.knobs);
    out += fmt::format("| {} | {} | {} | {} | {} | {} | {} |\n", row.knobs,
                       published == table.published.end() ? "" : shown(published->second, "{:g}"),
                       row.measured ? shown(row.median) : "not measured", shown(row.frame), shown(row.trimmed),
                       shown(row.mean), shown(row.bias, 100.0));
  }
  out += "\n";
  if (const std::string text = inertness(rows); !text.empty()) out += text + "\n";
}

}  // namespace

std::string benchTables(const BenchFile& file, const BenchPlan& plan) {
  std::map<std::string, Json> records;
  for (const MeasuredConfiguration& c : file.configurations) records.emplace(c.id, Json::parse(c.json));
  std::string out = fmt::format("{}, {}\n\n", file.device, file.driver);
  for (const BenchTable& table : plan.tables) {
    std::vector<Row> rows;
    for (const PlannedConfiguration& planned : file.planned) {
      if (std::ranges::count(planned.sweeps, table.sweep) == 0) continue;
      const auto record = records.find(planned.id);
      if (record != records.end()) {
        rows.push_back(rowOf(record->second, table));
      } else {
        rows.emplace_back();
        rows.back().knobs = planned.label;
      }
    }
    sortRows(rows);
    print(out, table, rows);
  }
  return out;
}

}  // namespace weir::render
