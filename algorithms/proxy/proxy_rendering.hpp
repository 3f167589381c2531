#pragma once

#include <limits>
#include <memory>
#include <optional>

#include "algorithms/stages/damping_and_limits.hpp"
#include "sim/contact/contact_buffer.hpp"
#include "sim/contact/contact_source.hpp"
#include "sim/geometry/point_shell.hpp"
#include "sim/loop/force_algorithm.hpp"
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

/// Typical distance from a shell point to its neighbours [m], 0 for fewer than three points: the median, over some of
/// the points, of the distance to the second nearest place, hence the spacing of a square lattice as well as of a line.
/// Points at the same place count as one. O(size), about a hundred distances for each point.
double typical_spacing(const PointShell& shell);

/// Most passes of a step; most steps take two. Passes bring the proxy near and make the constraints exact where it
/// ends.
inline constexpr int kProxyPasses = 64;
/// Speed at which a proxy leaves points that are inside it, in half widths of the tool per second. For a drill of 1 mm
/// that is 0.02 m/s, the highest speed at which the simulated subjects lead it.
inline constexpr double kRecoverySpeed = 40.0;

/// Constraint-based rendering for a tool that cannot be turned back: a proxy of the tool that has its orientation and
/// never enters the environment follows it, and a spring pulls the tool to the proxy (Zilles and Salisbury, 1995, for a
/// point). Orientation is scripted, so only the translation x of the proxy is free: three unknowns.
///
/// Each pass computes the constraints on the proxy (ProxyConstraints) and moves it to the allowed place nearest to the
/// tool (nearest_allowed), at most by the margin, so that it cannot reach points further away.
///
/// Guarantee: after a pass whose contacts do not contradict each other, and which was not shortened because points were
/// inside the proxy, no shell point is inside the proxy by more than kViolationTolerance of the margin, because the
/// constraints are conservative (the tool is convex), and those of a proxy without penetration still hold for a part of
/// the move. If they contradict (a slot narrower than the tool), the proxy takes the least-squares compromise, and each
/// wall that it enters counts as one more spring of stiffness K.
///
/// A proxy may have points inside if it was placed on them or if walls leave no room. Moving it out at once would throw
/// the tool out, so the depths are scaled until the deepest point leaves at kRecoverySpeed. A proxy without points
/// inside keeps the guarantee, however fast the tool turns. Planes of springs have no inside.
///
/// With late contacts (LateContacts) the proxy follows the tool and looks for points in the rows of answers only, as of
/// the tool's pose in the query. Held, its spring stays as it was then. Linear, the constraints of its last pass are
/// planes in space that turn with the tool's material, and it goes to the allowed place nearest to the tool in every
/// row, without passes: points beyond the margin are not seen before the next query.
///
/// f_spring = K (x - p). S is the projector onto the span of the gradients that hold the proxy back. With angular
/// damping v_n is S v plus the shortest velocity in that span whose components along the u_i are those of the turning
/// tool, <omega x r_i, u_i>. Normal damping and friction may follow S with a time constant (`damping_time_s`), because
/// S, and with it -B S v, steps as points come and go; a mean of projectors lies between 0 and I, so both stay passive.
/// The rendered contacts are those that hold the proxy, with depth lambda_i [m] and weight 1: f_spring = -K sum
/// lambda_i u_i.
class ProxyRendering final : public ForceAlgorithm {
 public:
  explicit ProxyRendering(const RenderingConfig& config);

  void prepare(const Scene& scene) override;
  void reset() noexcept override;
  void compute(const ToolState& tool, ContactBuffer& contacts, RenderedForce& out) noexcept override;
  SpringState spring_state(const ToolState& tool, const ContactBuffer& contacts) const noexcept override;
  ForceJacobian jacobian() const noexcept override;
  std::optional<double> angular_velocity_cutoff() const noexcept override {
    return damping_and_limits_.angular_velocity_cutoff();
  }
  AlgorithmWork work() const noexcept override;

  const Vec3& proxy() const { return proxy_; }  ///< tip centre of the proxy [m]

 private:
  void place(const Vec3& position) noexcept;
  void find(const ToolPose& tool, bool free) noexcept;
  void find_late(const ToolPose& tool, bool free) noexcept;
  void move_planes(const ToolPose& from, const ToolPose& to) noexcept;
  /// Returns false if the passes did not suffice.
  bool follow(const ToolPose& tool) noexcept;
  AllowedMove next_move(const Vec3& wanted) noexcept;
  void slow_down(double factor) noexcept;
  double multiplier(std::size_t i) const noexcept;
  void hand_over_holding(ContactBuffer& contacts) const noexcept;
  void follow_directions() noexcept;
  ContactVelocity velocity_at(const ToolState& tool) const noexcept;

  double K_;
  double damping_time_;  ///< [s]
  DampingAndLimits damping_and_limits_;
  Skips skips_;
  std::unique_ptr<ProxyConstraints> constraints_;
  std::unique_ptr<ContactBuffer> near_contacts_;  ///< constraints of the last pass, with weights [m]

  const LateContacts* late_ = nullptr;  ///< null: the proxy looks for points in every row
  std::optional<std::uint64_t> found_;  ///< row of the query that the proxy has looked for points of
  Vec3 base_ = Vec3::Zero();            ///< place of the proxy that the constraints of the last pass are of
  AlignedDoubles base_depth_;           ///< their depths, where planes move

  bool placed_ = false;  ///< false before the first step
  Vec3 proxy_ = Vec3::Zero();
  AllowedMove allowed_;                                     ///< of the last pass
  Mat3 damped_ = Mat3::Zero();                              ///< S as normal damping and friction see it
  Mat3 damped_row_ = Mat3::Zero(), before_ = Mat3::Zero();  ///< the same, of this row and of the row before
  std::optional<std::uint64_t> last_row_;
  const std::uint64_t* row_ = nullptr;  ///< null without a simulation; then each force is a row's
  double dt_ = 0.0;
  bool clear_ = false;     ///< no points are inside the proxy after the last pass
  double recovery_ = 0.0;  ///< distance by which the deepest point may leave in a step [m]
  double slowed_ = 1.0;    ///< factor of the depths of points inside in the last pass
  Vec3 spring_ = Vec3::Zero();
  AlgorithmWork work_;
};

}  // namespace hapbench
