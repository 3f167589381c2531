#include "device_model/theory/linear_loops.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <complex>
#include <numbers>
#include <numeric>
#include <unsupported/Eigen/MatrixFunctions>

#include "sim/core/math.hpp"

namespace hapbench {

Eigen::VectorXcd eigenvalues(const Eigen::MatrixXd& A) {
  return Eigen::EigenSolver<Eigen::MatrixXd>(A, false).eigenvalues();
}

namespace {

/// Range of K T^2 / m that is searched for the limit. For smaller values the eigenvalues are so close to 1 that
/// rounding decides.
constexpr double kMinLimit = 1e-8;
constexpr double kMaxLimit = 1e6;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Indices of a SampledLoop's state.
enum { kPosition, kVelocity, kLastPosition, kModes };

/// Returns true if the mode belongs to a pair of complex poles.
bool is_pair(const LowPassMode& mode) {
  return mode.gain.imag() != 0.0;
}

/// Returns motion_rate for an elastic transmission; the state is (x, T v) of the motors, (x, T v) of the handle and
/// the scaled force.
Eigen::MatrixXd elastic_motion_rate(const SampledLoop& loop, const Transmission& transmission) {
  const double T = loop.period, motor = transmission.motor_share * loop.device.handle_mass,
               handle = loop.moving_mass() - motor, k = transmission.stiffness * T * T, d = transmission.damping * T;
  Eigen::MatrixXd rate = Eigen::MatrixXd::Zero(5, 5);
  rate(0, 1) = rate(2, 3) = 1.0;
  rate.row(1) << -k / motor, -(d + loop.device.viscous * T) / motor, k / motor, d / motor, loop.moving_mass() / motor;
  rate.row(3) << k / handle, d / handle, -(k + loop.hand.stiffness * T * T) / handle,
      -(d + loop.hand.damping * T) / handle, 0.0;
  return rate;
}

/// Returns the matrix A of the motion dz/ds = A z, where s is time in periods, z = (x, T v, T^2/m f) and the force
/// f is constant. All matrices in this file have dynamic sizes, so that the compiler instantiates the matrix
/// exponential only once.
Eigen::MatrixXd motion_rate(const SampledLoop& loop) {
  if (loop.device.transmission) return elastic_motion_rate(loop, *loop.device.transmission);
  const double m = loop.moving_mass(), T = loop.period;
  Eigen::MatrixXd rate = Eigen::MatrixXd::Zero(3, 3);
  rate(0, 1) = 1.0;
  rate.row(1) << -loop.hand.stiffness * T * T / m, -loop.total_damping() * T / m, 1.0;
  return rate;
}

/// Writes the motion over one period into the rows of the map A that belong to the state components `body`. The
/// force is `before` for the fraction `fraction` of the period and `after` for the rest; both are row vectors over
/// the state.
void add_motion(Eigen::MatrixXd& A, const std::vector<Eigen::Index>& body, double fraction, const Eigen::MatrixXd& rate,
                const Eigen::RowVectorXd& before, const Eigen::RowVectorXd& after) {
  const auto n = static_cast<Eigen::Index>(body.size());
  const Eigen::MatrixXd first = (rate * fraction).exp(), second = (rate * (1.0 - fraction)).exp();
  Eigen::MatrixXd moving = Eigen::MatrixXd::Zero(n, A.cols());
  for (Eigen::Index i = 0; i < n; ++i) moving.col(body[static_cast<std::size_t>(i)]) = first.col(i).head(n);
  if (fraction > 0.0) moving += first.col(n).head(n) * before;
  const Eigen::MatrixXd next = second.topLeftCorner(n, n) * moving + second.col(n).head(n) * after;
  for (Eigen::Index i = 0; i < n; ++i) A.row(body[static_cast<std::size_t>(i)]) = next.row(i);
}

/// Return the modes of the low-pass filter of the velocity, and of the position; empty if there is no such filter.
std::vector<LowPassMode> velocity_modes(const SampledLoop& loop) {
  const auto* filter = std::get_if<LowPassFilter>(&loop.device.velocity_filter);
  return filter != nullptr ? low_pass_modes(*filter, loop.period) : std::vector<LowPassMode>{};
}

std::vector<LowPassMode> position_modes(const SampledLoop& loop) {
  const auto& filter = loop.device.position_filter;
  return filter ? low_pass_modes(*filter, loop.period) : std::vector<LowPassMode>{};
}

}  // namespace

const char* SampledLoop::nonlinearity() const {
  if (device.coulomb > 0.0 || device.encoder_step > 0.0 || device.force_step > 0.0)
    return "dry friction and the steps of encoder and force are not linear";
  if (std::holds_alternative<AdaptiveWindowFilter>(device.velocity_filter))
    return "a velocity filter of type adaptive_window is not linear";
  return nullptr;
}

Eigen::MatrixXd SampledLoop::state_matrix() const {
  const double T = period, m = moving_mass(), delay = device.delay_samples;
  const Eigen::Index whole = static_cast<Eigen::Index>(std::floor(delay));
  const double part = delay - static_cast<double>(whole);
  const Eigen::Index kept = whole + (part > 0.0 ? 1 : 0);
  // Count the state components of filters, delayed forces and transmission.
  std::vector<LowPassMode> velocity = velocity_modes(*this);
  if (velocity.empty()) velocity.push_back({1.0, 1.0});
  const std::vector<LowPassMode> position = position_modes(*this);
  const auto states_of = [](const std::vector<LowPassMode>& modes) {
    return std::accumulate(modes.begin(), modes.end(), Eigen::Index{0},
                           [](Eigen::Index sum, const LowPassMode& mode) { return sum + (is_pair(mode) ? 2 : 1); });
  };
  const Eigen::Index forces = kModes + states_of(velocity) + states_of(position);
  const Eigen::Index n = forces + kept + (device.transmission ? 2 : 0);
  const auto unit = [n](Eigen::Index i) -> Eigen::RowVectorXd { return Eigen::RowVectorXd::Unit(n, i); };
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, n);

  // Adds a filter with the input `u` to A, in the next free state components. Returns its output as a row vector.
  Eigen::Index next = kModes;
  const auto filtered = [&](const std::vector<LowPassMode>& modes, const Eigen::RowVectorXd& u) {
    Eigen::RowVectorXd output = Eigen::RowVectorXd::Zero(n);
    for (const LowPassMode& mode : modes) {
      const Eigen::Index at = next;
      next += is_pair(mode) ? 2 : 1;
      const double gain = mode.gain.real(), gain_imaginary = mode.gain.imag();
      A.row(at) = (1.0 - gain) * unit(at) + (gain * mode.residue.real() - gain_imaginary * mode.residue.imag()) * u;
      if (is_pair(mode)) {
        A.row(at) += gain_imaginary * unit(at + 1);
        A.row(at + 1) = (1.0 - gain) * unit(at + 1) - gain_imaginary * unit(at) +
                        (gain * mode.residue.imag() + gain_imaginary * mode.residue.real()) * u;
      }
      output += A.row(at);
    }
    return output;
  };
  // The wall's force as a row vector over the state.
  const Eigen::RowVectorXd measured = unit(kPosition);
  A.row(kLastPosition) = measured;
  Eigen::RowVectorXd force = -(wall_damping * T / m) * filtered(velocity, measured - unit(kLastPosition));
  force -= stiffness * T * T / m * (position.empty() ? measured : filtered(position, measured));
  // Returns the force rendered `age` samples ago.
  const auto force_of = [&](Eigen::Index age) -> Eigen::RowVectorXd {
    return age == 0 ? force : unit(forces + age - 1);
  };

  // Motion over the period under the delayed forces, then shift of the delay line.
  const Eigen::RowVectorXd before = part > 0.0 ? force_of(whole + 1) : Eigen::RowVectorXd();
  std::vector<Eigen::Index> body = {kPosition, kVelocity};
  if (device.transmission) body.insert(body.end(), {n - 2, n - 1});
  add_motion(A, body, part, motion_rate(*this), before, force_of(whole));
  for (Eigen::Index age = 0; age < kept; ++age) A.row(forces + age) = force_of(age);
  return A;
}

double linear_stability_limit(SampledLoop loop) {
  const double unit = loop.moving_mass() / (loop.period * loop.period);
  return first_stability_limit(kMinLimit * unit, kMaxLimit * unit, [&loop](double K) {
    loop.stiffness = K;
    return loop.state_matrix();
  });
}

std::span<const AttachedHand> typical_hands() {
  static constexpr AttachedHand kHands[] = {{},           {0.1, 100.0},  {0.1, 300.0}, {0.1, 1000.0}, {0.2, 100.0},
                                            {0.2, 300.0}, {0.2, 1000.0}, {0.5, 100.0}, {0.5, 300.0},  {0.5, 1000.0}};
  return kHands;
}

double worst_hand_stability_limit(SampledLoop loop) {
  double smallest = kInfinity;
  for (const AttachedHand& hand : typical_hands()) {
    loop.hand = hand;
    smallest = std::min(smallest, linear_stability_limit(loop));
  }
  return smallest;
}

/// Returns the map of one step of carriage and handle by the implicit midpoint rule (HandleMechanics). The columns
/// belong to the state (x_c, v_c, x_h, v_h) and to constant forces on carriage and handle.
static Eigen::MatrixXd mechanics_step(const HandleMechanicsConfig& m, double dt) {
  const double k = m.structure_stiffness, c = m.structure_damping;
  Eigen::MatrixXd rate(4, 4);
  rate << 0, 1, 0, 0,                                                                                       //
      -k / m.carriage_mass, -(c + m.friction) / m.carriage_mass, k / m.carriage_mass, c / m.carriage_mass,  //
      0, 0, 0, 1,                                                                                           //
      k / m.handle_mass, c / m.handle_mass, -k / m.handle_mass, -c / m.handle_mass;
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(4, 6);
  right.leftCols(4) = Eigen::MatrixXd::Identity(4, 4) + 0.5 * dt * rate;
  right(1, 4) = dt / m.carriage_mass;
  right(3, 5) = dt / m.handle_mass;
  return (Eigen::MatrixXd::Identity(4, 4) - 0.5 * dt * rate).partialPivLu().solve(right);
}

Eigen::MatrixXd AdmittanceLoop::state_matrix() const {
  // Indices of the state.
  enum { kTool, kToolVelocity, kCarriage, kCarriageVelocity, kHandle, kHandleVelocity, kCommands };
  const auto delay = static_cast<Eigen::Index>(servo.delay);
  const Eigen::Index n = kCommands + delay;
  const auto unit = [n](Eigen::Index i) -> Eigen::RowVectorXd { return Eigen::RowVectorXd::Unit(n, i); };

  // Virtual mass under the forces of hand and wall.
  const Eigen::RowVectorXd hand = -hand_stiffness * unit(kHandle) - hand_damping * unit(kHandleVelocity);
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, n);
  A.block<2, 2>(kTool, kTool) = tool.step_matrix();
  A.middleRows<2>(kTool) += tool.input_step() * hand;

  // Carriage and handle under the delayed servo force and the hand's force.
  const Eigen::RowVectorXd command = servo.stiffness * (A.row(kTool) - unit(kCarriage)) +
                                     servo.damping * (A.row(kToolVelocity) - unit(kCarriageVelocity));
  const Eigen::RowVectorXd actuator = delay == 0 ? command : unit(kCommands + delay - 1);
  const Eigen::MatrixXd mechanics_of = mechanics_step(mechanics, tool.dt);
  A.block<4, 4>(kCarriage, kCarriage) = mechanics_of.leftCols(4);
  A.middleRows<4>(kCarriage) += mechanics_of.col(4) * actuator + mechanics_of.col(5) * hand;

  for (Eigen::Index i = 0; i < delay; ++i) A.row(kCommands + i) = i == 0 ? command : unit(kCommands + i - 1);

  // Scale all components to metres.
  Eigen::VectorXd scale = Eigen::VectorXd::Ones(n);
  for (const Eigen::Index velocity : {kToolVelocity, kCarriageVelocity, kHandleVelocity}) scale[velocity] = tool.dt;
  scale.tail(delay).setConstant(tool.dt * tool.dt / tool.M);
  return scale.asDiagonal() * A * scale.cwiseInverse().asDiagonal();
}

namespace {

// The passivity conditions hold for every passive hand, and an elastic transmission counts as part of the hand. The
// other conditions assume a single mass.

/// Returns true if neither position nor velocity is filtered by a low-pass. An adaptive window, which is not
/// linear, counts as the plain difference.
bool differentiates(const SampledLoop& loop) {
  return velocity_modes(loop).empty() && !loop.device.position_filter;
}

std::optional<double> colgate_schenkel(const SampledLoop& loop) {
  if (loop.device.delay_samples != 0.0 || !differentiates(loop)) return std::nullopt;
  return std::max(0.0, 2.0 * (loop.device.viscous - std::abs(loop.wall_damping)) / loop.period);
}

/// Coefficients of the passivity condition b > K p + B r at one angle theta = omega T. With e = exp(-j theta) and
/// the filters F of the velocity and G of the position:
///
///   p = T/2 Re{(1 - e) G e^d} / (1 - cos theta),   r = 1/2 Re{(1 - e)^2 F e^d} / (1 - cos theta)
struct PassivityAt {
  double p, r;
};

PassivityAt passivity_at(const SampledLoop& loop, double theta) {
  const double d = loop.device.delay_samples, full_delay_angle = (d + 1.0) * theta,
               half_delay_angle = (d + 0.5) * theta;
  const auto response = [theta](const std::vector<LowPassMode>& modes) {
    std::complex<double> sum = modes.empty() ? 1.0 : 0.0;
    for (const LowPassMode& mode : modes) sum += mode.response(theta);
    return sum;
  };
  const std::complex<double> F = response(velocity_modes(loop)), G = response(position_modes(loop));
  // Uses 1 - e = 2 j sin(theta/2) e^(1/2) and (1 - e)^2 = -2 (1 - cos theta) e
  return {loop.period * (G.real() * math::sin(half_delay_angle) - G.imag() * math::cos(half_delay_angle)) /
              (2.0 * math::sin(0.5 * theta)),
          -(F.real() * math::cos(full_delay_angle) + F.imag() * math::sin(full_delay_angle))};
}

/// Returns the smallest value of f between two angles: evaluates a grid, then refines it eight times around the
/// best point.
template <class Function>
double minimum(Function f, double low, double high, int points) {
  double smallest = kInfinity;
  for (int zoom = 0; zoom < 8; ++zoom) {
    const double step = (high - low) / points;
    double best = low;
    for (int i = 0; i <= points; ++i) {
      const double at = low + step * i, value = f(at);
      if (value < smallest) smallest = value, best = at;
    }
    low = std::max(low, best - step);
    high = std::min(high, best + step);
    points = 16;
  }
  return smallest;
}

/// Passivity with a delay: the condition gives an upper bound of K at angles where p > 0, and a lower bound where p <
/// 0.
std::optional<double> passive_with_delay(const SampledLoop& loop) {
  const double d = loop.device.delay_samples;
  if (d != std::floor(d)) return std::nullopt;
  const auto bound = [&loop](double theta, bool above) {
    const auto [p, r] = passivity_at(loop, theta);
    return (above ? p > 0.0 : p < 0.0) ? (loop.device.viscous - loop.wall_damping * r) / std::abs(p) : kInfinity;
  };
  constexpr double kFirst = 1e-6;  // starts above 0, where the formula is 0 / 0; the function is even and smooth there
  const int points = 256 * (1 + static_cast<int>(d));
  const double highest = minimum([&](double t) { return bound(t, true); }, kFirst, std::numbers::pi, points);
  const double lowest = -minimum([&](double t) { return bound(t, false); }, kFirst, std::numbers::pi, points);
  return highest > std::max(0.0, lowest) ? highest : 0.0;
}

std::optional<double> gil_hulin(const SampledLoop& loop) {
  constexpr double kLowDamping = 0.15;
  const double damping = loop.total_damping() + loop.wall_damping;
  const double delay = loop.period * (1.0 + loop.device.delay_samples);
  if (loop.device.transmission || !differentiates(loop) || damping * delay / loop.moving_mass() > kLowDamping)
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
  if (loop.device.transmission || !bare || loop.device.delay_samples != 0.0 || !differentiates(loop))
    return std::nullopt;
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
         "derived for this wall from the general condition of Colgate and Schenkel; F is the velocity filter, and "
         "includes a filter of the position",
     .applies = "whole delays; passive for every passive hand",
     .largest = passive_with_delay},
    {.name = "stable_gil_hulin",
     .formula = "K < (b + B) / (T/2 + t_d), b with the hand's",
     .source = "J. J. Gil, E. Sanchez, T. Hulin, C. Preusche, G. Hirzinger, J. Comput. Inf. Sci. Eng. 9(1), 2009",
     .applies =
         "an approximation for low damping and short delays, (b + B)(T + t_d) / m <= 0.15 (there at most 14 % above "
         "the exact limit); velocity by the difference",
     .largest = gil_hulin},
    {.name = "passive_abbott_okamura",
     .formula = "K <= min(2 b / T, 2 c / q)",
     .source = "J. J. Abbott, A. M. Okamura, Effects of position quantization and sampling rate on virtual-wall "
               "passivity, IEEE T-RO 21(5), 2005",
     .applies = "no delay, B = 0, an encoder step q > 0",
     .largest = abbott_okamura},
    {.name = "exact_undamped_handle",
     .formula = "K T^2/m < 2 beta (2 - beta) / (2 + beta), beta = B T/m",
     .source = "derived",
     .applies = "no delay, velocity by the difference, no damping of handle and hand, no spring of the hand",
     .largest = undamped_handle},
};

}  // namespace

std::span<const StiffnessLimit> stiffness_limits() {
  return kLimits;
}

}  // namespace hapbench
