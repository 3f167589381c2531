#include "device_model/theory/sampled_loop.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <unsupported/Eigen/MatrixFunctions>

#include "device_model/theory/eigenvalue_edge.hpp"

namespace hapbench {
namespace {

/// Less is as good as none; eigenvalues that close to 1 are lost in rounding.
constexpr double kLeastEdge = 1e-8;  // of K T^2 / m
constexpr double kNoEdge = 1e6;

/// Indices of the state.
enum { kPosition, kVelocity, kLastPosition, kLastFiltered, kForces };

/// (x, T v) after a share of the period: the first two columns times (x, T v), the last one times a constant T^2/m f.
Eigen::Matrix<double, 2, 3> free_motion(const SampledLoop& loop, double share) {
  const double m = loop.moving_mass(), T = loop.period;
  Eigen::Matrix3d rate = Eigen::Matrix3d::Zero();
  rate(0, 1) = 1.0;
  rate.row(1) << -loop.hand.stiffness * T * T / m, -loop.total_damping() * T / m, 1.0;
  return Eigen::Matrix3d((rate * share).exp()).topRows<2>();
}

}  // namespace

double SampledLoop::filter_memory() const {
  return cutoff ? std::exp(-2.0 * std::numbers::pi * *cutoff * period) : 0.0;
}

Eigen::MatrixXd SampledLoop::state_matrix() const {
  const double T = period, m = moving_mass(), a = filter_memory();
  const Eigen::Index whole = static_cast<Eigen::Index>(std::floor(delay));
  const double part = delay - static_cast<double>(whole);
  const Eigen::Index kept = whole + (part > 0.0 ? 1 : 0), n = kForces + kept;

  Eigen::RowVectorXd filtered = Eigen::RowVectorXd::Zero(n);
  filtered(kPosition) = 1.0 - a;
  filtered(kLastPosition) = a - 1.0;
  filtered(kLastFiltered) = a;
  Eigen::RowVectorXd force = -(wall_damping * T / m) * filtered;
  force(kPosition) -= stiffness * T * T / m;
  // Of so many samples ago.
  const auto force_of = [&](Eigen::Index age) -> Eigen::RowVectorXd {
    return age == 0 ? force : Eigen::RowVectorXd(Eigen::RowVectorXd::Unit(n, kForces + age - 1));
  };

  const auto before = free_motion(*this, part), after = free_motion(*this, 1.0 - part);
  Eigen::MatrixXd moving = Eigen::MatrixXd::Zero(2, n);
  moving.leftCols<2>() = before.leftCols<2>();
  if (part > 0.0) moving += before.col(2) * force_of(whole + 1);

  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, n);
  A.topRows<2>() = after.leftCols<2>() * moving + after.col(2) * force_of(whole);
  A(kLastPosition, kPosition) = 1.0;
  A.row(kLastFiltered) = filtered;
  for (Eigen::Index age = 0; age < kept; ++age) A.row(kForces + age) = force_of(age);
  return A;
}

double eigenvalue_edge(SampledLoop loop) {
  const double unit = loop.moving_mass() / (loop.period * loop.period);
  return first_edge(kLeastEdge * unit, kNoEdge * unit, [&loop](double K) {
    loop.stiffness = K;
    return loop.state_matrix();
  });
}

std::span<const AttachedHand> hand_family() {
  static constexpr AttachedHand kFamily[] = {{},           {0.1, 100.0},  {0.1, 300.0}, {0.1, 1000.0}, {0.2, 100.0},
                                             {0.2, 300.0}, {0.2, 1000.0}, {0.5, 100.0}, {0.5, 300.0},  {0.5, 1000.0}};
  return kFamily;
}

double worst_hand_edge(SampledLoop loop) {
  double least = std::numeric_limits<double>::infinity();
  for (const AttachedHand& hand : hand_family()) {
    loop.hand = hand;
    least = std::min(least, eigenvalue_edge(loop));
  }
  return least;
}

}  // namespace hapbench
