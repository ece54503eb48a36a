// How alike frames of one sequence are: what averaging N of them is worth.
//
// The integrated autocorrelation time τ is defined by Var(mean of N frames) → τ · Var(one frame) / N for large N. τ =
// 1: frames are independent; τ = 40: forty frames are worth one. docs/bench.md derives the estimator:
//
//   V_N(p) = 1/(R-1) Σ_r |m_r(p) - m̄(p)|²       variance of a sequence's mean m_r over R independent sequences
//   W(p)   = 1/R Σ_r ( e_r(p) - |m_r(p) - b(p)|² )   variance inside of a sequence; e_r: mean error of its frames
//   τ_N    = N · Σ_p V_N / Σ_p (W + V_N)
//
// where |x|² = Σ over R, G, B of x² / (b² + 0.01) / 3 and b is any fixed picture (the reference), which cancels in W.
// Pixels sum up numerator and denominator, so that the ratio is that of the picture's whole variance; the 0.1 % of the
// pixels that vary most are left out of both. A finite N sees only part of the correlation; for an autocorrelation ρ^k
//   τ_N = (1+ρ)/(1-ρ) - 2ρ (1-ρ^N) / (N (1-ρ)²)
// and τ = (1+ρ)/(1-ρ) of the ρ that solves this is what is reported.
#pragma once

#include <weir/image/image.h>
#include <weir/image/interval.h>

#include <cstdint>
#include <span>
#include <vector>

namespace weir::image {

/// One sequence of frames from cleared history with a seed of its own.
struct SequenceErrors {
  Picture mean;               ///< of all its frames
  std::vector<float> errors;  ///< by pixel: mean over (some of) its frames of RelativeErrorMeter::pixels()
};

/// `frames`: N, of each sequence. In frames; NaN where fewer than two sequences are given, nothing varies, or the
/// sequences are too short to tell (τ_N reaches N). The interval is the jackknife's over sequences. Throws InputError
/// when sizes differ.
Interval correlationTime(std::span<const SequenceErrors> sequences, const Picture& reference, uint64_t frames);

/// τ of a geometric autocorrelation from the τ_N that N frames show; infinite for τ_N ≥ N, NaN for NaN, 0 for ≤ 0.
double untruncatedTime(double timeOfN, uint64_t frames);

}  // namespace weir::image
