#pragma once

#include <limits>
#include <memory>

#include "sim/contact/contact_buffer.hpp"
#include "sim/contact/contact_query.hpp"
#include "sim/contact/spring_source.hpp"
#include "sim/geometry/point_shell.hpp"
#include "sim/tool/tool_shape.hpp"

namespace hapbench {

/// Tolerance of the constraints, relative to the largest of the depths and of the components of the wanted move. It is
/// above the rounding errors of solution and gradients, and far below anything that can be felt: 1e-11 m if the largest
/// of these lengths is 0.1 mm.
inline constexpr double kViolationTolerance = 1e-7;
/// Weight epsilon of the compromise between contradictory contacts (nearest_allowed).
inline constexpr double kCompromiseEpsilon = 1e-6;

/// The result of nearest_allowed. x is the allowed move, t the wanted move.
struct AllowedMove {
  Vec3 move = Vec3::Zero();  ///< x [m]
  /// I - dx/dt. If `feasible`, it is the projector onto the span of the gradients of the contacts that hold the tool
  /// back.
  Mat3 held = Mat3::Zero();
  bool feasible = true;  ///< false: no move satisfies all contacts, so x is the least-squares compromise
  /// Only set if `feasible` is false: contact i contributes <u_i, share> u_i to the residual t - x [m].
  Vec3 share = Vec3::Zero();
  int iterations = 0;
};

/// Computes the move x nearest to a wanted move t [m] that a set of contacts allows:
///
///   minimise |x - t|^2   subject to   d_i + <u_i, x> <= 0   for all contacts
///
/// d_i [m] and u_i are depth and gradient of contact i. The solver is the dual active-set method of Goldfarb and Idnani
/// (Mathematical Programming 27, 1983). With three unknowns, at most three contacts are active. Each iteration adds the
/// most violated contact, the first if several are equally violated. The multipliers lambda_i >= 0 [m] are written as
/// weights into the buffer; x = t - sum lambda_i u_i, and lambda_i = 0 for contacts that do not hold the tool back. A
/// constraint counts as satisfied if its violation is at most kViolationTolerance times the largest of the depths and
/// of the components of t.
///
/// If no x satisfies all contacts, for example between opposite walls of a slot narrower than the tool, x is the unique
/// minimiser of
///
///   1/2 sum max(0, d_i + <u_i, x>)^2 + epsilon/2 |x - t|^2,   epsilon = 1e-6,
///
/// so that the tool enters opposite walls equally deep. The weights are then the violations w_i = max(0, d_i + <u_i,
/// x>). The multipliers are lambda_i = w_i + <u_i, share> and may be negative. They also satisfy x = t - sum lambda_i
/// u_i, up to epsilon: violations of opposite walls cancel, and share = H^-1 (t - x) distributes the rest, with H = sum
/// u u^T + epsilon I over the violated contacts. These lambda_i are the derivatives by d_i of 1/2 |x - t|^2 + 1/2 sum
/// w^2, so forces and moments computed from them create no energy.
///
/// O(n) for each iteration, usually one to five iterations. Allocates nothing. Preconditions: the contacts are
/// padded, and the gradients are unit vectors. Without unit vectors the result is still finite.
AllowedMove nearest_allowed(const Vec3& wanted, ContactBuffer& contacts) noexcept;

/// Margin around the tool within which constraints are computed, in half widths of the tool. With a wider margin,
/// each computation of the constraints includes more points. With a narrower margin, a fast tool needs more
/// computations per step.
inline constexpr double kProxyMargin = 0.2;

/// Speed at which a proxy leaves points that are inside it, in half widths of the tool per second. For a drill with a
/// diameter of 1 mm, the speed is 0.02 m/s, the highest speed at which the simulated subjects move the drill.
inline constexpr double kProxyRecoverySpeed = 40.0;

/// Maximum number of passes of a proxy in a step; most steps need two. Each pass computes the constraints at the
/// proxy's position and moves the proxy. The first passes bring the proxy near its final position, and the last pass
/// computes the constraints there.
inline constexpr int kMaxProxyPasses = 64;

/// Keeps a proxy of the tool out of an environment by linear constraints on its next move x: d_i + <u_i, x> <=
/// 0, with depth d_i [m] and gradient u_i of contact i.
class ProxyConstraints {
 public:
  virtual ~ProxyConstraints() = default;

  /// Replaces the contents of `contacts` by the padded constraints of a proxy at the pose `proxy` with the
  /// wanted move `wanted` [m]. Precondition: contacts.capacity() >= capacity(). Allocates nothing.
  virtual void constraints_at(const ToolPose& proxy, const Vec3& wanted, ContactBuffer& contacts) noexcept = 0;
  /// Returns an upper bound of the number of constraints.
  virtual std::size_t capacity() const noexcept = 0;
  /// Returns the distance [m] that the proxy may move before the constraints must be computed again.
  virtual double margin() const noexcept = 0;
  /// Returns true if the force of a constraint acts at the contact's point. Returns false if it acts at the tip
  /// centre, where it has no moment.
  virtual bool act_at_points() const noexcept = 0;
  virtual void reset() noexcept { work_ = {}; }
  virtual const SearchWork& work() const noexcept { return work_; }

 protected:
  SearchWork work_;  ///< work counters of a class without a contact search
};

/// Constraints from the shell points within the margin of the tool (ToolShape::surface_constraints), and from
/// the flat patches of surface around these points (add_edges).
class ShellConstraints final : public ProxyConstraints {
 public:
  /// Shell and tool must outlive the constraints.
  ShellConstraints(const PointShell& shell, const ToolShape& tool, Skips skips);

  void constraints_at(const ToolPose& proxy, const Vec3& wanted, ContactBuffer& contacts) noexcept override;
  std::size_t capacity() const noexcept override { return 2 * near_->capacity(); }
  double margin() const noexcept override { return margin_; }
  bool act_at_points() const noexcept override { return true; }
  void reset() noexcept override { near_->reset(); }
  const SearchWork& work() const noexcept override { return near_->work(); }

 private:
  void add_edges(const ToolPose& proxy, ContactBuffer& contacts) noexcept;

  const ToolShape* tool_;
  double margin_;
  double spacing_;          ///< typical distance between neighbouring shell points [m]
  ToolShape::Grown reach_;  ///< the tool, enlarged by the margin
  std::unique_ptr<ContactQuery> near_;
  /// Scratch memory of add_edges: one support point for each contact.
  AlignedDoubles support_x_, support_y_, support_z_;
};

/// Constraints from the springs of a SpringSet. Each spring acts as a plane that the proxy must not cross; every spring
/// gives a constraint, however far the proxy is from the plane. A bilateral spring keeps the proxy on its plane, so it
/// gives two constraints, (d, u) and (-d, -u).
class SpringConstraints final : public ProxyConstraints {
 public:
  /// The spring set must outlive the constraints.
  explicit SpringConstraints(const SpringSet& springs) : springs_(&springs) {}

  void constraints_at(const ToolPose& proxy, const Vec3& wanted, ContactBuffer& contacts) noexcept override;
  std::size_t capacity() const noexcept override { return springs_->gradients.size() * (springs_->bilateral ? 2 : 1); }
  double margin() const noexcept override { return std::numeric_limits<double>::infinity(); }
  bool act_at_points() const noexcept override { return false; }

 private:
  const SpringSet* springs_;
};

}  // namespace hapbench
