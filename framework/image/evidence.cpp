#include <fmt/format.h>
#include <weir/core/error.h>
#include <weir/core/parallel.h>
#include <weir/image/evidence.h>

#include <algorithm>
#include <cmath>

namespace weir::image {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
using Colour = std::array<double, 4>;

Colour colourAndLuminance(const float* p) {
  return {p[0], p[1], p[2], luminance(p)};
}

void requireSameSize(const Picture& a, const Picture& b, const char* what) {
  if (a.width != b.width || a.height != b.height) {
    throw InputError(
        fmt::format("{} is {}x{} pixels, the reference {}x{}", what, b.width, b.height, a.width, a.height));
  }
}

/// Sums over pixels of up to three figures for each colour: of every tile, and of all.
struct Sums {
  std::array<Colour, 3> sum{};
  double pixels = 0;
  void add(const Sums& other) {
    for (size_t k = 0; k < 3; ++k) {
      for (size_t c = 0; c < 4; ++c) sum[k][c] += other.sum[k][c];
    }
    pixels += other.pixels;
  }
};

struct Scales {
  std::vector<Sums> fine, coarse;
  Sums whole;
};

/// Adds the pixels of the rows from `first` up to `end` to their tiles. `term(pixel number)` gives a pixel's figures.
template <class Term>
void addRows(std::vector<Sums>& tiles, const TileGrid& grid, const Term& term, uint32_t first, uint32_t end) {
  for (uint32_t y = first; y < end; ++y) {
    for (uint32_t x = 0; x < grid.width; ++x) {
      tiles[grid.index(x, y)].add({term(size_t{y} * grid.width + x), 1.0});
    }
  }
}

auto plainTerm(const Picture& picture) {
  return [&picture](size_t i) { return std::array<Colour, 3>{colourAndLuminance(&picture.rgba[4 * i])}; };
}

/// From the sums of the fine tiles.
Scales allScales(const TileGrid& fine, const TileGrid& coarse, std::vector<Sums> tiles) {
  Scales s{std::move(tiles), std::vector<Sums>(coarse.count()), {}};
  for (size_t i = 0; i < s.fine.size(); ++i) s.coarse[coarse.index(fine.left(i), fine.top(i))].add(s.fine[i]);
  for (const Sums& tile : s.coarse) s.whole.add(tile);
  return s;
}

template <class Term>
Scales sumScales(const TileGrid& fine, const TileGrid& coarse, const Term& term) {
  std::vector<Sums> tiles(fine.count());
  addRows(tiles, fine, term, 0, fine.height);
  return allScales(fine, coarse, std::move(tiles));
}

/// Evidence whose every figure is `make(sums, colour)`.
template <class Make>
Evidence fromScales(const TileGrid& fine, const TileGrid& coarse, const Scales& s, const Make& make) {
  const auto all = [&](const Sums& sums) {
    ColourEstimates result;
    for (size_t c = 0; c < 4; ++c) result[c] = make(sums, c);
    return result;
  };
  Evidence e{fine, coarse, {}, {}, all(s.whole), 0};
  for (const Sums& tile : s.fine) e.fineTiles.push_back(all(tile));
  for (const Sums& tile : s.coarse) e.coarseTiles.push_back(all(tile));
  return e;
}

std::pair<TileGrid, TileGrid> grids(const Picture& picture, uint32_t fineSide, uint32_t coarseSide) {
  if (fineSide == 0 || coarseSide < fineSide || coarseSide % fineSide != 0)
    throw InputError(fmt::format("tiles of {}² must be made of whole tiles of {}²", coarseSide, fineSide));
  return {{picture.width, picture.height, fineSide}, {picture.width, picture.height, coarseSide}};
}

}  // namespace

void ShapeMoments::add(double value, uint64_t countWithIt) {
  const double n = double(countWithIt), delta = value - mean, step = delta / n, term = delta * step * (n - 1);
  fourth += term * step * step * (n * n - 3 * n + 3) + 6 * step * step * second - 4 * step * third;
  third += term * step * (n - 2) - 3 * step * second;
  second += term;
  mean += step;
}

Estimate estimate(const ShapeMoments& m, uint64_t count) {
  const double n = double(count);
  if (count < 2 || !std::isfinite(m.second)) return {m.mean, kInfinity, 1.0, 0.0};
  Estimate e{m.mean, m.second / (n * (n - 1)), n - 1, 0.0, 0.0, count};
  if (count < 4 || !(m.second > 0)) return e;
  const double variance = m.second / (n - 1);
  e.cumulant = m.third * n / ((n - 1) * (n - 2)) / (n * n);  // Fisher's k3 of the values, over n²
  const double k4 = n * ((n + 1) * m.fourth - 3 * (n - 1) / n * m.second * m.second) / ((n - 1) * (n - 2) * (n - 3));
  e.excess = std::max(0.0, k4 / (variance * variance));
  e.freedom = std::max(1.0, 2.0 / (2.0 / (n - 1) + e.excess / n));
  return e;
}

NonFinite findNonFinite(const Picture& picture) {
  NonFinite result;
  for (size_t i = 0; i < picture.rgba.size(); i += 4) {
    const float* p = &picture.rgba[i];
    if (std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2])) continue;
    if (result.pixels++ == 0) {
      result.x = static_cast<uint32_t>(i / 4 % picture.width);
      result.y = static_cast<uint32_t>(i / 4 / picture.width);
    }
  }
  return result;
}

void requireNotNegative(const Evidence& reference, const std::string& name) {
  const auto check = [&](const ColourEstimates& e, const std::string& where) {
    constexpr char kNames[] = {'R', 'G', 'B', 'Y'};
    for (size_t c = 0; c < 4; ++c) {
      if (!(e[c].mean < 0)) continue;
      throw InputError(fmt::format("the reference {} is negative: its mean{} is {:.6g} in {}; light is 0 or more", name,
                                   where, e[c].mean, kNames[c]));
    }
  };
  check(reference.whole, "");
  const auto checkTiles = [&](const TileGrid& grid, const std::vector<ColourEstimates>& tiles) {
    for (size_t i = 0; i < tiles.size(); ++i)
      check(tiles[i], fmt::format(" over the tile of {}² at {}, {}", grid.side, grid.left(i), grid.top(i)));
  };
  checkTiles(reference.coarse, reference.coarseTiles);
  checkTiles(reference.fine, reference.fineTiles);
}

EvidenceCollector::EvidenceCollector(uint32_t fineSide, uint32_t coarseSide) : pixels_(fineSide) {
  std::tie(fine_, coarse_) = grids({}, fineSide, coarseSide);
}

void EvidenceCollector::add(std::span<const Picture> pictures) {
  if (pictures.empty()) return;
  uint64_t restart = restarts();
  pixels_.add(pictures);
  if (restart == 0) {
    std::tie(fine_, coarse_) = grids(pictures[0], fine_.side, coarse_.side);
    fineShapes_.resize(fine_.count());
    coarseShapes_.resize(coarse_.count());
  }
  std::vector<std::vector<Sums>> tiles(pictures.size(), std::vector<Sums>(fine_.count()));
  forBands(fine_, pictures.size(), [&](uint32_t first, uint32_t end) {
    for (size_t k = 0; k < pictures.size(); ++k) addRows(tiles[k], fine_, plainTerm(pictures[k]), first, end);
  });
  std::vector<NonFinite> bad(pictures.size());
  parallelFor(pictures.size(), [&](size_t k) { bad[k] = findNonFinite(pictures[k]); });
  for (size_t k = 0; k < pictures.size(); ++k, ++restart) {
    if (bad[k].pixels > 0 && nonFinite_.pixels == 0) nonFinite_ = {0, bad[k].x, bad[k].y, restart};
    nonFinite_.pixels += bad[k].pixels;
    const auto put = [&](Shapes& shapes, const Sums& sums) {
      for (size_t c = 0; c < 4; ++c) shapes[c].add(sums.sum[0][c] / sums.pixels, restart + 1);
    };
    const Scales s = allScales(fine_, coarse_, std::move(tiles[k]));
    for (size_t i = 0; i < s.fine.size(); ++i) put(fineShapes_[i], s.fine[i]);
    for (size_t i = 0; i < s.coarse.size(); ++i) put(coarseShapes_[i], s.coarse[i]);
    put(wholeShapes_, s.whole);
  }
}

Evidence EvidenceCollector::evidence() const {
  const uint64_t n = restarts();
  const auto all = [&](const Shapes& shapes) {
    ColourEstimates result;
    for (size_t c = 0; c < 4; ++c) result[c] = estimate(shapes[c], n);
    return result;
  };
  Evidence e{fine_, coarse_, {}, {}, all(wholeShapes_), n};
  for (const Shapes& tile : fineShapes_) e.fineTiles.push_back(all(tile));
  for (const Shapes& tile : coarseShapes_) e.coarseTiles.push_back(all(tile));
  return e;
}

Evidence exactEvidence(const Picture& picture, uint32_t fineSide, uint32_t coarseSide) {
  const auto [fine, coarse] = grids(picture, fineSide, coarseSide);
  const Scales s = sumScales(fine, coarse, plainTerm(picture));
  return fromScales(fine, coarse, s, [](const Sums& t, size_t c) { return Estimate{t.sum[0][c] / t.pixels}; });
}

Evidence pictureEvidence(const Picture& picture, const Picture& error, uint64_t restarts, uint32_t fineSide,
                         uint32_t coarseSide) {
  requireSameSize(picture, error, "its standard error");
  for (size_t i = 0; i < error.rgba.size(); ++i) {
    if (i % 4 == 3 || (error.rgba[i] >= 0.0f && std::isfinite(error.rgba[i]))) continue;
    throw InputError(fmt::format("the reference's standard error is {} at pixel {}, {}", error.rgba[i],
                                 i / 4 % error.width, i / 4 / error.width));
  }
  const auto [fine, coarse] = grids(picture, fineSide, coarseSide);
  const Scales s = sumScales(fine, coarse, [&](size_t i) {
    std::array<Colour, 3> term{colourAndLuminance(&picture.rgba[4 * i]), colourAndLuminance(&error.rgba[4 * i])};
    for (size_t c = 0; c < 4; ++c) {
      term[1][c] *= term[1][c];
      term[2][c] = term[1][c] * term[1][c];
    }
    return term;
  });
  const double each = restarts > 2 ? double(restarts - 1) : 1.0;
  return fromScales(fine, coarse, s, [&](const Sums& t, size_t c) {
    Estimate e{t.sum[0][c] / t.pixels, t.sum[1][c] / (t.pixels * t.pixels)};
    if (t.sum[2][c] > 0) e.freedom = each * t.sum[1][c] * t.sum[1][c] / t.sum[2][c];
    e.count = restarts;
    return e;
  });
}

Evidence scatterEvidence(const Picture& picture, const Picture& other, uint32_t fineSide, uint32_t coarseSide) {
  requireSameSize(picture, other, "the tested picture");
  const auto [fine, coarse] = grids(picture, fineSide, coarseSide);
  const Scales s = sumScales(fine, coarse, [&](size_t i) {
    const Colour a = colourAndLuminance(&picture.rgba[4 * i]), b = colourAndLuminance(&other.rgba[4 * i]);
    std::array<Colour, 3> term{a};
    for (size_t c = 0; c < 4; ++c) {
      term[1][c] = a[c] - b[c];
      term[2][c] = term[1][c] * term[1][c];
    }
    return term;
  });
  return fromScales(fine, coarse, s, [](const Sums& t, size_t c) {
    const double n = t.pixels;
    Estimate e{t.sum[0][c] / n, kInfinity, 1.0};
    if (n < 2) return e;
    e.variance = std::max(0.0, t.sum[2][c] - t.sum[1][c] * t.sum[1][c] / n) / (n * (n - 1));
    e.freedom = n - 1;
    return e;
  });
}

}  // namespace weir::image
