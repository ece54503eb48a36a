#include <weir/chart/chart.h>

#include <fmt/format.h>
#include <weir/chart/page.h>
#include <weir/chart/place.h>
#include <weir/core/error.h>
#include <weir/render/write_file.h>

namespace weir::chart {
namespace {

std::string titleOf(const std::vector<Group>& all) {
  std::string title = "Error against time";
  if (all.size() == 1) return title + ": " + all.front().label;
  return fmt::format("{}: {} scenes", title, all.size());
}

/// What came over the command line need not be UTF-8; XML and HTML must be.
std::string asUtf8(const std::string& text) {
  return Json::parse(Json(text).dump(-1, ' ', false, Json::error_handler_t::replace)).get<std::string>();
}

/// Those on a front first: they are what somebody looks at when not everything has room.
std::vector<size_t> pictureOrder(const Bench& bench, const std::vector<Group>& all, const View& view) {
  std::vector<bool> taken(bench.configurations.size(), false);
  std::vector<size_t> order;
  for (const Group& group : all) {
    const std::vector<Point> shown = points(bench, group, view.time.key, view.error.key);
    const std::vector<bool> front = paretoFront(shown);
    for (size_t i = 0; i < shown.size(); ++i) {
      if (!front[i]) continue;
      order.push_back(shown[i].configuration);
      taken[shown[i].configuration] = true;
    }
  }
  for (size_t i = 0; i < taken.size(); ++i)
    if (!taken[i]) order.push_back(i);
  return order;
}

}  // namespace

Summary makeChart(const Options& options) {
  std::vector<render::NamedPath> inputs;
  for (const std::string& file : options.files) inputs.emplace_back("the command", file);
  render::requireDistinct({{"--out", options.page}, {"--svg", options.svg}}, inputs);
  for (const std::string& path : {options.page, options.svg})
    if (!path.empty()) render::checkWritable(path);
  const std::string page = options.page.empty() ? "" : readTemplate();

  Bench bench = readBench(options.files);
  const std::vector<Group> all = groups(bench);
  const View view{options.title.empty() ? titleOf(all) : asUtf8(options.title), chooseTime(bench, options.time),
                  chooseError(bench, options.error)};
  Summary summary{.configurations = bench.configurations.size(), .groups = all.size(), .warnings = bench.warnings};
  std::string filled;
  if (!options.page.empty()) {
    const EmbeddedPictures pictures =
        embedPictures(bench, pictureOrder(bench, all, view), options.pictureBytes, summary.warnings);
    summary.pictures = pictures.base64.size();
    if (pictures.leftOut > 0) {
      summary.warnings.push_back(
          fmt::format("the pictures of {} configurations are left out: --picture-limit allows {} MiB", pictures.leftOut,
                      options.pictureBytes >> 20u));
    }
    filled = fillPage(page, bench, view, pictures);
  }
  if (!options.svg.empty()) render::writeTextFile(options.svg, drawSvg(bench, view));
  if (!options.page.empty()) render::writeTextFile(options.page, filled);
  return summary;
}

}  // namespace weir::chart
