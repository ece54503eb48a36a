// Vose's alias method (1991), "A Linear Algorithm for Generating Random Numbers with a Given Distribution".
#include <weir/core/error.h>
#include <weir/scene/lights.h>

#include <cmath>
#include <string>

namespace weir::scene {
namespace {

/// A double with the rounding error of its sums beside it (Knuth's two-sum). A bright light among millions is
/// the partner of nearly all of them; plain doubles would lose its remainder.
struct ExactSum {
  double value = 0.0, error = 0.0;
  void add(double x) {
    const double sum = value + x;
    const double part = sum - value;
    error += (value - (sum - part)) + (x - part);
    value = sum;
  }
  double total() const { return value + error; }
};

}  // namespace

std::vector<AliasCell> buildAliasTable(const std::vector<double>& weights) {
  double largest = 0.0;
  for (size_t i = 0; i < weights.size(); ++i) {
    if (!std::isfinite(weights[i]) || weights[i] < 0.0)
      throw InputError("light " + std::to_string(i) + " has a weight that is negative or not finite");
    largest = std::max(largest, weights[i]);
  }
  if (largest <= 0.0) return {};

  // Divided by the largest first, so that neither huge nor denormal weights overflow or vanish in the sum.
  const size_t n = weights.size();
  ExactSum sum;
  for (double weight : weights) sum.add(weight / largest);
  const double scale = static_cast<double>(n) / sum.total();
  std::vector<ExactSum> left(n);  // what of the cell's n·p is not yet handed out
  std::vector<uint32_t> small, large;
  for (size_t i = 0; i < n; ++i) {
    left[i].value = weights[i] / largest * scale;
    (left[i].value < 1.0 ? small : large).push_back(static_cast<uint32_t>(i));
  }

  std::vector<AliasCell> table(n);
  // Thresholds are floats. Each is rounded the way that keeps the sum of all rounding errors near zero, and what
  // the float really leaves over is what its partner gives: so no cell inherits the errors of a million others.
  double drift = 0.0;
  while (!small.empty() && !large.empty()) {
    const uint32_t s = small.back();
    small.pop_back();
    const uint32_t l = large.back();
    const double wanted = std::max(left[s].total(), 0.0);
    float threshold = static_cast<float>(wanted);
    const float other = std::nextafter(threshold, threshold > wanted ? 0.0f : 1.0f);
    if (std::abs(drift + (other - wanted)) < std::abs(drift + (threshold - wanted)) && (other > 0.0f || wanted == 0.0))
      threshold = other;
    drift += threshold - wanted;
    table[s] = {threshold, l};
    left[l].add(-1.0);
    left[l].add(threshold);
    if (left[l].total() < 1.0) {
      large.pop_back();
      small.push_back(l);
    }
  }
  // The rest holds 1 up to rounding.
  for (uint32_t i : small) table[i] = {1.0f, i};
  for (uint32_t i : large) table[i] = {1.0f, i};
  return table;
}

std::vector<double> aliasProbabilities(const std::vector<AliasCell>& table) {
  std::vector<ExactSum> sums(table.size());
  for (size_t i = 0; i < table.size(); ++i) {
    sums[i].add(table[i].threshold);
    if (table[i].threshold < 1.0f) sums[table[i].alias].add(1.0 - static_cast<double>(table[i].threshold));
  }
  std::vector<double> probabilities(table.size());
  for (size_t i = 0; i < table.size(); ++i) probabilities[i] = sums[i].total() / static_cast<double>(table.size());
  return probabilities;
}

}  // namespace weir::scene
