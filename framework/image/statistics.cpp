#include <fmt/format.h>
#include <weir/core/error.h>
#include <weir/image/statistics.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <utility>

namespace weir::image {
namespace {

using Colour = std::array<double, 4>;  // R, G, B, luminance

constexpr double kInfinity = std::numeric_limits<double>::infinity();

void requireSameSize(const TileGrid& grid, const Picture& picture, const char* what) {
  if (picture.rgba.size() != 4 * size_t{picture.width} * picture.height) {
    throw InputError(fmt::format("{} does not hold {}x{} pixels", what, picture.width, picture.height));
  }
  if (picture.width != grid.width || picture.height != grid.height) {
    throw InputError(fmt::format("{} is {}x{}, the restarts are {}x{}", what, picture.width, picture.height, grid.width,
                                 grid.height));
  }
}

/// One figure for every tile and one for the whole picture.
struct TileFigures {
  std::vector<Colour> tiles;
  Colour whole{};
};

/// Sums over the pixels of each tile, and how many those are.
struct TileSums {
  std::vector<Colour> tiles;
  std::vector<double> pixels;
  explicit TileSums(const TileGrid& grid) : tiles(grid.count()), pixels(grid.count()) {}
};

/// Adds `term(pixel)` of the rows from `first` up to `end`.
template <class Term>
void addRows(TileSums& sums, const TileGrid& grid, const Picture& picture, const Term& term, uint32_t first,
             uint32_t end) {
  for (uint32_t y = first; y < end; ++y) {
    for (uint32_t x = 0; x < grid.width; ++x) {
      const size_t tile = grid.index(x, y);
      const Colour value = term(picture.at(x, y));
      for (size_t c = 0; c < 4; ++c) sums.tiles[tile][c] += value[c];
      ++sums.pixels[tile];
    }
  }
}

/// `finish(sum, pixels)`, per tile and whole.
template <class Finish>
TileFigures finishTiles(TileSums sums, const TileGrid& grid, const Finish& finish) {
  TileFigures result{std::move(sums.tiles), {}};
  for (const Colour& tile : result.tiles) {
    for (size_t c = 0; c < 4; ++c) result.whole[c] += tile[c];
  }
  for (size_t c = 0; c < 4; ++c) {
    for (size_t i = 0; i < grid.count(); ++i) result.tiles[i][c] = finish(result.tiles[i][c], sums.pixels[i]);
    result.whole[c] = finish(result.whole[c], double(grid.width) * grid.height);
  }
  return result;
}

template <class Term, class Finish>
TileFigures sumTiles(const TileGrid& grid, const Picture& picture, const Term& term, const Finish& finish) {
  TileSums sums(grid);
  addRows(sums, grid, picture, term, 0, grid.height);
  return finishTiles(std::move(sums), grid, finish);
}

Colour colourAndLuminance(const float* rgb) {
  return {rgb[0], rgb[1], rgb[2], luminance(rgb)};
}

double quotient(double sum, double pixels) {
  return sum / pixels;
}

TileFigures tileMeans(const TileGrid& grid, const Picture& picture) {
  return sumTiles(grid, picture, colourAndLuminance, quotient);
}

/// Standard errors of the reference's tile means from those of its pixels, taken as independent. The luminance of the
/// colours' errors is the error of the luminance if colours err together, and more than it otherwise.
TileFigures tileErrors(const TileGrid& grid, const Picture& error) {
  const auto squared = [](const float* p) {
    Colour value = colourAndLuminance(p);
    for (double& v : value) v *= v;
    return value;
  };
  return sumTiles(grid, error, squared, [](double sum, double pixels) { return std::sqrt(sum) / pixels; });
}

TileResult testOne(const Moments& moments, uint64_t restarts, double reference, double referenceError) {
  TileResult result;
  result.mean = moments.mean;
  result.reference = reference;
  result.standardError = std::hypot(moments.standardError(restarts), referenceError);
  const double difference = result.mean - reference;
  if (!std::isfinite(difference) || !std::isfinite(result.standardError)) {
    result.t = result.relativeBias = kInfinity;
    return result;
  }
  const double scale = std::max(std::abs(result.mean), std::abs(reference));
  result.relativeBias = reference != 0.0 ? difference / reference : (difference == 0.0 ? 0.0 : kInfinity);
  // Below this a spread is rounding to float, and dividing by it would turn rounding of the mean into evidence.
  constexpr double kRounding = 1e-6;
  if (result.standardError > kRounding * scale * 0.1) {
    result.t = difference / result.standardError;
  } else {
    result.t = std::abs(difference) <= kRounding * scale ? 0.0 : std::copysign(kInfinity, difference);
  }
  return result;
}

double median(std::vector<double> values) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

void Moments::add(double value, uint64_t countWithIt) {
  const double before = value - mean;
  mean += before / static_cast<double>(countWithIt);
  squares += before * (value - mean);
}

void Moments::merge(const Moments& other, uint64_t count, uint64_t otherCount) {
  if (otherCount == 0) return;
  const double n = double(count), m = double(otherCount), difference = other.mean - mean;
  mean += difference * m / (n + m);
  squares += other.squares + difference * difference * n * m / (n + m);
}

double Moments::standardError(uint64_t count) const {
  if (count < 2) return kInfinity;
  const double n = double(count);
  return std::sqrt(squares / (n * (n - 1.0)));
}

RestartAccumulator::RestartAccumulator(uint32_t tileSide) {
  if (tileSide == 0) throw InputError("a tile needs at least one pixel a side");
  tiles_.grid.side = tileSide;
}

void RestartAccumulator::add(std::span<const Picture> pictures) {
  if (pictures.empty()) return;
  TileStatistics& t = tiles_;
  TileGrid grid = t.grid;
  if (t.restarts == 0) {
    grid.width = pictures[0].width;
    grid.height = pictures[0].height;
  }
  for (const Picture& picture : pictures) requireSameSize(grid, picture, "this restart");
  if (t.restarts == 0) {
    t.grid = grid;
    t.tiles.assign(grid.count(), {});
    pixels_.assign(pictures[0].rgba.size(), {});
  }
  std::vector<TileSums> sums(pictures.size(), TileSums(grid));
  std::atomic<uint64_t> nonFinite{0};
  forBands(grid, pictures.size(), [&](uint32_t first, uint32_t end) {
    const size_t from = size_t{4} * grid.width * first, to = size_t{4} * grid.width * end;
    uint64_t bad = 0;
    for (size_t k = 0; k < pictures.size(); ++k) {
      const std::vector<float>& rgba = pictures[k].rgba;
      for (size_t i = from; i < to; ++i) pixels_[i].add(rgba[i], t.restarts + k + 1);
      for (size_t i = from; i < to; i += 4)
        bad += !(std::isfinite(rgba[i]) && std::isfinite(rgba[i + 1]) && std::isfinite(rgba[i + 2]));
      addRows(sums[k], grid, pictures[k], colourAndLuminance, first, end);
    }
    nonFinite += bad;
  });
  nonFinite_ += nonFinite;
  for (TileSums& each : sums) {
    const TileFigures means = finishTiles(std::move(each), grid, quotient);
    ++t.restarts;
    for (size_t c = 0; c < 4; ++c) {
      for (size_t i = 0; i < t.tiles.size(); ++i) t.tiles[i][c].add(means.tiles[i][c], t.restarts);
      t.whole[c].add(means.whole[c], t.restarts);
    }
  }
}

void RestartAccumulator::merge(const RestartAccumulator& other) {
  if (other.restarts() == 0) return;
  if (other.tiles_.grid.side != tiles_.grid.side) throw InputError("the restarts were collected with other tiles");
  if (restarts() == 0) {
    *this = other;
    return;
  }
  const TileGrid &a = tiles_.grid, &b = other.tiles_.grid;
  if (a.width != b.width || a.height != b.height) {
    throw InputError(fmt::format("restarts of {}x{} and {}x{} do not mix", a.width, a.height, b.width, b.height));
  }
  const uint64_t n = restarts(), m = other.restarts();
  for (size_t i = 0; i < pixels_.size(); ++i) pixels_[i].merge(other.pixels_[i], n, m);
  for (size_t c = 0; c < 4; ++c) {
    for (size_t i = 0; i < tiles_.tiles.size(); ++i) tiles_.tiles[i][c].merge(other.tiles_.tiles[i][c], n, m);
    tiles_.whole[c].merge(other.tiles_.whole[c], n, m);
  }
  tiles_.restarts += m;
  nonFinite_ += other.nonFinite_;
}

Picture RestartAccumulator::mean() const {
  if (restarts() == 0) throw InputError("no restart has been added");
  Picture picture{tiles_.grid.width, tiles_.grid.height, {}, {}};
  picture.rgba.reserve(pixels_.size());
  for (const Moments& m : pixels_) picture.rgba.push_back(static_cast<float>(m.mean));
  return picture;
}

Picture RestartAccumulator::standardError() const {
  if (restarts() == 0) throw InputError("no restart has been added");
  Picture picture{tiles_.grid.width, tiles_.grid.height, {}, {}};
  picture.rgba.reserve(pixels_.size());
  for (const Moments& m : pixels_) picture.rgba.push_back(static_cast<float>(m.standardError(restarts())));
  return picture;
}

TileTest tileTest(const TileStatistics& measured, const Picture& reference, const Picture* referenceError,
                  const TileTestOptions& options) {
  if (measured.restarts < 2) throw InputError("a test against a reference needs at least two restarts");
  requireSameSize(measured.grid, reference, "the reference");
  if (referenceError) requireSameSize(measured.grid, *referenceError, "the reference's standard error");
  const TileFigures means = tileMeans(measured.grid, reference);
  const TileFigures errors = referenceError ? tileErrors(measured.grid, *referenceError)
                                            : TileFigures{std::vector<Colour>(measured.grid.count()), {}};
  TileTest test;
  test.grid = measured.grid;
  test.restarts = measured.restarts;
  test.comparisons = static_cast<int>(measured.grid.count()) * (options.eachColour ? 3 : 1);
  const int freedom = static_cast<int>(measured.restarts) - 1;
  test.bound = studentTBound(freedom, options.alpha, test.comparisons);

  const size_t first = options.eachColour ? 0 : kLuminance, last = options.eachColour ? 2 : kLuminance;
  std::vector<double> detectable;
  for (size_t i = 0; i < measured.grid.count(); ++i) {
    TileResult worst;
    for (size_t c = first; c <= last; ++c) {
      const TileResult one = testOne(measured.tiles[i][c], measured.restarts, means.tiles[i][c], errors.tiles[i][c]);
      if (c == first || std::abs(one.t) > std::abs(worst.t)) worst = one;
    }
    if (worst.reference > 0.0) detectable.push_back(test.bound * worst.standardError / worst.reference);
    if (std::abs(worst.t) > test.worstT) {
      test.worstT = std::abs(worst.t);
      test.worst = i;
    }
    test.tiles.push_back(worst);
  }
  test.passed = test.worstT <= test.bound;
  test.detectable = median(std::move(detectable));

  const TileResult whole =
      testOne(measured.whole[kLuminance], measured.restarts, means.whole[kLuminance], errors.whole[kLuminance]);
  const double half = studentTBound(freedom, options.alpha, 1) * whole.standardError / std::abs(whole.reference);
  test.relativeBias = whole.relativeBias;
  test.intervalLow = whole.relativeBias - half;
  test.intervalHigh = whole.relativeBias + half;
  return test;
}

TileTest tileTest(const std::vector<Picture>& restarts, const Picture& reference, uint32_t tileSide,
                  const Picture* referenceError, const TileTestOptions& options) {
  RestartAccumulator accumulator(tileSide);
  for (const Picture& picture : restarts) accumulator.add(picture);
  return tileTest(accumulator.tiles(), reference, referenceError, options);
}

}  // namespace weir::image
