#include <fmt/format.h>
#include <weir/core/error.h>
#include <weir/image/student.h>
#include <weir/image/verdict.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace weir::image {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr char kColours[] = {'R', 'G', 'B', 'Y'};

int wholeFreedom(double freedom) {
  return std::isfinite(freedom) ? static_cast<int>(std::clamp(std::floor(freedom), 1.0, 1e6)) : 1'000'000;
}

double welchFreedom(const Estimate& a, const Estimate& b) {
  const auto part = [](const Estimate& e) {
    return e.variance > 0 && std::isfinite(e.freedom) ? e.variance * e.variance / e.freedom : 0.0;
  };
  const double sum = a.variance + b.variance, parts = part(a) + part(b);
  return parts > 0 ? sum * sum / parts : kInfinity;
}

/// Events of such a number are seen by every sample of that size, and their spread with them.
constexpr double kSeenWell = 30;

/// Rare events make an excess kurtosis of at least one over how many of them there are in a restart (compound Poisson).
/// Where the side with fewer restarts can expect only few of those that the other one has seen, its own variance may
/// lack them. The null hypothesis then is that both sides vary alike, and each gets its variance from the other: n and
/// n' restarts of equal variances s² and s'² have s²/n' + s'²/n, which is that of a pooled t test. For n = n' and for
/// light that the smaller side has seen, nothing changes, and never does it alarm more.
void spreadRareEvents(Estimate& a, Estimate& b) {
  if (a.count == 0 || b.count == 0 || a.count == b.count) return;
  const Estimate &many = a.count > b.count ? a : b, &few = a.count > b.count ? b : a;
  // One that never varies lacks nothing: brute force over points gives the same picture each time.
  if (few.variance == 0.0 || double(few.count) >= kSeenWell * many.excess) return;
  const double ratio = double(a.count) / double(b.count), fromA = a.variance * ratio, fromB = b.variance / ratio;
  if (!(fromA + fromB > a.variance + b.variance)) return;
  a.variance = fromA;
  b.variance = fromB;
}

/// Hall 1992, "On the Removal of Skewness by Transformation", eq. 3 (monotone): t whose first-order dependence on the
/// skewness of the data is gone. `skew`: third cumulant of the mean over variance^1.5.
double withoutSkewness(double t, double skew) {
  return t + skew * t * t / 3.0 + skew * skew * t * t * t / 27.0 + skew / 6.0;
}

/// The lower one of an even number; `none` of no values.
double median(std::vector<double> values, double none) {
  if (values.empty()) return none;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double sidak(double alpha, size_t comparisons) {
  return -std::expm1(std::log1p(-alpha) / double(comparisons));
}

double width(const Comparison& c, double level) {
  const double t = c.standardError > 0 ? criticalT(c.freedom, level) : 0.0;
  return c.reference != 0 ? t * c.standardError / std::abs(c.reference) : kInfinity;
}

Scale testScale(const TileGrid& grid, std::vector<const ColourEstimates*> measured,
                std::vector<const ColourEstimates*> reference, double alpha, double negligible) {
  Scale s;
  s.grid = grid;
  s.comparisons = 3 * measured.size();
  s.level = sidak(alpha, s.comparisons);
  std::vector<double> widths;
  bool lit = false;
  for (size_t i = 0; i < measured.size(); ++i) {
    Comparison worst;
    char colour = kColours[0];
    for (size_t c = 0; c < 3; ++c) {
      const Comparison one = compare((*measured[i])[c], (*reference[i])[c], negligible);
      // Of many that are certain, the one that is farther off.
      if (c == 0 || one.p < worst.p || (one.p == worst.p && std::abs(one.t) > std::abs(worst.t))) {
        worst = one;
        colour = kColours[c];
      }
    }
    s.tiles.push_back(worst);
    s.colours.push_back(colour);
    if (worst.p < s.level) s.alarms.push_back(i);
    if (i >= grid.count()) continue;
    const Comparison y = compare((*measured[i])[kLuminance], (*reference[i])[kLuminance], negligible);
    lit = lit || y.reference > 0;
    if (y.reference > 0 && y.standardError > 0) widths.push_back(width(y, s.level));
  }
  // Where p is as good as 0 for many, the largest difference is the place to look at.
  const auto worse = [&](size_t a, size_t b) {
    if (s.tiles[a].p != s.tiles[b].p) return s.tiles[a].p < s.tiles[b].p;
    return std::abs(s.tiles[a].mean - s.tiles[a].reference) > std::abs(s.tiles[b].mean - s.tiles[b].reference);
  };
  std::sort(s.alarms.begin(), s.alarms.end(), worse);
  for (size_t i = 1; i < std::min(s.tiles.size(), grid.count()); ++i) {
    if (worse(i, s.worst)) s.worst = i;
  }
  s.resolution = median(std::move(widths), lit ? 0.0 : kInfinity);
  return s;
}

std::vector<const ColourEstimates*> pointers(const std::vector<ColourEstimates>& tiles,
                                             const ColourEstimates* last = nullptr) {
  std::vector<const ColourEstimates*> result;
  for (const ColourEstimates& tile : tiles) result.push_back(&tile);
  if (last != nullptr) result.push_back(last);
  return result;
}

void requireAlike(const Evidence& measured, const Evidence& reference) {
  const TileGrid &a = measured.fine, &b = reference.fine;
  if (a.width != b.width || a.height != b.height)
    throw InputError(
        fmt::format("the picture is {}x{} pixels, the reference {}x{}", a.width, a.height, b.width, b.height));
  if (a.side != b.side || measured.coarse.side != reference.coarse.side)
    throw InputError("picture and reference are cut into different tiles");
  if (measured.restarts == 0) throw InputError("a verdict needs restarts");
}

/// How many times as much of all evidence would bring the interval inside the tolerance with a probability of 0.9, if
/// the bias is 0: the middle of the interval is then itself off by up to 1.645 standard errors.
double growth(double half, double standardErrors, double tolerance) {
  const double needed = half * (1.0 + 1.645 / standardErrors) / tolerance;
  return needed * needed;
}

std::string percent(double v) {
  return std::isfinite(v) ? fmt::format("{:+.4g} %", 100 * v) : std::string("more than the reference, which is black,");
}

void explainUndecided(Verdict& v, const Evidence& measured, const Evidence& reference, const VerdictOptions& o) {
  const double t = criticalT(v.whole.freedom, v.wholeLevel), half = 0.5 * (v.high - v.low);
  double times = 1.0;
  if (!(v.whole.reference > 0)) {
    v.reasons.emplace_back("the reference is black: there is nothing to be right or wrong about");
    return;
  }
  if (v.restarts < o.fewest || (v.referenceRestarts > 0 && v.referenceRestarts < o.fewest)) {
    const bool own = v.restarts < o.fewest;
    const uint64_t has = own ? v.restarts : v.referenceRestarts;
    v.reasons.push_back(fmt::format("{} restarts{} are too few for a verdict: at least {}", has,
                                    own ? "" : " of the reference", o.fewest));
    times = double(o.fewest) / double(has);
  }
  if (v.within > o.tolerance) {
    v.reasons.push_back(fmt::format("the whole picture's bias is known only to be between {} and {}; asked is {:.4g} %",
                                    percent(v.low), percent(v.high), 100 * o.tolerance));
    times = std::max(times, growth(half, t, o.tolerance));
    const Estimate &a = measured.whole[kLuminance], &b = reference.whole[kLuminance];
    // A picture's error stays as it is, however long the test runs.
    if (v.referenceRestarts == 0 && b.variance > 0) {
      const double floor = criticalT(b.freedom, v.wholeLevel) * std::sqrt(b.variance) / std::abs(b.mean) *
                           (1.0 + 1.645 / t) / o.tolerance;
      if (floor >= 1.0) {
        v.reasons.push_back(fmt::format("the reference's own error is {:.3g} % of it: no number of restarts is enough",
                                        100 * std::sqrt(b.variance) / std::abs(b.mean)));
        return;
      }
      const double share = a.variance / (a.variance + b.variance), target = 1.0 / growth(half, t, o.tolerance);
      times = std::max(times, share / std::max(target - (1.0 - share), 1e-6));
    }
  }
  if (v.coarse.resolution > o.tileTolerance) {
    v.reasons.push_back(
        fmt::format("half of the tiles of {}² are known to {:.3g} % or worse; asked is "
                    "{:.3g} %",
                    v.coarse.grid.side, 100 * v.coarse.resolution, 100 * o.tileTolerance));
    const double ratio = v.coarse.resolution / o.tileTolerance;
    if (std::isfinite(ratio)) times = std::max(times, ratio * ratio);
  }
  if (!std::isfinite(times) || times > 1e9) return;
  v.enough = static_cast<uint64_t>(std::ceil(times * double(v.restarts)));
}

}  // namespace

const char* answerName(Answer answer) {
  switch (answer) {
    case Answer::Unbiased:
      return "unbiased";
    case Answer::Biased:
      return "biased";
    case Answer::Undecided:
      break;
  }
  return "undecided";
}

double criticalT(double freedom, double level) {
  thread_local std::map<std::pair<int, double>, double> known;
  const int whole = wholeFreedom(freedom);
  const auto [at, isNew] = known.try_emplace({whole, level}, 0.0);
  if (isNew) at->second = studentTBound(whole, level, 1);
  return at->second;
}

Comparison compare(const Estimate& ofMeasured, const Estimate& ofReference, double negligible) {
  Estimate measured = ofMeasured, reference = ofReference;
  spreadRareEvents(measured, reference);
  Comparison c{measured.mean, reference.mean};
  const double difference = c.mean - c.reference, variance = measured.variance + reference.variance;
  c.relative = c.reference != 0 ? difference / std::abs(c.reference) : (difference == 0 ? 0.0 : kInfinity);
  if (!std::isfinite(difference)) {
    c.t = c.relative = kInfinity;
    c.p = 0.0;
    return c;
  }
  c.standardError = std::sqrt(variance);
  c.freedom = welchFreedom(measured, reference);
  const double slack = negligible * std::max(std::abs(c.mean), std::abs(c.reference));
  const double beyond = std::copysign(std::max(0.0, std::abs(difference) - slack), difference);
  if (beyond == 0.0 || !std::isfinite(variance)) return c;
  if (!(variance > 0)) {
    c.t = std::copysign(kInfinity, difference);
    c.p = 0.0;
    return c;
  }
  const double plain = beyond / c.standardError;
  const double skew = (measured.cumulant - reference.cumulant) / (variance * c.standardError);
  const double corrected = withoutSkewness(plain, skew);
  // Of the two the one that alarms less. One that changes the sign says that nothing speaks for a bias.
  c.t = plain * corrected <= 0 ? 0.0 : std::copysign(std::min(std::abs(plain), std::abs(corrected)), plain);
  c.p = studentTTwoSided(std::abs(c.t), wholeFreedom(c.freedom));
  return c;
}

Verdict decide(const Evidence& measured, const Evidence& reference, const NonFinite& bad, const VerdictOptions& o) {
  requireAlike(measured, reference);
  Verdict v;
  v.restarts = measured.restarts;
  v.referenceRestarts = reference.restarts;
  v.alpha = o.alpha / o.looks;
  v.wholeLevel = 0.5 * v.alpha;
  v.whole = compare(measured.whole[kLuminance], reference.whole[kLuminance], o.negligible);
  v.coarse = testScale(measured.coarse, pointers(measured.coarseTiles, &measured.whole),
                       pointers(reference.coarseTiles, &reference.whole), 0.25 * v.alpha, o.negligible);
  v.fine = testScale(measured.fine, pointers(measured.fineTiles), pointers(reference.fineTiles), 0.25 * v.alpha,
                     o.negligible);
  const double half = width(v.whole, v.wholeLevel);
  v.low = v.whole.relative - half;
  v.high = v.whole.relative + half;
  v.within = std::max(std::abs(v.low), std::abs(v.high));

  if (bad.pixels > 0) {
    v.answer = Answer::Biased;
    v.reasons.push_back(fmt::format("{} pixels are not finite; the first is {}, {} of restart {}", bad.pixels, bad.x,
                                    bad.y, bad.restart));
    return v;
  }
  if (!(v.whole.reference > 0)) {
    explainUndecided(v, measured, reference, o);
    return v;
  }
  const bool many = v.restarts >= o.fewest && (v.referenceRestarts == 0 || v.referenceRestarts >= o.fewest);
  if (many && v.whole.p < v.wholeLevel)
    v.reasons.push_back("the whole picture's mean is off by " + percent(v.whole.relative));
  for (const Scale* s : {&v.coarse, &v.fine}) {
    if (!many || s->alarms.empty()) continue;
    const size_t tiles = s->grid.count();
    const size_t wrong = size_t(std::count_if(s->alarms.begin(), s->alarms.end(), [&](size_t i) { return i < tiles; }));
    if (wrong > 0) {
      const Comparison& w = s->tiles[s->worst];
      v.reasons.push_back(
          fmt::format("{} of {} tiles of {}² are off, most surely that at {}, {}: {} for {:.6g} in {} "
                      "({:.1f} standard errors)",
                      wrong, tiles, s->grid.side, s->grid.left(s->worst), s->grid.top(s->worst), percent(w.relative),
                      w.reference, s->colours[s->worst], std::abs(w.t)));
    } else {
      v.reasons.push_back(fmt::format("the whole picture's mean is off in {} by {}", s->colours.back(),
                                      percent(s->tiles.back().relative)));
    }
  }
  if (!v.reasons.empty()) {
    v.answer = Answer::Biased;
    return v;
  }
  const bool precise = v.within <= o.tolerance && v.coarse.resolution <= o.tileTolerance;
  if (many && precise) {
    v.answer = Answer::Unbiased;
    return v;
  }
  explainUndecided(v, measured, reference, o);
  return v;
}

}  // namespace weir::image
