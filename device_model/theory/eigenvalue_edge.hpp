#pragma once

#include <Eigen/Core>

#include "sim/core/bisection.hpp"

/// Where a loop, whose step is a linear map of its state, becomes unstable.
namespace hapbench {

/// Largest |eigenvalue| of a square matrix. Exact to rounding where its entries are of comparable size.
double spectral_radius(const Eigen::MatrixXd& A);

/// True while no eigenvalue leaves the unit circle by more than rounding.
inline bool is_stable_step(const Eigen::MatrixXd& A) {
  return spectral_radius(A) <= 1.0 + 1e-13;
}

/// Of a number that grows from `least` to `most`, the largest below which the step is stable, to 1e-11 of it: zero when
/// already `least` is unstable, infinite when nothing is. `step_matrix(value)` is the step with that number.
///
/// It is the first edge from below: every value of a grid of a tenth apart is tried from `least` on, and the first that
/// is unstable is bisected against the last that was not. Only a gap that begins and ends within a tenth is overlooked;
/// the tests hold the edges of random loops against their frequency responses, which show every crossing.
template <class StepMatrix>
double first_edge(double least, double most, StepMatrix step_matrix) {
  const auto stable = [&](double value) { return is_stable_step(step_matrix(value)); };
  return stable(least) ? largest_stable(least, 1e-11, stable, most, 1.1) : 0.0;
}

}  // namespace hapbench
