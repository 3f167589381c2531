#pragma once

#include <limits>
#include <memory>

#include "sim/contact/contact_buffer.hpp"
#include "sim/contact/contact_query.hpp"
#include "sim/contact/spring_source.hpp"
#include "sim/geometry/point_shell.hpp"
#include "sim/tool/tool_shape.hpp"

namespace hapbench {

/// Violation, relative to the largest length of the problem, up to which a contact counts as satisfied: above the
/// rounding of the solution and of gradients, far below anything felt (1e-11 m in a search of 0.1 mm).
inline constexpr double kViolationTolerance = 1e-7;
/// epsilon of the compromise between contacts that contradict each other.
inline constexpr double kCompromiseEpsilon = 1e-6;

/// The move nearest to a wanted one that a set of contacts allows.
struct AllowedMove {
  Vec3 move = Vec3::Zero();   ///< x [m]
  Mat3 held = Mat3::Zero();   ///< I - dx/dt: the projector onto the span of the contacts that hold the tool back
  bool feasible = true;       ///< false: no move satisfies all contacts, x is the least-squares compromise
  Vec3 share = Vec3::Zero();  ///< if infeasible: <u_i, share> is the part of contact i in the residual t - x [m]
  int iterations = 0;
};

/// Solves, in three unknowns,
///
///     minimise |x - t|^2   subject to   d_i + <u_i, x> <= 0   for all contacts
///
/// with the dual active-set method of Goldfarb and Idnani (Mathematical Programming 27, 1983), which here needs no more
/// than three active contacts. Each iteration takes the contact that is violated most (the first of equals). Leaves the
/// multipliers lambda_i >= 0 [m] as weights in the buffer: x = t - sum lambda_i u_i, 0 for contacts that do not hold.
///
/// Contacts count as satisfied within kViolationTolerance of the problem's largest length. If no x satisfies all of
/// them (opposite walls of a slot narrower than the tool), x is instead the unique minimiser of
///
///     1/2 sum max(0, d_i + <u_i, x>)^2 + epsilon/2 |x - t|^2,   epsilon = 1e-6,
///
/// where opposite walls are shared in equal squares. The weights are then the violations w_i = max(0, d_i + <u_i, x>),
/// and lambda_i = w_i + <u_i, share>, which may be negative, has the same identity but for epsilon: opposite violations
/// cancel, share = H^-1 (t - x) divides the rest, H = sum u u^T + epsilon I over the violated. These lambda_i are the
/// derivatives by d_i of 1/2 |x - t|^2 + 1/2 sum w^2, so forces and moments computed from them create no energy.
/// O(n) per iteration, typically one to five iterations. Precondition: contacts are padded, gradients are unit vectors;
/// otherwise finite. Allocates nothing.
AllowedMove nearest_allowed(const Vec3& wanted, ContactBuffer& contacts) noexcept;

/// The margin in half widths of the tool. With a wider one each pass looks at more points, with a narrower one a fast
/// tool takes more passes.
inline constexpr double kProxyMargin = 0.2;

/// Keeps a proxy of the tool out of an environment by linear constraints on its next move x: d_i + <u_i, x> <= 0 with
/// depth d_i and gradient u_i of contact i.
class ProxyConstraints {
 public:
  virtual ~ProxyConstraints() = default;

  /// Replaces the contents of `contacts` by the constraints, padded, on a proxy at the pose `proxy` that wants to move
  /// by `wanted` [m]. Precondition: contacts.capacity() >= capacity(). Allocates nothing.
  virtual void constraints_at(const ToolPose& proxy, const Vec3& wanted, ContactBuffer& contacts) noexcept = 0;
  virtual std::size_t capacity() const noexcept = 0;
  /// Distance that the proxy may move before the constraints must be computed again [m].
  virtual double margin() const noexcept = 0;
  /// True if the force of a constraint acts at the point of its contact, false if it acts at the tip, which does not
  /// move when the tool turns.
  virtual bool act_at_points() const noexcept = 0;
  virtual void reset() noexcept { work_ = {}; }
  virtual const SearchWork& work() const noexcept { return work_; }

 protected:
  SearchWork work_;  ///< of constraints that have no search
};

/// Constraints of the shell points within the margin of the tool (ToolShape::surface_constraints) and of the patches of
/// surface about them (add_edges).
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
  double spacing_;          ///< typical spacing of the shell [m]
  ToolShape::Grown reach_;  ///< the tool, grown by the margin
  std::unique_ptr<ContactQuery> near_;
  AlignedDoubles places_x_, places_y_, places_z_;  ///< scratch memory for add_edges, one place per contact
};

/// Constraints of springs: planes, which hold at any distance. A bilateral spring holds the tool from both sides, so it
/// gives the pair (d, u) and (-d, -u).
class SpringConstraints final : public ProxyConstraints {
 public:
  /// The springs must outlive the constraints.
  explicit SpringConstraints(const SpringSet& springs) : springs_(&springs) {}

  void constraints_at(const ToolPose& proxy, const Vec3& wanted, ContactBuffer& contacts) noexcept override;
  std::size_t capacity() const noexcept override { return springs_->gradients.size() * (springs_->bilateral ? 2 : 1); }
  double margin() const noexcept override { return std::numeric_limits<double>::infinity(); }
  bool act_at_points() const noexcept override { return false; }

 private:
  const SpringSet* springs_;
};

}  // namespace hapbench
