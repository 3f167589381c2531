#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include "device_model/theory/linear_loops.hpp"
#include "sim/core/math.hpp"

namespace hapbench {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

/// Elastic between motors and handle. For the conditions of passivity it is part of the hand, which they leave open;
/// others count on one mass.
bool is_elastic(const SampledLoop& loop) {
  return loop.device.transmission.has_value();
}

std::optional<double> colgate_schenkel(const SampledLoop& loop) {
  if (loop.device.delay_samples != 0.0 || !loop.differentiates()) return std::nullopt;
  return std::max(0.0, 2.0 * (loop.device.viscous - std::abs(loop.wall_damping)) / loop.period);
}

/// The condition b > K p + B r at one angle theta = omega T, with e = exp(-j theta) and the filters F of the velocity
/// and G of the position:
///
///   p = T/2 Re{(1 - e) G e^d} / (1 - cos theta),   r = 1/2 Re{(1 - e)^2 F e^d} / (1 - cos theta)
struct PassivityAt {
  double p, r;
};

PassivityAt passivity_at(const SampledLoop& loop, double theta) {
  const double d = loop.device.delay_samples, turn = (d + 1.0) * theta, late = (d + 0.5) * theta;
  const auto response = [theta](const std::vector<LowPassMode>& modes) {
    std::complex<double> sum = modes.empty() ? 1.0 : 0.0;
    for (const LowPassMode& mode : modes) sum += mode.response(theta);
    return sum;
  };
  const std::complex<double> F = response(loop.velocity_modes()), G = response(loop.position_modes());
  // 1 - e = 2 j sin(theta/2) e^(1/2) and (1 - e)^2 = -2 (1 - cos theta) e
  return {loop.period * (G.real() * math::sin(late) - G.imag() * math::cos(late)) / (2.0 * math::sin(0.5 * theta)),
          -(F.real() * math::cos(turn) + F.imag() * math::sin(turn))};
}

/// The least value of a function between two angles, on a grid and then on ever finer grids around its best point.
template <class Function>
double least_value(Function f, double low, double high, int points) {
  double least = kNever;
  for (int zoom = 0; zoom < 8; ++zoom) {
    const double step = (high - low) / points;
    double best = low;
    for (int i = 0; i <= points; ++i) {
      const double at = low + step * i, value = f(at);
      if (value < least) least = value, best = at;
    }
    low = std::max(low, best - step);
    high = std::min(high, best + step);
    points = 16;
  }
  return least;
}

/// The condition bounds K from above where p > 0, from below where p < 0.
std::optional<double> passive_with_delay(const SampledLoop& loop) {
  const double d = loop.device.delay_samples;
  if (d != std::floor(d)) return std::nullopt;
  const auto bound = [&loop](double theta, bool above) {
    const auto [p, r] = passivity_at(loop, theta);
    return (above ? p > 0.0 : p < 0.0) ? (loop.device.viscous - loop.wall_damping * r) / std::abs(p) : kNever;
  };
  constexpr double kFirst = 1e-6;  // 0 / 0 at 0; the function is even and smooth there
  const int points = 256 * (1 + static_cast<int>(d));
  const double most = least_value([&](double t) { return bound(t, true); }, kFirst, std::numbers::pi, points);
  const double least = -least_value([&](double t) { return bound(t, false); }, kFirst, std::numbers::pi, points);
  return most > std::max(0.0, least) ? most : 0.0;
}

std::optional<double> gil_hulin(const SampledLoop& loop) {
  constexpr double kLowDamping = 0.15;
  const double damping = loop.total_damping() + loop.wall_damping;
  const double late = loop.period * (1.0 + loop.device.delay_samples);
  if (is_elastic(loop) || !loop.differentiates() || damping * late / loop.moving_mass() > kLowDamping)
    return std::nullopt;
  return std::max(0.0, damping / (loop.period * (0.5 + loop.device.delay_samples)));
}

std::optional<double> abbott_okamura(const SampledLoop& loop) {
  if (loop.device.delay_samples != 0.0 || loop.wall_damping != 0.0 || loop.device.encoder_step <= 0.0 ||
      loop.device.position_filter)
    return std::nullopt;
  return std::min(2.0 * loop.device.viscous / loop.period, 2.0 * loop.device.coulomb / loop.device.encoder_step);
}

std::optional<double> undamped_handle(const SampledLoop& loop) {
  const bool bare = loop.total_damping() == 0.0 && loop.hand.stiffness == 0.0;
  if (is_elastic(loop) || !bare || loop.device.delay_samples != 0.0 || !loop.differentiates()) return std::nullopt;
  const double m = loop.moving_mass(), T = loop.period, beta = loop.wall_damping * T / m;
  return std::max(0.0, 2.0 * beta * (2.0 - beta) / (2.0 + beta) * m / (T * T));
}

constexpr StiffnessLimit kLimits[] = {
    {.name = "passive_colgate_schenkel",
     .formula = "K < 2 (b - |B|) / T",
     .source =
         "J. E. Colgate, G. Schenkel, Passivity of a class of sampled-data systems, J. Robotic Systems 14(1), 1997",
     .applies = "no delay, velocity by the difference; passive for every passive hand",
     .largest = colgate_schenkel},
    {.name = "passive_with_delay",
     .formula = "b > max over theta of K T sin((d + 1/2) theta) / (2 sin(theta/2)) - B Re{F e^(-j (d + 1) theta)}",
     .source =
         "the general condition of Colgate and Schenkel for this wall, derived; F is the velocity filter, a filter of "
         "the position also counts",
     .applies = "whole delays; passive for every passive hand",
     .largest = passive_with_delay},
    {.name = "stable_gil_hulin",
     .formula = "K < (b + B) / (T/2 + t_d), b with the hand's",
     .source = "J. J. Gil, E. Sanchez, T. Hulin, C. Preusche, G. Hirzinger, J. Comput. Inf. Sci. Eng. 9(1), 2009",
     .applies =
         "an approximation for low damping and short delays, (b + B)(T + t_d) / m <= 0.15 (ours: at most 14 % above the exact "
         "edge there); velocity by the difference",
     .largest = gil_hulin},
    {.name = "passive_abbott_okamura",
     .formula = "K <= min(2 b / T, 2 c / q)",
     .source =
         "J. J. Abbott, A. M. Okamura, Effects of position quantization and sampling rate on virtual-wall passivity, IEEE "
         "T-RO 21(5), 2005",
     .applies = "no delay, B = 0, an encoder step q > 0",
     .largest = abbott_okamura},
    {.name = "exact_undamped_handle",
     .formula = "K T^2/m < 2 beta (2 - beta) / (2 + beta), beta = B T/m",
     .source = "derived",
     .applies = "no delay, velocity by the difference, neither handle nor hand damp and no hand's spring",
     .largest = undamped_handle},
};

}  // namespace

std::span<const StiffnessLimit> stiffness_limits() {
  return kLimits;
}

}  // namespace hapbench
