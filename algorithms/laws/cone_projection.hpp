#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/core/simd.hpp"
#include "sim/core/types.hpp"

/// The solver behind exact_shaping and merged_shaping. For source files only (see simd.hpp).
namespace hapbench::cone_projection {

using Vec6 = Eigen::Matrix<double, 6, 1>;
using Mat6 = Eigen::Matrix<double, 6, 6>;

/// epsilon: small enough that ratios are 1 to six digits, large enough that the weights are unique and the six
/// equations are solved to rounding.
inline constexpr double kEps = 1e-6;
/// Newton steps tried at once; nearly all scenes need one or two.
inline constexpr int kDirectSteps = 6;
/// The values of epsilon to go through when those are not enough (see solve).
inline constexpr double kPath[] = {1e-2, 1e-4, kEps};
inline constexpr int kMaxNewtonSteps = 1000;  ///< for one epsilon; Newton's method ends by itself, in exact arithmetic
inline constexpr int kMaxLineSearchSteps = 40;
inline constexpr int kMaxRefinements = 5;
/// Residual of the optimality condition that is left to rounding: S sums up to n terms of at most 1 in eight parts.
inline constexpr double kResidualRounding = 1e-14;

/// The identity in the basis below.
inline const Vec6& identity6() {
  static const Vec6 identity = (Vec6() << 1, 1, 1, 0, 0, 0).finished();
  return identity;
}

/// Eight symmetric tensors in the orthonormal basis (xx, yy, zz, sqrt2 xy, sqrt2 xz, sqrt2 yz), in which the Frobenius
/// product of two of them is a dot product: the six-vectors a_i of the solver.
struct TensorPack {
  simd::Pack a[6];

  simd::Pack dot(const Vec6& w) const {
    return ((a[0] * simd::Pack(w[0]) + a[1] * simd::Pack(w[1])) + (a[2] * simd::Pack(w[2]) + a[3] * simd::Pack(w[3]))) +
           (a[4] * simd::Pack(w[4]) + a[5] * simd::Pack(w[5]));
  }
};

/// What is projected onto the cone of: tensors of trace 1, `pack(i)` those from i on, and a weight for each, both
/// padded to whole packs with zeros.
///
///   struct Tensors { std::size_t size, padded_size; double* weight; TensorPack pack(std::size_t i) const; };

/// What one pass over the contacts leaves beside their weights.
struct Pass {
  Mat6 G;            ///< sum a a^T over the active tensors, c_i > 0
  Vec6 S;            ///< sum c_i a_i
  bool same_active;  ///< none changed between active and inactive
};

/// Gives every tensor the weight c_i = max(0, weight_of(a_i, c_i before)).
template <class Tensors, class WeightOf>
Pass sweep(const Tensors& tensors, WeightOf weight_of) noexcept {
  using simd::Pack;
  Pack g[21], s[6];
  std::fill(std::begin(g), std::end(g), Pack(0.0));
  std::fill(std::begin(s), std::end(s), Pack(0.0));
  const Pack zero(0.0), one(1.0);
  bool same = true;
  for (std::size_t i = 0; i < tensors.padded_size; i += simd::lanes) {
    const TensorPack u = tensors.pack(i);
    const Pack c_before = simd::load(tensors.weight + i);
    const Pack t = weight_of(u, c_before);
    const simd::Mask active = t > zero, before = c_before > zero;
    same = same && !simd::any((active && !before) || (before && !active));
    const Pack c = simd::select(active, t, zero), on = simd::select(active, one, zero);
    simd::store(c, tensors.weight + i);
    for (int j = 0, k = 0; j < 6; ++j) {
      s[j] += c * u.a[j];
      const Pack masked = on * u.a[j];
      for (int l = 0; l <= j; ++l) g[k++] += masked * u.a[l];
    }
  }
  Pass pass;
  pass.same_active = same;
  for (int j = 0, k = 0; j < 6; ++j) {
    pass.S[j] = simd::sum(s[j]);
    for (int l = 0; l <= j; ++l) pass.G(j, l) = pass.G(l, j) = simd::sum(g[k++]);
  }
  return pass;
}

/// The pass at the point w of the dual: c_i = max(0, a_i . w).
template <class Tensors>
Pass evaluate(const Tensors& tensors, const Vec6& w) noexcept {
  return sweep(tensors, [&w](const TensorPack& u, const simd::Pack&) { return u.dot(w); });
}

/// (eps I + G)^-1 b
Vec6 solve_step(const Mat6& G, double eps, const Vec6& b) noexcept;

/// Gradient of the convex dual ½|eps w - I|² / eps + ½ sum max(0, a_i . w)²: zero at the optimum.
inline Vec6 dual_gradient(const Vec6& w, double eps, const Pass& pass) noexcept {
  return eps * w - identity6() + pass.S;
}

/// Moves w towards `target` until the dual's slope along the way is no longer steep (bisection on a monotone slope).
/// The dual is convex and piecewise quadratic, so this descends and Newton's method converges from anywhere. `pass`
/// comes in evaluated at `target` and goes out evaluated at w. False when the slope is lost in rounding.
template <class Tensors>
bool line_search(const Tensors& tensors, const Vec6& target, double eps, double slope_at_w, Vec6& w,
                 Pass& pass) noexcept {
  const Vec6 start = w, way = target - w;
  w = target;
  double low = 0.0, high = 1.0, fraction = 1.0;
  for (int i = 0; i < kMaxLineSearchSteps; ++i) {
    const double slope = dual_gradient(w, eps, pass).dot(way);
    const bool still_descending_at_target = fraction == 1.0 && slope <= 0.0;
    if (still_descending_at_target || std::abs(slope) <= 0.5 * std::abs(slope_at_w)) return true;
    (slope > 0.0 ? high : low) = fraction;
    fraction = 0.5 * (low + high);
    w = start + fraction * way;
    pass = evaluate(tensors, w);
  }
  return false;
}

/// Newton's method for one epsilon from w, where `pass` is evaluated; both go out at the last point. Counts its steps.
/// True when it has converged to rounding.
template <class Tensors>
bool newton(const Tensors& tensors, double eps, int max_steps, Vec6& w, Pass& pass, int& steps) noexcept {
  const double n = static_cast<double>(tensors.size);
  for (int step = 0; step < max_steps; ++step) {
    ++steps;
    // On a fixed active set the dual is quadratic; its minimum is where (eps I + G) w = identity.
    const Vec6 target = solve_step(pass.G, eps, identity6());
    const double slope = dual_gradient(w, eps, pass).dot(target - w);
    pass = evaluate(tensors, target);
    // A contact whose exact weight is zero may flicker between active and inactive by the rounding of a_i . target.
    const double rounding = 1e-15 * (1.0 + n) * (1.0 + target.norm());
    const bool flickers_only = pass.same_active || dual_gradient(target, eps, pass).norm() <= rounding;
    // In exact arithmetic the slope is negative short of the optimum: otherwise rounding is all that is left of it.
    if (flickers_only || slope >= 0.0) {
      w = target;
      return true;
    }
    if (!line_search(tensors, target, eps, slope, w, pass)) return true;
  }
  return false;
}

/// Removes the rounding of the last solve, which the factor 1/eps has amplified: with R the residual of the optimality
/// condition, w += (eps I + G)^-1 R, and the weights follow by adding the small a_i . correction, which keeps the
/// digits that a_i . w loses.
template <class Tensors>
void refine(const Tensors& tensors, Vec6 w, Pass pass) noexcept {
  const simd::Pack zero(0.0);
  for (int round = 0; round < kMaxRefinements; ++round) {
    const Vec6 residual = -dual_gradient(w, kEps, pass);
    if (residual.norm() <= kResidualRounding) return;
    const Vec6 correction = solve_step(pass.G, kEps, residual);
    w += correction;
    pass = sweep(tensors, [&](const TensorPack& u, const simd::Pack& c) {
      return simd::select(c > zero, c + u.dot(correction), u.dot(w));
    });
  }
}

/// Weights minimising ½|S - I|²_F + (epsilon/2)|c|², c >= 0, S = sum c_i a_i, left in `tensors`; returns the number of
/// Newton steps. Weights come in as 1. At the optimum <a_i, S> = 1 - epsilon c_i where c_i > 0 and >= 1 where c_i = 0,
/// and tr S >= |S|²_F, whatever the tensors of trace 1 are: hence lambda_max(S) <= (1 + sqrt 3)/2.
template <class Tensors>
int solve(const Tensors& tensors) noexcept {
  // Every tensor is active at w = identity, because a_i . identity is its trace.
  Vec6 w = identity6();
  Pass pass = evaluate(tensors, w);
  int steps = 0;
  if (!newton(tensors, kEps, kDirectSteps, w, pass, steps)) {
    // Dense clusters of nearly equal gradients: the optimum keeps a handful of hundreds, and Newton's method would
    // find them one by one. Following the optimum from a large epsilon down takes a few steps each: at most 32 in
    // all for 6e6 adversarial sets instead of a hundred, 135 for the worst of 1e6 mixtures of such sets.
    double eps = kPath[0];
    w = identity6() / eps;
    pass = evaluate(tensors, w);
    for (const double next : kPath) {
      // The same Y = eps w at the next epsilon: weights scale, and the active set stays.
      w *= eps / next;
      pass.S *= eps / next;
      eps = next;
      newton(tensors, eps, kMaxNewtonSteps, w, pass, steps);
    }
  }
  refine(tensors, w, pass);
  return steps;
}

}  // namespace hapbench::cone_projection
