#include "algorithms/six_dof/tool_equilibrium.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "algorithms/proxy/proxy_constraints.hpp"
#include "algorithms/six_dof/turns.hpp"
#include "sim/tool/orientation.hpp"

namespace hapbench::six_dof {
namespace {

/// Factor on the search margin that covers the rounding errors of margin and motion.
constexpr double kQueryMargin = 1.0 + 1e-6;
/// Relative step of the difference quotients for the second derivatives of the constraints. Their error, of second
/// order in the step, affects the speed of convergence but not the solution.
constexpr double kDifference = 1e-4;
/// Tolerances of a quadratic program, relative to the largest of the depths and of the components of the wanted motion,
/// about 1e-4 m. The second tolerance is used only if the program is not solved with the first. The first corresponds
/// to 1e-17 m, ten times the rounding error of a depth. Constraints of points on one straight line of the tool's
/// surface are linearly dependent up to rounding, and may contradict each other within the first tolerance. The second
/// corresponds to 1e-15 m, or 2e-11 N at 20 000 N/m.
constexpr double kProgramTolerances[] = {1e-13, 1e-11};
/// Length of the first move off a saddle of the energy, relative to margin(). Later moves are longer.
constexpr double kNudge = 0.02;
/// Smallest move off a saddle relative to the first move, used if another point blocks a longer move. It is 2e-12 m for
/// a drill with a diameter of 1 mm.
constexpr double kShortestNudge = 1e-6;
/// Smallest stiffness in any direction of a quadratic program, relative to the stiffness of the springs in this
/// direction.
constexpr double kFlat = 1e-3;
/// Number of passes (iterations of the search for the equilibrium) after which only every second pass uses second
/// derivatives of the constraints. If the active set changes in every pass with second derivatives, the search may
/// converge in passes without them, and the other way round.
constexpr int kManyPasses = 40;

}  // namespace

/// The linearised constraints (`Rows` of nearest_point.hpp), in coordinates y in which the quadratic model of the
/// energy is K/2 |y - t|^2.
struct ToolEquilibrium::Program {
  const std::vector<Vec6>& rows;
  const std::vector<double>& depths;
  std::size_t count;

  std::size_t size() const { return count; }
  double depth(std::size_t i) const { return depths[i]; }
  const Vec6& row(std::size_t i) const { return rows[i]; }
  nearest_point::Violation largest_violation(const Vec6& x, double tolerance) const noexcept {
    nearest_point::Violation worst{0, tolerance};
    for (std::size_t i = 0; i < count; ++i) {
      const double amount = depths[i] + rows[i].dot(x);
      if (amount > worst.amount) worst = {i, amount};
    }
    return worst.amount > tolerance ? worst : nearest_point::Violation{};
  }
};

ToolEquilibrium::ToolEquilibrium(const PointShell& shell, const ToolShape& tool, double force_point, Skips skips)
    : tool_(&tool),
      force_point_(force_point),
      margin_(kProxyMargin * tool.half_width()),
      reach_(tool.reach() + force_point),
      recovery_(std::numeric_limits<double>::infinity()),
      grown_(tool.grown(margin_ * kQueryMargin)),
      near_(make_contact_query(shell, *grown_.shape, skips)),
      contacts_(near_->capacity()),
      probe_(6),
      rows_(near_->capacity()),
      scaled_rows_(near_->capacity()),
      scaled_depths_(near_->capacity()),
      scales_(near_->capacity()) {}

void ToolEquilibrium::reset() noexcept {
  near_->reset();
  holding_count_ = 0;
  deepest_ = 0.0;
}

ToolPose ToolEquilibrium::tool_pose(const Vec3& position, const Eigen::Quaterniond& orientation) const noexcept {
  ToolPose pose;
  pose.axis = axis_of(orientation);
  pose.position = position + force_point_ * pose.axis;
  if (!tool_->is_axisymmetric()) pose.roll = roll_of(orientation);
  return pose;
}

double ToolEquilibrium::displacement(const Vec6& z) const noexcept {
  return z.head<3>().norm() + reach_ * z.tail<3>().norm();
}

Vec6 ToolEquilibrium::row(const Vec3& position, const ContactBuffer& contacts, std::size_t i) const noexcept {
  const Vec3 m = contacts.gradient(i), r = contacts.point(i) - position;
  Vec6 row;
  row << m, r.cross(m);
  return row;
}

void ToolEquilibrium::find_constraints(const CoupledPose& pose) noexcept {
  const ToolPose tool = tool_pose(pose.position, pose.orientation);
  near_->contacts_at({tool.position + grown_.forward * tool.axis, tool.axis, tool.roll}, contacts_);
  tool_->surface_constraints(tool, Vec3::Zero(), 0.0, contacts_);
  deepest_ = 0.0;
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    rows_[i] = row(pose.position, contacts_, i);
    deepest_ = std::max(deepest_, contacts_.depth[i]);
  }
  leaving_ = deepest_ > recovery_;
  if (!leaving_) return;
  for (std::size_t i = 0; i < contacts_.size(); ++i)
    if (contacts_.depth[i] > 0.0) contacts_.depth[i] *= recovery_ / deepest_;
}

/// Returns the sum, over the points that held the tool in the last pass, of the load lambda_i times the second
/// derivative of -g_i with respect to the tool's motion. g_i is the signed distance of point i to the tool.
Mat6 ToolEquilibrium::curvature(const CoupledPose& pose) noexcept {
  Mat6 sum = Mat6::Zero();
  if (holding_count_ == 0) return sum;
  probe_.clear();
  for (const Holding& h : holding()) probe_.push(h.index, h.point, h.surface_normal);
  probe_.pad();
  for (int k = 0; k < 6; ++k) {
    Vec6 step = Vec6::Zero();
    step[k] = kDifference * tool_->half_width() / (k < 3 ? 1.0 : reach_);
    for (const double sign : {1.0, -1.0}) {
      const Vec3 position = pose.position + sign * step.head<3>();
      const Eigen::Quaterniond orientation = turned(pose.orientation, sign * step.tail<3>());
      tool_->surface_constraints(tool_pose(position, orientation), Vec3::Zero(), 0.0, probe_);
      for (std::size_t i = 0; i < holding_count_; ++i)
        sum.col(k) += sign * holding_[i].load / (2.0 * step[k]) * row(position, probe_, i);
    }
  }
  return 0.5 * (sum + sum.transpose());
}

/// Solves the quadratic program of a pass with the second derivatives `hessian`. Writes the motion z and the points
/// that hold the tool. If `hessian` is not positive definite, returns false and writes nothing.
bool ToolEquilibrium::solve_program(const PoseSprings& springs, const EnergyModel& model, const Mat6& hessian,
                                    Vec6& z) noexcept {
  const Eigen::LLT<Mat6> factor(hessian / springs.stiffness);
  if (factor.info() != Eigen::Success) return false;
  // With y = L^T z, the model is K/2 |y - t|^2. Scale the rows to length 1.
  const auto L = factor.matrixL();
  const Vec6 wanted = -L.solve(model.gradient / springs.stiffness);
  double largest = wanted.cwiseAbs().maxCoeff();
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    scaled_rows_[i] = L.solve(rows_[i]);
    scales_[i] = 1.0 / scaled_rows_[i].norm();
    scaled_rows_[i] *= scales_[i];
    scaled_depths_[i] = contacts_.depth[i] * scales_[i];
    largest = std::max(largest, std::abs(scaled_depths_[i]));
  }
  const Program program{scaled_rows_, scaled_depths_, contacts_.size()};
  Vec6 y;
  nearest_point::ActiveSet<6> active;
  int iterations = 0;
  holding_count_ = 0;
  for (const double tolerance : kProgramTolerances) {
    y = wanted;
    active = {};
    iterations = 0;
    feasible_ = nearest_point::solve_exactly<6>(program, tolerance * largest, y, active, iterations);
    if (feasible_) break;
  }
  if (feasible_) {
    for (int k = 0; k < active.size(); ++k) {
      const std::size_t i = active.contact(k);
      holding_[holding_count_++] = {contacts_.index[i],
                                    contacts_.point(i),
                                    contacts_.normal(i),
                                    contacts_.gradient(i),
                                    contacts_.depth[i],
                                    springs.stiffness * active.lambda(k) * scales_[i],
                                    rows_[i]};
    }
  } else {
    y = wanted;
    nearest_point::solve_least_squares<6>(program, kCompromiseEpsilon, kViolationTolerance * largest, y, iterations);
  }
  z = factor.matrixU().solve(y);
  return true;
}

double ToolEquilibrium::residual_of(const PoseSprings& springs, const EnergyModel& model) const noexcept {
  Vec6 unbalanced = model.tool_gradient;
  double complementarity = 0.0;
  for (const Holding& h : holding()) {
    unbalanced += h.load * h.row;
    complementarity = std::max(complementarity, h.load * std::abs(h.depth) / margin_);
  }
  return std::max({unbalanced.head<3>().norm(), unbalanced.tail<3>().norm() / reach_,
                   model.handle_gradient.norm() / reach_, complementarity, springs.stiffness * deepest_});
}

/// Returns the second derivatives with which a pass models energy and constraints. `is_minimum` is true if these
/// derivatives show no descent along the motions that the holding points allow.
ToolEquilibrium::SecondOrder ToolEquilibrium::second_order(const PoseSprings& springs, const EnergyModel& model,
                                                           const CoupledPose& pose) noexcept {
  SecondOrder second{model.hessian, Vec6::Zero(), true};
  if (holding_count_ == 0) return second;
  const auto is_positive = [](const Mat6& m) { return Eigen::LLT<Mat6>(m).info() == Eigen::Success; };
  second.hessian += curvature(pose);
  if (is_positive(second.hessian)) return second;
  // With y = L^T z, the second derivatives of the springs are K times the identity. Along motions that keep the holding
  // points in contact, use the second derivatives of energy and constraints; in all other directions, use K. A negative
  // eigenvalue of the result is then a descent of the energy along the constraints. A penalty of finite stiffness on
  // the motions that leave contact would not show such a descent in a shallow notch, where the normals of the holding
  // points differ by only 1e-3 rad.
  const double K = springs.stiffness;
  const Mat6 L = Eigen::LLT<Mat6>(model.hessian / K).matrixL();
  const Mat6 inverse = L.inverse();
  nearest_point::ActiveSet<6> blocked;
  for (const Holding& h : holding()) {
    const Vec6 row = (inverse * h.row).normalized();
    const auto parts = blocked.split(row);
    if (parts.remainder.squaredNorm() > nearest_point::kInSpan) blocked.add(h.index, row, parts, 0.0);
  }
  const Mat6 across = blocked.projector(), along = Mat6::Identity() - across;
  const Mat6 scaled = along * (inverse * second.hessian * inverse.transpose()) * along + K * across;
  const Eigen::SelfAdjointEigenSolver<Mat6> axes(scaled);
  // Replace each negative eigenvalue by its absolute value, so that a pass moves away from a saddle and not towards it.
  // Raise eigenvalues that are nearly zero to kFlat K, so that the quadratic program has one solution.
  const Mat6 back = L * axes.eigenvectors();
  second.hessian = back * axes.eigenvalues().cwiseAbs().cwiseMax(kFlat * K).asDiagonal() * back.transpose();
  second.is_minimum = axes.eigenvalues()[0] > 0.0;
  second.descent = inverse.transpose() * axes.eigenvectors().col(0);
  return second;
}

/// Returns the fraction of the motion z after which a point that does not hold the tool would enter it; infinite if no
/// point would enter.
double ToolEquilibrium::room(const Vec6& z) const noexcept {
  double fraction = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const auto is_it = [&](const Holding& h) { return h.index == contacts_.index[i]; };
    const double rate = rows_[i].dot(z);
    if (rate > 0.0 && std::ranges::none_of(holding(), is_it))
      fraction = std::min(fraction, std::max(0.0, -contacts_.depth[i]) / rate);
  }
  return fraction;
}

/// Returns the n-th move off a saddle, n >= 0. The energy decreases equally along +`descent` and -`descent`, but other
/// points may block one of these directions. The first move takes the direction with more room, the second move takes
/// the opposite direction. Each further pair of moves is twice as long.
Vec6 ToolEquilibrium::nudge(const Vec6& descent, int n) const noexcept {
  const double first = kNudge * margin_;
  Vec6 z = first / displacement(descent) * descent;
  // If both directions have room, the choice of sign must not depend on rounding.
  Eigen::Index largest = 0;
  z.cwiseAbs().maxCoeff(&largest);
  if (z[largest] < 0.0) z = -z;
  const double length = std::min(std::ldexp(1.0, n / 2), margin_ / first);
  if ((std::min(room(-z), length) > std::min(room(z), length)) != (n % 2 == 1)) z = -z;
  return std::max(kShortestNudge, std::min(room(z), length)) * z;
}

// NOLINTNEXTLINE(readability-function-cognitive-complexity): the cases of one Newton iteration share its state.
ToolEquilibrium::Outcome ToolEquilibrium::solve(const PoseSprings& springs, CoupledPose& pose,
                                                int max_passes) noexcept {
  Outcome out;
  int nudges = 0;
  for (out.passes = 1;; ++out.passes) {
    // Linearise the constraints, and solve the quadratic program of the pass.
    find_constraints(pose);
    const EnergyModel model = energy_model(springs, pose);
    const bool alternates = out.passes > kManyPasses && out.passes % 2 == 0;
    Vec6 z;
    if (alternates || !solve_program(springs, model, second_order(springs, model, pose).hessian, z)) {
      if (!solve_program(springs, model, model.hessian, z)) return out;
    }
    out.feasible = feasible_;
    out.residual = residual_of(springs, model);
    // A pass that balances all forces is the last pass, unless the pose is a saddle of the energy.
    if (feasible_ && out.residual <= kSolved) {
      const SecondOrder here = second_order(springs, model, pose);
      out.solved = here.is_minimum;
      if (out.solved) return out;
      z = nudge(here.descent, nudges++);
    }
    if (out.passes >= max_passes) return out;
    const double length = displacement(z);
    if (length > margin_) z *= margin_ / length;
    out.moved += std::min(length, margin_);
    move(pose, model, z);
    // With a finite recovery length, surface points that are deep in the tool come out over many steps, so one pass in
    // each step is enough.
    if (std::isfinite(recovery_) && (!feasible_ || leaving_)) return out;
  }
}

}  // namespace hapbench::six_dof
