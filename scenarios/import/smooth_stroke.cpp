#include "scenarios/import/smooth_stroke.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <cmath>

#include "scenarios/input/input_error.hpp"

namespace hapbench {
namespace {

using Eigen::Index;

/// Row i: the weights of a window's samples in the value at place i of the polynomial fitted to them.
Eigen::MatrixXd fit_weights(const Smoothing& smoothing) {
  const Index window = smoothing.window, terms = smoothing.order + 1;
  const double half = static_cast<double>(window - 1) / 2.0;
  Eigen::MatrixXd powers(window, terms);
  for (Index i = 0; i < window; ++i) {
    const double x = half > 0.0 ? (static_cast<double>(i) - half) / half : 0.0;
    for (Index j = 0; j < terms; ++j) powers(i, j) = std::pow(x, static_cast<double>(j));
  }
  // The projection on the polynomials, by an orthogonal basis: high orders stay accurate.
  const Eigen::MatrixXd basis = powers.householderQr().householderQ() * Eigen::MatrixXd::Identity(window, terms);
  return basis * basis.transpose();
}

/// Columns are quantities, rows samples.
Eigen::MatrixXd smoothed(const Eigen::MatrixXd& given, const Smoothing& smoothing) {
  const Eigen::MatrixXd weights = fit_weights(smoothing);
  const Index n = given.rows(), window = smoothing.window, half = window / 2;
  Eigen::MatrixXd out(n, given.cols());
  for (Index k = 0; k < n; ++k) {
    const Index first = std::clamp<Index>(k - half, 0, n - window);
    out.row(k) = weights.row(k - first) * given.middleRows(first, window);
  }
  return out;
}

}  // namespace

SmoothingChange smooth(StrokeSamples& stroke, const Smoothing& smoothing) {
  const auto [window, order] = smoothing;
  if (window < 3 || window % 2 == 0 || window > 10001 || static_cast<std::size_t>(window) > stroke.size())
    throw InputError(fmt::format("smooth: got a window of {} samples; allowed: odd, 3 ... {}", window,
                                 std::min<std::size_t>(stroke.size(), 10001)));
  if (order < 0 || order >= window || order > 20)
    throw InputError(fmt::format("smooth: got order {}; allowed: 0 ... {}", order, std::min(window - 1, 20)));
  const Index n = static_cast<Index>(stroke.size());
  Eigen::MatrixXd values(n, 7);
  for (Index k = 0; k < n; ++k) {
    const auto i = static_cast<std::size_t>(k);
    values.row(k) << stroke.position[i].transpose(), stroke.turn[i].coeffs().transpose();
  }
  values = smoothed(values, smoothing);
  SmoothingChange change;
  for (Index k = 0; k < n; ++k) {
    const auto i = static_cast<std::size_t>(k);
    const Vec3 position = values.row(k).head<3>();
    Eigen::Quaterniond turn = stroke.turn[i];
    const Eigen::Vector4d coefficients = values.row(k).tail<4>();
    // A window over half a turn may average to nothing; such samples keep what they have.
    if (coefficients.norm() > 0.1) turn.coeffs() = coefficients.normalized();
    const double moved = (position - stroke.position[i]).norm(), turned = turn.angularDistance(stroke.turn[i]);
    change.position_largest = std::max(change.position_largest, moved);
    change.angle_largest = std::max(change.angle_largest, turned);
    change.position_rms += moved * moved;
    change.angle_rms += turned * turned;
    stroke.position[i] = position;
    stroke.turn[i] = turn;
  }
  change.position_rms = std::sqrt(change.position_rms / static_cast<double>(n));
  change.angle_rms = std::sqrt(change.angle_rms / static_cast<double>(n));
  return change;
}

}  // namespace hapbench
