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

/// Range of K T^2 / m (dimensionless) in which linear_stability_limit() searches. Below this range, the eigenvalues are
/// so close to 1 that rounding decides whether the loop counts as stable.
constexpr double kMinLimit = 1e-8;
constexpr double kMaxLimit = 1e6;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Indices of a SampledLoop's state.
enum { kPosition, kVelocity, kLastPosition, kModes };

/// Returns true if the mode belongs to a pair of complex poles.
bool is_pair(const LowPassMode& mode) {
  return mode.gain.imag() != 0.0;
}

/// Returns true if a sampled hand holds the handle.
bool has_sampled_hand(const SampledLoop& loop) {
  return loop.sampled_stiffness != 0.0 || loop.sampled_damping != 0.0;
}

/// Returns the matrix of motion_rate() for a device with an elastic transmission. The components of z are x and T v of
/// the motors, x and T v of the handle, and the scaled forces: T^2/m f on the motors and, with a sampled hand, T^2/m
/// f_hand on the handle.
Eigen::MatrixXd elastic_motion_rate(const SampledLoop& loop, const Transmission& transmission) {
  const double T = loop.period, motor = transmission.motor_share * loop.device.handle_mass,
               handle = loop.moving_mass() - motor, k = transmission.stiffness * T * T, d = transmission.damping * T;
  const Eigen::Index n = has_sampled_hand(loop) ? 6 : 5;
  Eigen::MatrixXd rate = Eigen::MatrixXd::Zero(n, n);
  rate(0, 1) = rate(2, 3) = 1.0;
  rate.row(1).head(5) << -k / motor, -(d + loop.device.viscous * T) / motor, k / motor, d / motor,
      loop.moving_mass() / motor;
  rate.row(3).head(5) << k / handle, d / handle, -(k + loop.hand.stiffness * T * T) / handle,
      -(d + loop.hand.damping * T) / handle, 0.0;
  if (n == 6) rate(3, 5) = loop.moving_mass() / handle;
  return rate;
}

/// Returns the matrix A of the motion dz/ds = A z, where s is time in periods, z = (x, T v, T^2/m f) and the force
/// f is constant. With a sampled hand, its constant force gives one more component, T^2/m f_hand. The sizes of the
/// matrices in this file are dynamic, so that the compiler instantiates the matrix exponential only once.
Eigen::MatrixXd motion_rate(const SampledLoop& loop) {
  if (loop.device.transmission) return elastic_motion_rate(loop, *loop.device.transmission);
  const double m = loop.moving_mass(), T = loop.period;
  const Eigen::Index n = has_sampled_hand(loop) ? 4 : 3;
  Eigen::MatrixXd rate = Eigen::MatrixXd::Zero(n, n);
  rate(0, 1) = 1.0;
  rate.row(1).head(3) << -loop.hand.stiffness * T * T / m, -loop.total_damping() * T / m, 1.0;
  if (n == 4) rate(1, 3) = 1.0;
  return rate;
}

/// Writes the motion over one period into the rows of the map A that belong to the state components `body`. The
/// force is `before` for the fraction `fraction` of the period and `after` for the rest. `hand` is the force of a
/// sampled hand over the whole period; it is empty if no sampled hand holds the handle. Each force is given as the row
/// vector whose product with the state is the force.
void add_motion(Eigen::MatrixXd& A, const std::vector<Eigen::Index>& body, double fraction, const Eigen::MatrixXd& rate,
                const Eigen::RowVectorXd& before, const Eigen::RowVectorXd& after, const Eigen::RowVectorXd& hand) {
  const auto n = static_cast<Eigen::Index>(body.size());
  const Eigen::MatrixXd first = (rate * fraction).exp(), second = (rate * (1.0 - fraction)).exp();
  Eigen::MatrixXd moving = Eigen::MatrixXd::Zero(n, A.cols());
  for (Eigen::Index i = 0; i < n; ++i) moving.col(body[static_cast<std::size_t>(i)]) = first.col(i).head(n);
  if (fraction > 0.0) moving += first.col(n).head(n) * before;
  if (hand.size() > 0) moving += first.col(n + 1).head(n) * hand;
  Eigen::MatrixXd next = second.topLeftCorner(n, n) * moving + second.col(n).head(n) * after;
  if (hand.size() > 0) next += second.col(n + 1).head(n) * hand;
  for (Eigen::Index i = 0; i < n; ++i) A.row(body[static_cast<std::size_t>(i)]) = next.row(i);
}

/// Returns the modes of the low-pass filter of the velocity; empty without this filter.
std::vector<LowPassMode> velocity_modes(const SampledLoop& loop) {
  const auto* filter = std::get_if<LowPassFilter>(&loop.device.velocity_filter);
  return filter != nullptr ? low_pass_modes(*filter, loop.period) : std::vector<LowPassMode>{};
}

/// Returns the modes of the position filter; empty without this filter.
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

// NOLINTNEXTLINE(readability-function-cognitive-complexity): one block of rows after the other, as in the comments.
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

  // Adds a filter to A, in the next free state components. The filter's input and output are products of row vectors
  // with the state. `u` is the row vector of the input. Returns the row vector of the output.
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
  // Compute the row vector whose product with the state is the wall's force.
  const Eigen::RowVectorXd measured = unit(kPosition);
  A.row(kLastPosition) = measured;
  Eigen::RowVectorXd force = -(wall_damping * T / m) * filtered(velocity, measured - unit(kLastPosition));
  force -= stiffness * T * T / m * (position.empty() ? measured : filtered(position, measured));
  // Returns the force rendered `age` samples ago.
  const auto force_of = [&](Eigen::Index age) -> Eigen::RowVectorXd {
    return age == 0 ? force : unit(forces + age - 1);
  };

  // Add the motion over the period under the delayed forces, then shift the delay line.
  const Eigen::RowVectorXd before = part > 0.0 ? force_of(whole + 1) : Eigen::RowVectorXd();
  std::vector<Eigen::Index> body = {kPosition, kVelocity};
  if (device.transmission) body.insert(body.end(), {n - 2, n - 1});
  Eigen::RowVectorXd sampled_hand;
  if (has_sampled_hand(*this)) {
    const Eigen::Index handle = device.transmission ? n - 2 : Eigen::Index{kPosition};
    sampled_hand = -(sampled_stiffness * T * T / m) * unit(handle) - (sampled_damping * T / m) * unit(handle + 1);
  }
  add_motion(A, body, part, motion_rate(*this), before, force_of(whole), sampled_hand);
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
  loop.sampled_stiffness = loop.sampled_damping = 0.0;
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

/// Motion of the virtual mass over one step in d dimensions: the matrices by which the next state (x, v) depends on the
/// current state and on a held force [N].
struct ToolStep {
  Eigen::MatrixXd state;  ///< 2 d x 2 d
  Eigen::MatrixXd force;  ///< 2 d x d
};

/// Returns the state matrix of an admittance device in d dimensions. The state has d components for each component of
/// the state of AdmittanceLoop::state_matrix(). `hand_stiffness` [N/m], `hand_damping` [N s/m]: linearised force of the
/// hand. `input`: derivative of the force that drives the virtual mass with respect to the hand's force. These three
/// matrices are d x d.
static Eigen::MatrixXd admittance_matrix(const AdmittanceLoop& loop, const ToolStep& tool,
                                         const Eigen::MatrixXd& hand_stiffness, const Eigen::MatrixXd& hand_damping,
                                         const Eigen::MatrixXd& input) {
  // Indices of the state, in blocks of d.
  enum { kTool, kToolVelocity, kCarriage, kCarriageVelocity, kHandle, kHandleVelocity, kCommands };
  const auto delay = static_cast<Eigen::Index>(loop.servo.delay);
  const Eigen::Index d = input.rows(), n = kCommands + delay;
  const auto unit = [n, d](Eigen::Index i) -> Eigen::MatrixXd {
    Eigen::MatrixXd block = Eigen::MatrixXd::Zero(d, n * d);
    block.middleCols(i * d, d).setIdentity();
    return block;
  };
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n * d, n * d);
  const auto rows = [&A, d](Eigen::Index i) { return A.middleRows(i * d, d); };

  // Write the rows of the virtual mass under the forces of hand and wall.
  const Eigen::MatrixXd hand = -hand_stiffness * unit(kHandle) - hand_damping * unit(kHandleVelocity);
  A.block(kTool * d, kTool * d, 2 * d, 2 * d) = tool.state;
  A.middleRows(kTool * d, 2 * d) += tool.force * (input * hand);

  // Write the rows of carriage and handle under the delayed servo force and the hand's force.
  const Eigen::MatrixXd command = loop.servo.stiffness * (rows(kTool) - unit(kCarriage)) +
                                  loop.servo.damping * (rows(kToolVelocity) - unit(kCarriageVelocity));
  const Eigen::MatrixXd actuator = delay == 0 ? command : unit(kCommands + delay - 1);
  const Eigen::MatrixXd mechanics = mechanics_step(loop.mechanics, loop.tool.dt);
  for (Eigen::Index i = 0; i < 4; ++i) {
    for (Eigen::Index j = 0; j < 4; ++j) rows(kCarriage + i) += mechanics(i, j) * unit(kCarriage + j);
    rows(kCarriage + i) += mechanics(i, 4) * actuator + mechanics(i, 5) * hand;
  }
  for (Eigen::Index i = 0; i < delay; ++i) rows(kCommands + i) = i == 0 ? command : unit(kCommands + i - 1);

  // Scale all components to metres.
  Eigen::VectorXd scale = Eigen::VectorXd::Ones(n * d);
  for (const Eigen::Index velocity : {kToolVelocity, kCarriageVelocity, kHandleVelocity})
    scale.segment(velocity * d, d).setConstant(loop.tool.dt);
  scale.tail(delay * d).setConstant(loop.tool.dt * loop.tool.dt / loop.tool.M);
  return scale.asDiagonal() * A * scale.cwiseInverse().asDiagonal();
}

Eigen::MatrixXd AdmittanceLoop::state_matrix() const {
  const auto scalar = [](double value) -> Eigen::MatrixXd { return Eigen::MatrixXd::Constant(1, 1, value); };
  return admittance_matrix(*this, {tool.step_matrix(), tool.input_step()}, scalar(hand_stiffness), scalar(hand_damping),
                           scalar(1.0));
}

namespace {

/// Returns the Kronecker product of A with a 3 x 3 matrix: three components for each component of the state.
Eigen::MatrixXd in_three_axes(const Eigen::MatrixXd& A, const Mat3& of_axes) {
  Eigen::MatrixXd product(3 * A.rows(), 3 * A.cols());
  for (Eigen::Index i = 0; i < A.rows(); ++i)
    for (Eigen::Index j = 0; j < A.cols(); ++j) product.block<3, 3>(3 * i, 3 * j) = A(i, j) * of_axes;
  return product;
}

/// Returns the map of one step of the virtual mass under a linear contact.
ToolStep tool_step(const SpringDamper& tool, const LinearContact& contact) {
  const Eigen::Matrix<double, 6, 9> map = step_map(*tool.integrator, tool.M, tool.dt, contact.rendered);
  return {map.leftCols<6>(), map.rightCols<3>()};
}

/// Returns the block of a state matrix in three dimensions with the rows that belong to `row_axis` and the columns that
/// belong to `column_axis`.
Eigen::MatrixXd part_of_axes(const Eigen::MatrixXd& A, Eigen::Index row_axis, Eigen::Index column_axis) {
  const Eigen::Index n = A.rows() / 3;
  Eigen::MatrixXd part(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < n; ++j) part(i, j) = A(3 * i + row_axis, 3 * j + column_axis);
  return part;
}

/// Returns true if axes drive each other in both directions, directly or through the third axis.
bool has_feedback_between_axes(const Eigen::MatrixXd& A) {
  constexpr double kNegligible = 1e-9;  // the derivatives of a rendered force are known to about 1e-8
  Eigen::Matrix3i drives;
  for (Eigen::Index i = 0; i < 3; ++i)
    for (Eigen::Index j = 0; j < 3; ++j)
      drives(i, j) = i != j && part_of_axes(A, i, j).cwiseAbs().maxCoeff() > kNegligible;
  const Eigen::Matrix3i twice = drives * drives;
  return twice.trace() > 0 || (twice * drives).trace() > 0;
}

/// Returns matrices that together have the eigenvalues of A, a state matrix with three components for each component of
/// the state of one axis: one matrix for each axis in a frame without feedback between the axes, otherwise A itself.
std::vector<Eigen::MatrixXd> by_axes(const Eigen::MatrixXd& A, const LinearContact& contact) {
  constexpr Eigen::Index kMaxRows = 300;
  const auto& [rendered, hand, input] = contact;
  // Try these frames: the world frame, and the principal axes of the contact's stiffness and damping and of the hand's
  // damping.
  std::vector<Mat3> frames = {Mat3::Identity()};
  for (const Mat3& M : {rendered.stiffness, rendered.damping, hand.damping})
    frames.push_back(Eigen::SelfAdjointEigenSolver<Mat3>(M * M.transpose()).eigenvectors());
  for (const Mat3& Q : frames) {
    const Eigen::MatrixXd rotation = in_three_axes(Eigen::MatrixXd::Identity(A.rows() / 3, A.rows() / 3), Q);
    const Eigen::MatrixXd rotated = rotation.transpose() * A * rotation;
    if (has_feedback_between_axes(rotated)) continue;
    std::vector<Eigen::MatrixXd> axes;
    for (Eigen::Index i = 0; i < 3; ++i) {
      const auto acts = [&Q, i](const Mat3& M) {
        return std::abs((Q.transpose() * M * Q)(i, i)) > 1e-9 * M.cwiseAbs().maxCoeff();
      };
      if (acts(rendered.stiffness) || acts(rendered.damping) || acts(hand.stiffness) || acts(hand.damping))
        axes.push_back(part_of_axes(rotated, i, i));
    }
    return axes;
  }
  if (A.rows() > kMaxRows) return {};
  return {A};
}

}  // namespace

bool is_stable_loop(const std::vector<Eigen::MatrixXd>& loop) {
  constexpr double kNearOne = 1e-5, kTolerance = 1e-6, kRounding = 1e-13;
  return std::ranges::all_of(loop, [](const Eigen::MatrixXd& A) {
    const Eigen::VectorXcd all = eigenvalues(A);
    return std::ranges::all_of(all, [](const std::complex<double>& z) {
      return std::sqrt(std::norm(z)) <= 1.0 + (std::norm(z - 1.0) < kNearOne * kNearOne ? kTolerance : kRounding);
    });
  });
}

std::vector<Eigen::MatrixXd> contact_loop(const SampledLoop& loop, const LinearContact& contact) {
  // The map is an affine function of the four coefficients of wall and sampled hand. A stiffness of `unit`, or a
  // damping of `damping_unit`, changes entries of the map by about 1, so that the differences from the free map are
  // accurate.
  const double unit = loop.moving_mass() / (loop.period * loop.period), damping_unit = unit * loop.period;
  const auto map = [&loop](double K, double B, double k, double c) {
    SampledLoop at = loop;
    at.stiffness = K;
    at.wall_damping = B;
    at.sampled_stiffness = k;
    at.sampled_damping = c;
    return at.state_matrix();
  };
  const Eigen::MatrixXd free = map(0.0, 0.0, 0.0, 0.0);
  Eigen::MatrixXd A = in_three_axes(free, Mat3::Identity());
  A += in_three_axes(map(unit, 0.0, 0.0, 0.0) - free, contact.rendered.stiffness / unit);
  A += in_three_axes(map(0.0, damping_unit, 0.0, 0.0) - free, contact.rendered.damping / damping_unit);
  A += in_three_axes(map(0.0, 0.0, unit, 0.0) - free, contact.hand.stiffness / unit);
  A += in_three_axes(map(0.0, 0.0, 0.0, damping_unit) - free, contact.hand.damping / damping_unit);
  return by_axes(A, contact);
}

std::vector<Eigen::MatrixXd> contact_loop(const AdmittanceLoop& loop, const LinearContact& contact) {
  return by_axes(admittance_matrix(loop, tool_step(loop.tool, contact), contact.hand.stiffness, contact.hand.damping,
                                   contact.input),
                 contact);
}

std::vector<Eigen::MatrixXd> contact_loop(const SpringDamper& tool, const LinearContact& contact) {
  const auto [state, force] = tool_step(tool, contact);
  Eigen::MatrixXd hand(3, 6);
  hand << -contact.hand.stiffness, -contact.hand.damping;
  Eigen::MatrixXd A = state + force * (contact.input * hand);
  // Scale the velocities to metres.
  A.topRightCorner<3, 3>() /= tool.dt;
  A.bottomLeftCorner<3, 3>() *= tool.dt;
  return by_axes(A, contact);
}

namespace {

// The passivity conditions hold for every passive hand, and an elastic transmission counts as part of the hand. The
// other conditions assume a single mass.

/// Returns true if neither position nor velocity is filtered by a low-pass. An adaptive window, which is not linear, is
/// treated as the difference of positions without a filter.
bool differentiates(const SampledLoop& loop) {
  return velocity_modes(loop).empty() && !loop.device.position_filter;
}

std::optional<double> colgate_schenkel(const SampledLoop& loop) {
  if (loop.device.delay_samples != 0.0 || !differentiates(loop)) return std::nullopt;
  return std::max(0.0, 2.0 * (loop.device.viscous - std::abs(loop.wall_damping)) / loop.period);
}

/// Coefficients p and r of the passivity condition b > K p + B r at one angle theta = omega T. b is the viscous
/// friction of the handle, K and B are stiffness and damping of the wall, T is the period and d the delay in samples.
/// With e = exp(-j theta) and the transfer functions F of the velocity filter and G of the position filter:
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
  // The formulas follow from 1 - e = 2 j sin(theta/2) e^(1/2) and (1 - e)^2 = -2 (1 - cos theta) e.
  return {loop.period * (G.real() * math::sin(half_delay_angle) - G.imag() * math::cos(half_delay_angle)) /
              (2.0 * math::sin(0.5 * theta)),
          -(F.real() * math::cos(full_delay_angle) + F.imag() * math::sin(full_delay_angle))};
}

/// Returns the smallest value of f between the angles `low` and `high`. Evaluates f on eight grids. Each grid after the
/// first covers the neighbourhood of the angle at which the previous grids gave the smallest value.
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

/// Returns the largest passive K if the delay is a whole number of samples, otherwise nullopt. The passivity condition
/// gives an upper bound of K at angles where p > 0, and a lower bound where p < 0.
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
  if (loop.device.transmission || has_sampled_hand(loop) || !differentiates(loop) ||
      damping * delay / loop.moving_mass() > kLowDamping)
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
  const bool bare = loop.total_damping() == 0.0 && loop.hand.stiffness == 0.0 && !has_sampled_hand(loop);
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
     .applies = "no delay, velocity filter of type difference; passive for every passive hand",
     .largest = colgate_schenkel},
    {.name = "passive_with_delay",
     .formula = "b > max over theta of K T sin((d + 1/2) theta) / (2 sin(theta/2)) - B Re{F e^(-j (d + 1) theta)}",
     .source =
         "derived for this wall from the general condition of Colgate and Schenkel; F is the velocity filter, and "
         "includes a filter of the position",
     .applies = "delay of whole time steps; passive for every passive hand",
     .largest = passive_with_delay},
    {.name = "stable_gil_hulin",
     .formula = "K < (b + B) / (T/2 + t_d), where b includes the damping of the hand",
     .source = "J. J. Gil, E. Sanchez, T. Hulin, C. Preusche, G. Hirzinger, J. Comput. Inf. Sci. Eng. 9(1), 2009",
     .applies =
         "an approximation for low damping and short delays, (b + B)(T + t_d) / m <= 0.15, where it is at most 14 % "
         "above the exact limit; velocity filter of type difference",
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
     .applies = "no delay, velocity filter of type difference, no damping of handle and hand, no stiffness of the hand",
     .largest = undamped_handle},
};

}  // namespace

std::span<const StiffnessLimit> stiffness_limits() {
  return kLimits;
}

}  // namespace hapbench
