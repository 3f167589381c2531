#include "algorithms/six_dof/devices.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "algorithms/depth/depth_model.hpp"
#include "algorithms/proxy/turning_proxy.hpp"
#include "algorithms/registry.hpp"
#include "algorithms/six_dof/turns.hpp"
#include "sim/tool/orientation.hpp"

namespace hapbench::six_dof {
namespace {

constexpr int kMaxPasses = 100;
constexpr int kMaxNewtonSteps = 60;
/// Largest number of sub-steps into which a step of the hand's intended pose (Intent) is divided.
constexpr double kMaxSubsteps = 64.0;
/// Newton's method stops when the imbalance between hand and device [N] is at most this value. A law with a memory
/// counts as converged when this imbalance changes by at most this value [N] between two calls at the same pose. The
/// rounding error of a force of 20 000 N/m times 10 mm is 1e-13 N.
constexpr double kExact = 1e-11;
/// Change of the force for difference quotients [N]. It moves the handle by 20 nm if the hand has a stiffness of 500
/// N/m.
constexpr double kForceStep = 1e-5;
/// Smallest fraction of a Newton step that the line search tries.
constexpr double kSmallestStep = 1.0 / 1024.0;

/// Limits for a law with a memory. kMaxSettling: largest number of repeated calls at one pose. kStillMoves: if the line
/// search fails, the iteration continues only if repeated calls reduce the imbalance between hand and device to less
/// than this fraction of its value before the line search.
constexpr int kMaxSettling = 20;
constexpr double kStillMoves = 0.5;

double in_series(double a, double b) noexcept {
  return std::isinf(b) ? a : std::isinf(a) ? b : a * b / (a + b);
}

}  // namespace

double HandAndCoupling::matched_rotation() const noexcept {
  return in_series(coupling_rotation, hand_rotation);
}

SixDofDevice::SixDofDevice(const PointShell& shell, const ToolShape& tool, const HandAndCoupling& springs, Skips skips)
    : springs_(springs), equilibrium_(shell, tool, springs.force_point, skips), jump_(kJump * tool.half_width()) {}

void SixDofDevice::reset() noexcept {
  equilibrium_.reset();
  starts_ = was_solved_ = true;
}

PoseSprings SixDofDevice::springs_at(const Intent& intent) const noexcept {
  return {.stiffness = in_series(springs_.coupling, springs_.hand),
          .coupling_rotation = springs_.coupling_rotation,
          .hand_rotation = springs_.hand_rotation,
          .grip = springs_.grip,
          .grip_target = intent.grip,
          .target = intent.orientation};
}

void SixDofDevice::follow_in_parts(const Intent& intent, int bisections, Step& step) noexcept {
  const CoupledPose before = tool_;
  const auto outcome = equilibrium_.solve(springs_at(intent), tool_, kMaxPasses);
  const bool far = outcome.moved > jump_;
  if (outcome.solved && !(far && bisections > 0)) {
    step.jumped |= far;
    step.solved = true;
    step.residual = std::max(step.residual, outcome.residual);
    intent_ = intent;
    return;
  }
  if (bisections == 0) {
    step.solved = false;
    intent_ = intent;
    return;
  }
  // Bisect the step of the intent: first follow its first half.
  tool_ = before;
  const Intent half{0.5 * (intent_.grip + intent.grip),
                    turned(intent_.orientation, 0.5 * turn_between(intent_.orientation, intent.orientation))};
  follow_in_parts(half, bisections - 1, step);
  follow_in_parts(intent, bisections - 1, step);
}

SixDofDevice::Step SixDofDevice::follow(const Intent& intent) noexcept {
  Step step;
  if (starts_) {
    starts_ = false;
    intent_ = intent;
    tool_ = relaxed(springs_at(intent));
  }
  follow_in_parts(intent, was_solved_ ? kBisections : 0, step);
  was_solved_ = step.solved;
  const PoseSprings springs = springs_at(intent);
  handle_.force = spring_force(springs, tool_);
  handle_.torque = spring_torque(springs, tool_);
  handle_.orientation = tool_.handle;
  handle_.position = intent.grip - springs_.grip * tool_.handle_axis() + handle_.force / springs_.hand;
  return step;
}

ThreeDofDevice::ThreeDofDevice(const PointShell& shell, const ToolShape& tool, const HandAndCoupling& springs,
                               const RenderingConfig& config, double dt)
    : tool_(&tool),
      springs_(springs),
      source_(std::make_unique<ShellSource>(shell, tool, make_contact_query(shell, tool, config.skips),
                                            make_depth_model(config), config.skips)),
      law_(turns(config) ? make_turning_proxy(config, springs.force_point) : make_algorithm(config)),
      contacts_(source_->capacity()),
      step_(kJump * tool.half_width()) {
  law_->prepare({.capacity = contacts_.capacity(), .tool = &tool, .shell = &shell, .dt = dt});
}

void ThreeDofDevice::reset() noexcept {
  source_->reset();
  law_->reset();
  handle_ = {};
  starts_ = true;
}

/// Places the handle in the equilibrium of the hand under a given force of the device.
void ThreeDofDevice::place(const Intent& intent, const Vec3& force) noexcept {
  Vec3 yield = Vec3::Zero();
  Vec3 axis = axis_of(intent.orientation);
  if (springs_.grip != 0.0) {
    // The moment of the force about the grip depends on the rotation that it causes, so the rotation is found by
    // iteration. Each iteration reduces the error by the factor |c f| / K_phi.
    for (int i = 0; i < kMaxNewtonSteps; ++i) {
      const Vec3 next = -springs_.grip / springs_.hand_rotation * axis.cross(force);
      const double change = (next - yield).norm();
      yield = next;
      axis = axis_of(turned(intent.orientation, yield));
      if (change < 1e-15) break;
    }
  }
  handle_.orientation = turned(intent.orientation, yield);
  handle_.position = intent.grip + force / springs_.hand - springs_.grip * axis;
}

/// Places the handle where the hand balances `force`. Returns the force that the device renders there, minus `force`
/// [N].
Vec3 ThreeDofDevice::unbalanced(const Intent& intent, const Vec3& force) noexcept {
  place(intent, force);
  ToolState tool;
  tool.pose.axis = axis_of(handle_.orientation);
  tool.pose.position = handle_.position + springs_.force_point * tool.pose.axis;
  if (!tool_->is_axisymmetric()) tool.pose.roll = roll_of(handle_.orientation);
  source_->contacts_at(tool.pose, contacts_);
  RenderedForce rendered;
  law_->compute(tool, contacts_, rendered);
  handle_.force = rendered.spring;
  return rendered.spring - force;
}

/// Repeats unbalanced() until a law with a memory, such as a proxy, has converged at this pose, at most kMaxSettling
/// times. Returns the last result [N].
Vec3 ThreeDofDevice::settled(const Intent& intent, const Vec3& force) noexcept {
  Vec3 rest = unbalanced(intent, force);
  for (int i = 0; i < kMaxSettling; ++i) {
    const Vec3 next = unbalanced(intent, force);
    const bool still = (next - rest).norm() <= kExact;
    rest = next;
    if (still) break;
  }
  return rest;
}

double ThreeDofDevice::follow(const Intent& intent) noexcept {
  if (starts_) from_ = intent;
  starts_ = false;
  // Short sub-steps, in which no point of the tool moves far, keep a law with a memory near its previous equilibrium.
  const Vec3 turn = turn_between(from_.orientation, intent.orientation);
  const double far = (intent.grip - from_.grip).norm() + (tool_->reach() + springs_.force_point) * turn.norm();
  const double steps = std::clamp(std::ceil(far / step_), 1.0, kMaxSubsteps);
  double rest = 0.0;
  for (double k = 1.0; k <= steps; k += 1.0) {
    const double t = k / steps;
    rest = balance(k == steps ? intent
                              : Intent{(1.0 - t) * from_.grip + t * intent.grip, turned(from_.orientation, t * turn)});
  }
  from_ = intent;
  return rest;
}

/// Finds the equilibrium for one intent. Returns the remaining imbalance between hand and device [N].
double ThreeDofDevice::balance(const Intent& intent) noexcept {
  Vec3 force = handle_.force;
  Vec3 rest = settled(intent, force);
  for (int i = 0; i < kMaxNewtonSteps && rest.norm() > kExact; ++i) {
    Mat3 jacobian;
    for (int k = 0; k < 3; ++k)
      jacobian.col(k) = (unbalanced(intent, force + kForceStep * Vec3::Unit(k)) - rest) / kForceStep;
    Vec3 newton = -jacobian.partialPivLu().solve(rest);
    if (const double longest = springs_.hand * step_; newton.norm() > longest) newton *= longest / newton.norm();
    // Shorten the step until it reduces the imbalance between hand and device.
    double step = 1.0;
    Vec3 next = unbalanced(intent, force + newton);
    while (!(next.norm() < rest.norm()) && step > kSmallestStep) {
      step *= 0.5;
      next = unbalanced(intent, force + step * newton);
    }
    if (next.norm() < rest.norm()) {
      force += step * newton;
      rest = next;
      continue;
    }
    // If the line search fails, its calls may have changed the memory of the law. Continue with the changed memory if
    // it reduces the imbalance enough.
    next = settled(intent, force);
    if (!(next.norm() < kStillMoves * rest.norm())) break;
    rest = next;
  }
  unbalanced(intent, force);
  return rest.norm();
}

}  // namespace hapbench::six_dof
