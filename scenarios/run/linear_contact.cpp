#include "scenarios/run/linear_contact.hpp"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "algorithms/stages/damping_and_limits.hpp"
#include "results/observe/contact_forces.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/scene_loop.hpp"
#include "sim/core/hash.hpp"
#include "sim/core/math.hpp"

namespace hapbench {
namespace {

// Position step of the central differences [m]: in usual scenarios, at most a ten-thousandth of the tool's width and of
// the penetration depth.
constexpr double kPositionStep = 1e-8;
constexpr double kVelocityStep = 1e-4;  // velocity step of the differences [m/s]; any step is right for linear dampers
// Estimated relative error of the differences. A matrix entry counts as zero if its ratio to the largest entry is at
// most this value.
constexpr double kRelativeError = 1e-7;

/// Returns the scenario without the parts that the linear theory leaves out.
Scenario without_nonlinear_parts(Scenario scenario) {
  scenario.rendering.dry_friction.reset();
  scenario.rendering.force_stage.reset();
  scenario.rendering.passivity_controller = false;
  if (auto* admittance = std::get_if<AdmittanceDeviceConfig>(&scenario.device)) admittance->sensor.noise = 0.0;
  return scenario;
}

/// Sets the entries of M to zero whose magnitude is at most kRelativeError times `largest`. Such entries may be errors
/// of the central differences.
Mat3 without_noise(const Mat3& M, double largest) {
  return (M.array().abs() > kRelativeError * largest).select(M, 0.0);
}

/// Returns true if the tool of a scene moves only in the plane z = 0, because the surface and the state `near` of a run
/// lie in this plane: no force along z ever arises.
bool stays_in_plane(const Scenario& scenario, const ContactState& near) {
  return std::holds_alternative<Hole2d>(scenario.environment) && near.pose.position.z() == 0.0 &&
         near.pose.axis.z() == 0.0;
}

/// Sets the derivatives with respect to z, and those of forces along z, to zero.
void remove_z(LinearContact& contact) {
  for (Mat3* M : {&contact.rendered.stiffness, &contact.rendered.damping, &contact.rendered.assumed.stiffness,
                  &contact.rendered.assumed.damping, &contact.hand.stiffness, &contact.hand.damping}) {
    M->row(2).setZero();
    M->col(2).setZero();
  }
}

/// Evaluates the forces, and their derivatives, on a tool that rests at a position.
class RestingTool {
 public:
  RestingTool(const Scenario& scenario, const NamedFiles& files, const std::shared_ptr<const PointShell>& shell,
              const ContactState& near)
      : parts_(assemble(scenario, files, shell, {})),
        contacts_(parts_.source->capacity()),
        time_(near.time),
        axis_(near.pose.axis),
        roll_(near.pose.roll),
        in_plane_(stays_in_plane(scenario, near)),
        admittance_(std::get_if<AdmittanceDeviceConfig>(&scenario.device)) {
    parts_.hand->reset();
    parts_.source->follow(&row_);
    parts_.source->reset();
    parts_.algorithm->prepare({.capacity = parts_.source->capacity(),
                               .tool = parts_.tool.get(),
                               .shell = parts_.shell.get(),
                               .springs = parts_.springs.get(),
                               .dt = scenario.time.step,
                               .schedule = parts_.source->schedule(),
                               .row = &row_,
                               .input = &input_,
                               .position_is_free = true,
                               .handle_moves_tool = handle_moves_tool(scenario.device)});
    parts_.algorithm->reset();
    parts_.device->reset({{scenario.initial.position, Vec3::Zero()}, Vec3::Zero()});
    approach(scenario.initial.position, near.pose.position);
  }

  bool touches() const { return !force_.S.isZero(0.0) || !force_.spring.isZero(0.0); }
  const Vec3& position() const { return position_; }

  /// Moves the tool to the equilibrium and returns true. If the search does not converge, the tool stays at the last
  /// pose in contact and the result is false.
  bool find_equilibrium() {
    constexpr int kIterations = 40;
    constexpr double kLargestStep = 0.1;  // largest step, in half widths of the tool
    // Step length below which the search ends [m]: about kRelativeError times the length of the first steps.
    constexpr double kConverged = 1e-10;
    // A simulated subject adapts its force during the run, so the pose `near` counts as the equilibrium.
    if (parts_.hand->task() != nullptr) return true;
    for (int i = 0; i < kIterations; ++i) {
      const Vec3 before = position_;
      const LinearContact here = linearised();
      Vec3 step = newton_step(here.rendered.stiffness + here.input * here.hand.stiffness);
      const double longest = kLargestStep * parts_.tool->half_width();
      if (const double length = step.norm(); length > longest) step *= longest / length;
      place(before + step);
      if (!touches() || !force_.rendered.allFinite()) {
        place(before);
        return false;
      }
      if (step.norm() < kConverged) return true;
    }
    return false;
  }

  /// Returns the linearisation at the current pose.
  LinearContact linearised() {
    LinearContact contact;
    const Vec3 at = position_;
    const RenderedForce here = force_;
    const std::uint64_t set = contact_set_;
    for (Eigen::Index i = 0; i < 3; ++i) {
      const Vec3 step = kPositionStep * Vec3::Unit(i);
      const auto [above, same_above] = force_at(at + step, set);
      const auto [below, same_below] = force_at(at - step, set);
      // Use a one-sided difference if the set of contacts changes on one side only.
      if (same_above == same_below)
        contact.rendered.stiffness.col(i) = -(above - below) / (2.0 * kPositionStep);
      else
        contact.rendered.stiffness.col(i) = same_above ? Vec3(-(above - here.rendered) / kPositionStep)
                                                       : Vec3(-(here.rendered - below) / kPositionStep);
      contact.rendered.damping.col(i) =
          -(moving(at, kVelocityStep * Vec3::Unit(i)) - moving(at, -kVelocityStep * Vec3::Unit(i))) /
          (2.0 * kVelocityStep);
    }
    place(at);
    contact.rendered.assumed = parts_.algorithm->jacobian();
    contact.rendered.stiffness =
        without_noise(contact.rendered.stiffness, contact.rendered.stiffness.cwiseAbs().maxCoeff());
    contact.rendered.damping = without_noise(contact.rendered.damping, contact.rendered.damping.cwiseAbs().maxCoeff());
    contact.hand = parts_.hand->impedance();
    contact.input = input_slope();
    if (in_plane_) remove_z(contact);
    return contact;
  }

 private:
  /// Moves the tool from `from` to `to` in small steps, so that the state of a proxy or a dragging hand follows the
  /// tool.
  void approach(const Vec3& from, const Vec3& to) {
    constexpr int kSteps = 128;
    for (int i = 0; i <= kSteps; ++i) place(from + (to - from) * (static_cast<double>(i) / kSteps));
  }

  /// Computes the forces on a tool that rests at `position`.
  void place(const Vec3& position) {
    position_ = position;
    moving(position, Vec3::Zero());
    contact_set_ = 0;
    for (std::size_t i = 0; i < contacts_.size(); ++i) {
      Hash64 hash;
      hash.word(contacts_.index[i]);
      contact_set_ += hash.value();
    }
    hold(position);
  }

  /// Returns the rendered force on a tool with this position and velocity. The force of some laws depends on earlier
  /// positions of the tool: a proxy that passes a point of the surface needs several steps to come to rest. The force
  /// is therefore computed until it no longer changes.
  Vec3 moving(const Vec3& position, const Vec3& velocity) {
    // A proxy above a point needs more computations the deeper the tool is: 60 at a depth of 3/4 of the tip's radius.
    constexpr int kMaxComputations = 128;
    // Relative change of the force that ends the repetition. Its effect on the derivatives is below kRelativeError.
    constexpr double kUnchanged = 1e-13;
    ++row_;
    const ToolState tool{{position, axis_, roll_}, velocity};
    for (int i = 0; i < kMaxComputations; ++i) {
      const Vec3 last = force_.rendered;
      parts_.source->contacts_at(tool.pose, contacts_);
      parts_.algorithm->compute(tool, contacts_, force_);
      if (i > 0 && (force_.rendered - last).norm() <= kUnchanged * last.norm()) break;
    }
    return force_.rendered;
  }

  /// Returns the rendered force at a position, and true if the contacts at this position are the contacts with the hash
  /// `set`.
  std::pair<Vec3, bool> force_at(const Vec3& position, std::uint64_t set) {
    place(position);
    return {force_.rendered, contact_set_ == set};
  }

  /// Computes the hand's force at rest. On an admittance device, this force displaces the handle from the tool against
  /// the stiffness of servo and structure.
  void hold(const Vec3& position) {
    HandleState handle{position, Vec3::Zero()};
    const ToolPose pose{position, axis_, roll_};
    // Each iteration multiplies the error by the ratio of the hand's stiffness to the series stiffness of servo and
    // structure.
    constexpr int kIterations = 8;
    for (int i = 0; i < (admittance_ != nullptr ? kIterations : 1); ++i) {
      hand_ = parts_.hand->force(time_, {handle, pose, force_.rendered, force_.spring});
      if (admittance_ != nullptr && admittance_->servo.stiffness > 0.0)
        handle.position =
            position + hand_ * (1.0 / admittance_->servo.stiffness + 1.0 / admittance_->mechanics.structure_stiffness);
    }
    measured_ = parts_.device->measure(hand_);
    input_ = measured_.input;
  }

  /// Returns the displacement of the tool [m] to its equilibrium, assuming that the total force decreases linearly with
  /// the displacement. `slope`: force decrease per displacement [N/m], like a stiffness. The tool moves only in
  /// directions in which forces act: a law without a force along the surface does not move the tool along the surface,
  /// even if its normal force depends on the position along the surface.
  Vec3 newton_step(const Mat3& slope) const {
    constexpr double kSingular = 1e-6;  // smaller singular values, in units of the largest, count as zero
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(slope, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const Vec3& values = svd.singularValues();
    Eigen::Index rank = 0;
    while (rank < 3 && values[rank] > kSingular * values[0] && values[rank] > 0.0) ++rank;
    if (rank == 1 || rank == 2) {
      const auto acted = svd.matrixU().leftCols(rank);
      const Eigen::FullPivLU<Eigen::MatrixXd> within(acted.transpose() * slope * acted);
      if (within.rcond() > kSingular) return acted * within.solve(acted.transpose() * total_force());
    }
    // If forces act in all directions (rank 3), or if no displacement within the directions of the forces removes the
    // total force, use the shortest least-squares solution.
    Vec3 step = Vec3::Zero();
    for (Eigen::Index k = 0; k < rank; ++k)
      step += svd.matrixU().col(k).dot(total_force()) / values[k] * svd.matrixV().col(k);
    return step;
  }

  /// Returns the sum of the forces on the tool at rest [N].
  Vec3 total_force() const { return force_.rendered + (parts_.device->moves_tool() ? hand_ : input_); }

  /// Returns the derivative of the input force with respect to the hand's force, by differences.
  Mat3 input_slope() {
    if (parts_.device->moves_tool()) return Mat3::Identity();
    constexpr double kForceStep = 1e-6;  // [N]
    Mat3 slope;
    for (Eigen::Index i = 0; i < 3; ++i)
      slope.col(i) = (parts_.device->measure(hand_ + kForceStep * Vec3::Unit(i)).input -
                      parts_.device->measure(hand_ - kForceStep * Vec3::Unit(i)).input) /
                     (2.0 * kForceStep);
    return without_noise(slope, 1.0);
  }

  SimulationParts parts_;
  ContactBuffer contacts_;
  double time_;
  Vec3 axis_;
  double roll_;
  bool in_plane_;                             ///< true if the tool moves only in the plane z = 0
  const AdmittanceDeviceConfig* admittance_;  ///< null for other devices
  std::uint64_t row_ = 0;
  Vec3 position_ = Vec3::Zero();
  RenderedForce force_;
  std::uint64_t contact_set_ = 0;  ///< hash of the rendered contacts
  Vec3 hand_ = Vec3::Zero(), input_ = Vec3::Zero();
  MeasuredForce measured_;
};

/// Returns linear_contact() of a scenario whose files have been checked.
std::optional<ContactAtRest> contact_at_rest(const Scenario& scenario, const NamedFiles& files,
                                             const std::shared_ptr<const PointShell>& shell, const ContactState& near) {
  const Scenario linear = without_nonlinear_parts(scenario);
  RestingTool tool(linear, files, shell, near);
  if (!tool.touches()) return std::nullopt;
  const bool is_equilibrium = tool.find_equilibrium();
  // Without an equilibrium, linearise at the pose `near`. The last pose of the search may lie where the force jumps,
  // and derivatives across a jump have no meaning.
  LinearContact contact = is_equilibrium ? tool.linearised() : RestingTool(linear, files, shell, near).linearised();
  if (!contact.rendered.stiffness.allFinite() || !contact.rendered.damping.allFinite()) return std::nullopt;
  // A hand that is attached to the handle also moves between the samples. It is therefore part of the device and not of
  // the contact.
  if (std::holds_alternative<MassSpringDamperHandFields>(linear.hand) && handle_moves_tool(linear.device))
    contact.hand = {};
  return ContactAtRest{contact, is_equilibrium};
}

/// Returns ln |z| of an eigenvalue of a loop: the growth in one step.
double growth(const std::complex<double>& z) {
  return math::log(std::sqrt(std::norm(z)));
}

/// Returns true if a mode is a drift: it grows by more than e^(2 pi) within a turn, so that no oscillation is visible.
/// An example is a tool that begins to roll off a dome.
bool is_drift(const std::complex<double>& z) {
  return z.real() > 0.0 && growth(z) > 0.0 && std::abs(math::atan2(z.imag(), z.real())) <= growth(z);
}

/// Returns true if all drifts grow by less than e in 1 / (2 pi kVibrationCutoff). Less than half of the amplitude of
/// such a drift passes a high-pass of first order at the cutoff, so that it is no cause of vibration. `dt`: time step
/// [s].
bool drifts_slowly(const std::vector<Eigen::MatrixXd>& loop, double dt) {
  const double fast = 2.0 * std::numbers::pi * kVibrationCutoff * dt;
  return std::ranges::none_of(loop, [fast](const Eigen::MatrixXd& matrix) {
    const Eigen::VectorXcd all = eigenvalues(matrix);
    return std::ranges::any_of(all, [fast](const auto& z) { return is_drift(z) && growth(z) >= fast; });
  });
}

/// Returns true if is_stable_loop() holds for all eigenvalues except drifts.
bool is_stable_except_drift(const std::vector<Eigen::MatrixXd>& loop) {
  if (is_stable_loop(loop)) return true;
  std::vector<Eigen::MatrixXd> modes;  // one matrix for each eigenvalue and its conjugate
  for (const Eigen::MatrixXd& matrix : loop)
    for (const std::complex<double>& z : eigenvalues(matrix)) {
      if (is_drift(z)) continue;
      modes.emplace_back(Eigen::Matrix2d{{z.real(), -z.imag()}, {z.imag(), z.real()}});
    }
  return is_stable_loop(modes);
}

}  // namespace

std::optional<ContactAtRest> linear_contact(const CheckedScenario& scenario,
                                            const std::shared_ptr<const PointShell>& shell, const ContactState& near) {
  return contact_at_rest(scenario.scenario(), scenario.files(), shell, near);
}

LinearContact scaled(LinearContact contact, const RenderingConfig& from, const RenderingConfig& to) {
  const double K = to.stiffness / from.stiffness,
               B = normal_damping(from) > 0.0 ? normal_damping(to) / normal_damping(from) : 1.0;
  LinearForce& rendered = contact.rendered;
  rendered = {
      K * rendered.stiffness, B * rendered.damping, {K * rendered.assumed.stiffness, B * rendered.assumed.damping}};
  return contact;
}

std::optional<bool> ContactLoops::is_stable(const Scenario& scenario, const NamedFiles& files,
                                            const std::shared_ptr<const PointShell>& shell) {
  const auto at_rest = contact_at_rest(scenario, files, shell, near_);
  std::optional<LinearContact> contact;
  if (at_rest && (at_rest->is_equilibrium || (at_any_pose_ && !known_)))
    contact = at_rest->contact;
  else if (known_ && is_stiffness_)
    contact = scaled(*known_, known_rendering_, scenario.rendering);
  if (!contact) return std::nullopt;
  known_ = contact;
  known_rendering_ = scenario.rendering;
  const std::vector<Eigen::MatrixXd> loop = contact_loop(scenario, *contact);
  if (loop.empty()) return std::nullopt;
  if (!is_stiffness_) return is_stable_loop(loop);
  if (!ignores_drift_) ignores_drift_ = drifts_slowly(loop, scenario.time.step);
  return *ignores_drift_ ? is_stable_except_drift(loop) : is_stable_loop(loop);
}

std::optional<double> limit_along(const LimitWalk& walk, const std::function<std::optional<bool>(double)>& is_stable) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const std::optional<bool> first = is_stable(walk.start);
  if (!first) return std::nullopt;
  const auto holds = [&](double value) { return is_stable(value).value_or(false); };
  double last = walk.start, next = last;
  do {
    last = std::exchange(next, walk.next(next, *first));
    if (next == last) return *first ? kInfinity : -kInfinity;
  } while (holds(next) == *first);
  double stable = std::min(last, next), unstable = std::max(last, next);
  while (!walk.is_resolved(stable, unstable)) {
    const double middle = 0.5 * (stable + unstable);
    (holds(middle) ? stable : unstable) = middle;
  }
  return stable;
}

std::optional<double> linear_stiffness_limit(const CheckedScenario& scenario,
                                             const std::shared_ptr<const PointShell>& shell, const ContactState& near) {
  // kStep: factor between successive values of K; kMax, kMin: range of K, in units of the scenario's K.
  constexpr double kStep = 1.1, kMax = 2.0, kMin = 1e-9;
  constexpr double kResolution = 1e-10;
  const double K = scenario.scenario().rendering.stiffness;
  if (!(K > 0.0) || !has_linear_loop(scenario.scenario())) return std::nullopt;
  ContactLoops loops(near, /*is_stiffness=*/true, /*at_any_pose=*/true);
  Scenario at = scenario.scenario();
  LimitWalk walk{.start = K};
  walk.next = [&](double value, bool up) {
    if (up) return std::min(value * kStep, kMax * K);
    return value / kStep < kMin * K ? value : value / kStep;
  };
  walk.is_resolved = [](double stable, double unstable) { return unstable - stable <= kResolution * unstable; };
  const auto limit = limit_along(walk, [&](double stiffness) {
    at.rendering.stiffness = stiffness;
    return loops.is_stable(at, scenario.files(), shell);
  });
  return limit ? std::optional(std::max(*limit, 0.0)) : std::nullopt;
}

}  // namespace hapbench
