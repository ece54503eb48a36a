// Student's t distribution, as far as tests of "unbiased" need it.
#pragma once

namespace weir::image {

/// Regularised incomplete beta function I_x(a, b), a, b > 0, x in [0,1]; relative error about 1e-13.
/// DLMF 8.17.22 (continued fraction), 8.17.4 (reflection).
double incompleteBeta(double a, double b, double x);

/// P(T <= t) with `degreesOfFreedom` >= 1. Abramowitz & Stegun 26.7.1 with 26.5.27.
double studentTCdf(double t, int degreesOfFreedom);

/// P(|T| > t), t >= 0; keeps its relative precision far out, where 1 - CDF has none left.
double studentTTwoSided(double t, int degreesOfFreedom);

/// The t with P(T <= t) = p, 0 < p < 1.
double studentTQuantile(double p, int degreesOfFreedom);

/// The two-sided bound that all of `comparisons` |t| stay below with probability 1 - alpha when nothing is wrong:
/// P(|T| > bound) = 1 - (1 - alpha)^(1/comparisons). Šidák 1967; exact for independent comparisons, on the safe side
/// (fewer false alarms) for dependent ones. Throws std::invalid_argument outside 0 < alpha < 1, comparisons >= 1.
double studentTBound(int degreesOfFreedom, double alpha, int comparisons);

}  // namespace weir::image
