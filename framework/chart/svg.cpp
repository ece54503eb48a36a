#include <weir/chart/svg.h>

#include <fmt/format.h>
#include <weir/chart/log_axis.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>

namespace weir::chart {
namespace {

constexpr double kWidth = 960, kPanel = 560, kTitle = 56;
constexpr double kLeft = 84, kRight = 700, kTop = 44, kBottom = 490;  // of the frame inside of a panel

// Okabe and Ito's colours, the light ones darker so that they stand out on white.
constexpr std::array<const char*, 8> kColors = {"#0072b2", "#d55e00", "#009e73", "#b5559a",
                                                "#8a6d00", "#3a93cf", "#6b4fa0", "#555555"};
// In a square of ±1; the same order as on the page.
constexpr std::array<const char*, 6> kShapes = {"",  // a circle
                                                "M-.9-.9H.9V.9H-.9Z",
                                                "M0-1.2L1.1.8H-1.1Z",
                                                "M0-1.3L1.1 0L0 1.3L-1.1 0Z",
                                                "M-.4-1.2H.4V-.4H1.2V.4H.4V1.2H-.4V.4H-1.2V-.4H-.4Z",
                                                "M0 1.2L-1.1-.8H1.1Z"};

std::string text(double x, double y, const char* more, const std::string& words) {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\"{}>{}</text>\n", x, y, more, escapeXml(words));
}

std::string symbol(double x, double y, double radius, size_t kind, double opacity, const std::string& title) {
  const char* color = kColors[kind % kColors.size()];
  const char* shape = kShapes[kind % kShapes.size()];
  const std::string inside = title.empty() ? "" : "<title>" + escapeXml(title) + "</title>";
  if (*shape == '\0')
    return fmt::format(
        "<circle class=\"point\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\" fill=\"{}\" opacity=\"{}\">{}</circle>\n", x, y,
        radius, color, opacity, inside);
  return fmt::format(
      "<path class=\"point\" transform=\"translate({:.1f} {:.1f}) scale({})\" d=\"{}\" fill=\"{}\" "
      "opacity=\"{}\">{}</path>\n",
      x, y, radius, shape, color, opacity, inside);
}

const char* entityOf(char c) {
  switch (c) {
    case '<':
      return "&lt;";
    case '>':
      return "&gt;";
    case '&':
      return "&amp;";
    case '"':
      return "&quot;";
    case '\'':
      return "&#39;";
    default:
      return nullptr;
  }
}

/// One group's points in their frame.
class Panel {
 public:
  Panel(const Bench& bench, const View& view, std::vector<Point> points, const std::map<std::string, size_t>& kinds)
      : bench_(bench),
        view_(view),
        points_(std::move(points)),
        front_(paretoFront(points_)),
        kinds_(kinds),
        x_(values(&Point::time), kLeft, kRight),
        y_(values(&Point::error), kBottom, kTop) {}

  std::string draw() const {
    if (points_.empty()) {
      return text((kLeft + kRight) / 2, (kTop + kBottom) / 2, " text-anchor=\"middle\" fill=\"#555\"",
                  "no configuration has both of these figures above zero");
    }
    return equalTimes() + axes() + bars() + frontLine() + symbols() + legend();
  }

 private:
  std::vector<double> values(Interval Point::*axis) const {
    std::vector<double> all;
    for (const Point& p : points_) {
      const Interval& i = p.*axis;
      all.push_back(i.value);
      // An interval that nearly reaches zero would make the axis as long as it likes.
      if (i.low > i.value / 10) all.push_back(i.low);
      if (i.high > 0 && i.high < i.value * 10) all.push_back(i.high);
    }
    return all;
  }

  std::string equalTimes() const {
    std::string out = "<g stroke=\"#bbb\" stroke-dasharray=\"2 4\">\n", words = "<g font-size=\"10\" fill=\"#666\">\n";
    const double least = std::log10(x_.low() * y_.low()), most = std::log10(x_.high() * y_.high());
    const int step = std::max(1, static_cast<int>(std::ceil((most - least) / 10)));
    for (int k = static_cast<int>(std::ceil(least)); k <= static_cast<int>(std::floor(most)); k += step) {
      const double c = std::pow(10.0, k);
      const double x0 = std::max(x_.low(), c / y_.high()), x1 = std::min(x_.high(), c / y_.low());
      if (x0 >= x1) continue;
      out += fmt::format("<path d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\"/>\n", x_.at(x0), y_.at(c / x0), x_.at(x1),
                         y_.at(c / x1));
      words += text(x_.at(x1) + 3, y_.at(c / x1) - 3, " text-anchor=\"end\"", tickText(c));
    }
    return out + "</g>\n" + words + "</g>\n";
  }

  std::string axes() const {
    std::string out =
        fmt::format("<g font-size=\"12\" fill=\"#333\"><path d=\"M{0} {2}V{3}H{1}\" fill=\"none\" stroke=\"#333\"/>\n",
                    kLeft, kRight, kTop, kBottom);
    for (const double t : x_.ticks()) {
      out += fmt::format("<path d=\"M{0:.1f} {1}v5\" stroke=\"#333\"/>", x_.at(t), kBottom);
      out += text(x_.at(t), kBottom + 19, " text-anchor=\"middle\"", tickText(t));
    }
    for (const double t : y_.ticks()) {
      out += fmt::format("<path d=\"M{0} {1:.1f}h-5\" stroke=\"#333\"/>", kLeft, y_.at(t));
      out += text(kLeft - 9, y_.at(t) + 4, " text-anchor=\"end\"", tickText(t));
    }
    out += text((kLeft + kRight) / 2, kBottom + 42, " text-anchor=\"middle\" font-size=\"13\"",
                view_.time.label + " / ms");
    out += fmt::format("<g transform=\"translate(20 {}) rotate(-90)\">{}</g></g>\n", (kTop + kBottom) / 2,
                       text(0, 0, " text-anchor=\"middle\" font-size=\"13\"", view_.error.label));
    return out;
  }

  std::string bars() const {
    std::string out = "<g stroke-width=\"1.2\">\n";
    for (size_t i = 0; i < points_.size(); ++i) {
      const Point& p = points_[i];
      std::string path;
      if (p.time.high > p.time.value)
        path += fmt::format("M{:.1f} {:.1f}H{:.1f}", x_.clipped(p.time.value), y_.clipped(p.error.value),
                            x_.clipped(p.time.high));
      if (p.error.high > 0)
        path += fmt::format("M{:.1f} {:.1f}V{:.1f}", x_.clipped(p.time.value), y_.clipped(p.error.high),
                            p.error.low > 0 ? y_.clipped(p.error.low) : kBottom);
      if (path.empty()) continue;
      out += fmt::format("<path class=\"bar\" d=\"{}\" stroke=\"{}\" opacity=\"{}\"/>\n", path,
                         kColors[kind(p) % kColors.size()], front_[i] ? 0.8 : 0.25);
    }
    return out + "</g>\n";
  }

  std::string frontLine() const {
    std::vector<std::pair<double, double>> corners;
    for (size_t i = 0; i < points_.size(); ++i)
      if (front_[i]) corners.emplace_back(x_.clipped(points_[i].time.value), y_.clipped(points_[i].error.value));
    std::sort(corners.begin(), corners.end());
    std::string path = fmt::format("M{:.1f} {}", corners.front().first, kTop);
    for (const auto& [x, y] : corners) path += fmt::format("H{:.1f}V{:.1f}", x, y);
    return fmt::format("<path class=\"front\" d=\"{}H{}\" fill=\"none\" stroke=\"#333\" stroke-width=\"1.5\"/>\n", path,
                       kRight);
  }

  std::string symbols() const {
    std::string out = "<g stroke=\"#fff\" stroke-width=\".15\">\n";
    for (const bool onFront : {false, true}) {  // the front's lie on top
      for (size_t i = 0; i < points_.size(); ++i) {
        if (front_[i] != onFront) continue;
        const Point& p = points_[i];
        const Configuration& c = bench_.configurations[p.configuration];
        out +=
            symbol(x_.clipped(p.time.value), y_.clipped(p.error.value), onFront ? 5.5 : 4, kind(p), onFront ? 1 : 0.4,
                   fmt::format("{} {}: {:.4g} ms, error {:.4g}", c.graph, c.id, p.time.value, p.error.value));
      }
    }
    return out + "</g>\n";
  }

  std::string legend() const {
    std::string out = "<g font-size=\"12\" fill=\"#333\">\n";
    double y = kTop + 8;
    for (const auto& [graph, kind] : kinds_) {
      out += symbol(kRight + 24, y, 5, kind, 1, "") + text(kRight + 36, y + 4, "", graph);
      y += 20;
    }
    out += fmt::format("<path d=\"M{} {}h20\" stroke=\"#333\" stroke-width=\"1.5\"/>", kRight + 14, y + 6);
    out += text(kRight + 40, y + 10, "", "Pareto front");
    out += fmt::format("<path d=\"M{} {}h20\" stroke=\"#bbb\" stroke-dasharray=\"2 4\"/>", kRight + 14, y + 26);
    out += text(kRight + 40, y + 30, "", "equal error × ms");
    const auto onFront = std::count(front_.begin(), front_.end(), true);
    out += text(kRight + 14, y + 58, "", fmt::format("{} configurations, {} on the front", points_.size(), onFront));
    return out + "</g>\n";
  }

  size_t kind(const Point& p) const { return kinds_.at(bench_.configurations[p.configuration].graph); }

  const Bench& bench_;
  const View& view_;
  const std::vector<Point> points_;
  const std::vector<bool> front_;
  const std::map<std::string, size_t>& kinds_;
  const LogAxis x_, y_;
};

}  // namespace

std::string escapeXml(const std::string& words) {
  constexpr const char* kReplacement = "\xef\xbf\xbd";
  std::string out;
  for (size_t i = 0; i < words.size(); ++i) {
    const auto c = static_cast<unsigned char>(words[i]);
    if (const char* entity = entityOf(words[i])) {
      out += entity;
    } else if ((c < 0x20 && c != '\t' && c != '\n') || c == 0x7f) {
      out += kReplacement;
    } else if (words.compare(i, 3, "\xef\xbf\xbe") == 0 || words.compare(i, 3, "\xef\xbf\xbf") == 0) {
      out += kReplacement;
      i += 2;
    } else {
      out += words[i];
    }
  }
  return out;
}

std::string drawSvg(const Bench& bench, const View& view) {
  std::map<std::string, size_t> kinds;
  for (const Configuration& c : bench.configurations) kinds.emplace(c.graph, 0);
  size_t next = 0;
  for (auto& [graph, kind] : kinds) kind = next++;
  const std::vector<Group> all = groups(bench);
  const double height = kTitle + kPanel * static_cast<double>(all.size());
  std::string out = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\" role=\"img\" "
      "font-family=\"system-ui, sans-serif\">\n<title>{2}</title>\n<desc>{3} against {4}, both on logarithmic axes, "
      "with 95 % "
      "confidence intervals and the 95th percentile of the time.</desc>\n<rect width=\"{0}\" height=\"{1}\" "
      "fill=\"#fff\"/>\n",
      kWidth, height, escapeXml(view.title), escapeXml(view.error.label), escapeXml(view.time.label));
  out += text(kLeft, 36, " font-size=\"20\" font-weight=\"600\" fill=\"#111\"", view.title);
  for (size_t i = 0; i < all.size(); ++i) {
    out += fmt::format("<g transform=\"translate(0 {})\">\n", kTitle + kPanel * static_cast<double>(i));
    out += text(kLeft, 24, " font-size=\"14\" font-weight=\"600\" fill=\"#333\"", all[i].label);
    out += Panel(bench, view, points(bench, all[i], view.time.key, view.error.key), kinds).draw();
    out += "</g>\n";
  }
  return out + "</svg>\n";
}

}  // namespace weir::chart
