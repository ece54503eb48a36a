#include <weir/image/student.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace weir::image {
namespace {

/// DLMF 8.17.22 by the modified Lentz algorithm (Thompson & Barnett 1986).
double betaFraction(double a, double b, double x) {
  constexpr double kTiny = 1e-300;
  const auto guarded = [](double v) { return std::abs(v) < kTiny ? kTiny : v; };
  double c = 1.0, d = 1.0 / guarded(1.0 - (a + b) * x / (a + 1.0)), value = d;
  for (int m = 1; m <= 10000; ++m) {
    const double even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m));
    d = 1.0 / guarded(1.0 + even * d);
    c = guarded(1.0 + even / c);
    value *= c * d;
    const double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
    d = 1.0 / guarded(1.0 + odd * d);
    c = guarded(1.0 + odd / c);
    value *= c * d;
    if (std::abs(c * d - 1.0) < 1e-15) break;
  }
  return value;
}

/// std::lgamma writes the global signgam, which two threads must not do at once.
double logGamma(double x) {
  int sign = 0;
  return ::lgamma_r(x, &sign);
}

void requireFreedom(int degreesOfFreedom) {
  if (degreesOfFreedom < 1) throw std::invalid_argument("Student's t needs at least one degree of freedom");
}

/// The t >= 0 with P(|T| > t) = tail. Bisection on a monotone function: slow, and it cannot fail.
double twoSidedInverse(double tail, int degreesOfFreedom) {
  double low = 0.0, high = 1.0;
  while (studentTTwoSided(high, degreesOfFreedom) > tail && high < 1e300) high *= 2.0;
  for (int i = 0; i < 200; ++i) {
    const double middle = 0.5 * (low + high);
    if (middle == low || middle == high) break;
    (studentTTwoSided(middle, degreesOfFreedom) > tail ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace

double incompleteBeta(double a, double b, double x) {
  if (x <= 0.0) return 0.0;
  if (x >= 1.0) return 1.0;
  const double front = std::exp(logGamma(a + b) - logGamma(a) - logGamma(b) + a * std::log(x) + b * std::log1p(-x));
  // The fraction converges fast on this side of the mean only; the other side is its mirror image.
  if (x < (a + 1.0) / (a + b + 2.0)) return front * betaFraction(a, b, x) / a;
  return 1.0 - front * betaFraction(b, a, 1.0 - x) / b;
}

double studentTTwoSided(double t, int degreesOfFreedom) {
  requireFreedom(degreesOfFreedom);
  if (std::isnan(t)) return t;
  const double nu = degreesOfFreedom;
  // Near 0 the second form would take 1 - x of an x near 1; farther out the first would take 1 - nearly 1.
  if (t * t < 1.0) return 1.0 - incompleteBeta(0.5, nu / 2.0, t * t / (nu + t * t));
  return incompleteBeta(nu / 2.0, 0.5, nu / (nu + t * t));
}

double studentTCdf(double t, int degreesOfFreedom) {
  const double tail = 0.5 * studentTTwoSided(std::abs(t), degreesOfFreedom);
  return t > 0.0 ? 1.0 - tail : tail;
}

double studentTQuantile(double p, int degreesOfFreedom) {
  requireFreedom(degreesOfFreedom);
  if (!(p > 0.0 && p < 1.0)) throw std::invalid_argument("a quantile needs 0 < p < 1");
  if (p == 0.5) return 0.0;
  const double t = twoSidedInverse(2.0 * std::min(p, 1.0 - p), degreesOfFreedom);
  return p < 0.5 ? -t : t;
}

double studentTBound(int degreesOfFreedom, double alpha, int comparisons) {
  requireFreedom(degreesOfFreedom);
  if (!(alpha > 0.0 && alpha < 1.0) || comparisons < 1) {
    throw std::invalid_argument("a bound needs 0 < alpha < 1 and at least one comparison");
  }
  return twoSidedInverse(-std::expm1(std::log1p(-alpha) / comparisons), degreesOfFreedom);
}

}  // namespace weir::image
