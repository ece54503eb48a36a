#include <weir/chart/page.h>

#include <fmt/format.h>
#include <weir/chart/place.h>
#include <weir/core/error.h>
#include <weir/core/paths.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace weir::chart {
namespace {

namespace fs = std::filesystem;

/// JSON between <script> tags: only "<" could end or change what the browser reads there, and only texts hold one.
void appendJson(std::string& page, const std::string& json) {
  for (const char c : json) {
    if (c == '<') {
      page += "\\u003c";
    } else {
      page += c;
    }
  }
}

std::string dump(const Json& json) {
  // The title and the paths are the user's and need not be UTF-8.
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Json axesJson(const std::vector<Axis>& axes) {
  Json list = Json::array();
  for (const Axis& axis : axes) list.push_back({{"key", axis.key}, {"label", axis.label}});
  return list;
}

Json figures(const Interval& i) {
  if (!std::isfinite(i.value)) return nullptr;
  const auto number = [](double v) { return std::isfinite(v) ? Json(v) : Json(nullptr); };
  return Json::array({number(i.value), number(i.low), number(i.high)});
}

/// What each axis shows of a configuration, so that the page need not know where figures come from.
std::string axisFigures(const Configuration& c, const std::vector<Axis>& times, const std::vector<Axis>& errors) {
  Json json = {{"times", Json::array()}, {"errors", Json::array()}};
  for (const Axis& axis : times) json["times"].push_back(figures(timeOf(c, axis.key)));
  for (const Axis& axis : errors) json["errors"].push_back(figures(errorOf(c, axis.key)));
  return dump(json);
}

void appendData(std::string& page, const Bench& bench, const View& view, const EmbeddedPictures& pictures) {
  const std::vector<Axis> times = timeAxes(bench), errors = errorAxes();
  Json head = {{"title", view.title},      {"time", view.time.key},      {"error", view.error.key},
               {"times", axesJson(times)}, {"errors", axesJson(errors)}, {"picturesLeftOut", pictures.leftOut},
               {"files", Json::array()},   {"groups", Json::array()}};
  for (const BenchFile& f : bench.files) {
    head["files"].push_back({{"name", fs::path(f.path).filename().string()},
                             {"device", f.device},
                             {"driver", f.driver},
                             {"trace", f.trace},
                             {"weir", f.weir}});
  }
  for (const Group& group : groups(bench))
    head["groups"].push_back({{"label", group.label}, {"configurations", group.configurations}});
  // Members are appended as text: with many configurations one tree of everything would be large.
  const auto without = [](const std::string& text) { return text.substr(0, text.size() - 1); };
  appendJson(page, without(dump(head)));
  page += ",\"configurations\":[";
  for (size_t i = 0; i < bench.configurations.size(); ++i) {
    const Configuration& c = bench.configurations[i];
    const std::array<int, 3>& p = pictures.of[i];
    page += i > 0 ? ",\n" : "";
    appendJson(page, without(axisFigures(c, times, errors)));
    page += fmt::format(",\"file\":{},\"pictures\":[{},{},{}],\"data\":", c.file, p[0], p[1], p[2]);
    appendJson(page, c.json);
    page += "}";
  }
  page += "],\"pictures\":[";
  for (size_t i = 0; i < pictures.base64.size(); ++i) {
    page += i > 0 ? ",\n\"" : "\"";
    page += pictures.base64[i];
    page += '"';
  }
  page += "]}";
}

}  // namespace

std::string readTemplate() {
  const fs::path own = libraryFolder();
  // Build tree and bundle, installations with lib and with lib/<architecture>.
  for (const char* name : {"chart.html", "../share/weir/chart.html", "../../share/weir/chart.html"}) {
    std::ifstream file(own / name, std::ios::binary);
    if (file) return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  }
  throw InputError(
      fmt::format("this Weir was built without the page (no chart.html beside {}): with npm installed, "
                  "'cmake --build --preset release --target weir_chart' makes it; --svg works without",
                  own.string()));
}

std::string fillPage(const std::string& page, const Bench& bench, const View& view, const EmbeddedPictures& pictures) {
  std::string result;
  size_t done = 0;
  const auto upTo = [&](const char* slot) {
    const std::string text = fmt::format("<!--weir:{}-->", slot);
    const size_t at = page.find(text, done);
    if (at == std::string::npos) throw RuntimeError(fmt::format("the page's template has no slot {}", text));
    result.append(page, done, at - done);
    done = at + text.size();
  };
  upTo("title");
  result += escapeXml(view.title);
  upTo("svg");
  result += drawSvg(bench, view);
  upTo("data");
  appendData(result, bench, view, pictures);
  result.append(page, done);
  return result;
}

}  // namespace weir::chart
