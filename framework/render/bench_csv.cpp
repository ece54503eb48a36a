// A bench file as a table for spreadsheets: the figures of its JSON, flattened.
#include <fmt/format.h>
#include <weir/render/bench_file.h>

#include <map>
#include <nlohmann/json.hpp>

namespace weir::render {
namespace {

using Json = nlohmann::ordered_json;

/// By RFC 4180: what holds a comma, a quote or a line break is quoted, quotes twice.
std::string field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + "\"";
}

std::string valueText(const Json& j) {
  if (j.is_null()) return "";
  if (j.is_string()) return j.get<std::string>();
  return j.dump(-1, ' ', false, Json::error_handler_t::replace);
}

class Table {
 public:
  void begin() { rows_.emplace_back(); }
  void set(const std::string& column, std::string text) {
    if (columnOf_.emplace(column, columns_.size()).second) columns_.push_back(column);
    rows_.back()[columnOf_[column]] = std::move(text);
  }
  /// Everything below `j`, its place in the name: frame.gpu_ms.median.
  void add(const std::string& prefix, const Json& j) {
    if (j.is_object()) {
      for (const auto& [key, value] : j.items()) add(prefix.empty() ? key : prefix + "." + key, value);
    } else if (!j.is_array()) {
      set(prefix, valueText(j));
    } else if (prefix == "size" && j.size() == 2) {
      set("width", valueText(j[0]));
      set("height", valueText(j[1]));
    }
  }
  std::string text() const {
    std::string out;
    for (size_t c = 0; c < columns_.size(); ++c) out.append(c > 0 ? "," : "").append(field(columns_[c]));
    out += "\r\n";
    for (const std::map<size_t, std::string>& row : rows_) {
      for (size_t c = 0; c < columns_.size(); ++c) {
        const auto found = row.find(c);
        out.append(c > 0 ? "," : "").append(found == row.end() ? "" : field(found->second));
      }
      out += "\r\n";
    }
    return out;
  }

 private:
  std::vector<std::string> columns_;
  std::map<std::string, size_t> columnOf_;
  std::vector<std::map<size_t, std::string>> rows_;
};

/// Lists of things with names: the name stands for the number.
void addNamed(Table& table, const std::string& prefix, const Json& list) {
  if (!list.is_array()) return;
  for (const Json& item : list) {
    const auto name = item.is_object() ? item.find("name") : item.end();
    if (!item.is_object() || name == item.end() || !name->is_string()) continue;
    for (const auto& [key, value] : item.items())
      if (key != "name") table.add(prefix + "." + name->get<std::string>() + "." + key, value);
  }
}

}  // namespace

std::string benchCsv(const BenchFile& file) {
  Table table;
  for (const MeasuredConfiguration& c : file.configurations) {
    table.begin();
    const Json j = Json::parse(c.json);
    for (const auto& [key, value] : j.items()) {
      if (key == "passes") {
        addNamed(table, "passes", value);
      } else if (key == "settings" || key == "pictures") {
        continue;  // settings are among the parameters, unless their pass is off
      } else {
        table.add(key, value);
      }
      if (key == "floor" && value.is_object() && value.contains("parts"))
        addNamed(table, "floor.parts", value["parts"]);
    }
  }
  return table.text();
}

}  // namespace weir::render
