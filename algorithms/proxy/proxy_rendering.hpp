#pragma once

#include <memory>
#include <optional>

#include "algorithms/proxy/proxy_constraints.hpp"
#include "algorithms/stages/damping_and_limits.hpp"
#include "sim/loop/force_algorithm.hpp"

namespace hapbench {

/// Most passes of a step; most steps take two. Passes bring the proxy near and make the constraints exact where it
/// ends.
inline constexpr int kProxyPasses = 64;
/// Speed at which a proxy leaves points that are inside it, in half widths of the tool per second. For a drill of 1 mm
/// that is 0.02 m/s, the highest speed at which the simulated subjects lead it.
inline constexpr double kRecoverySpeed = 40.0;

/// Constraint-based rendering for a tool that cannot be turned back: a proxy of the tool that has its orientation and
/// never enters the environment follows it, and a spring pulls the tool to the proxy (Zilles and Salisbury, 1995, for a
/// point; the thesis's section 1.2 rejects it for whole bodies as too expensive). Orientation is scripted, so only the
/// translation x of the proxy is free: three unknowns.
///
/// Each pass computes the constraints on the proxy (ProxyConstraints: one for each shell point within the margin) and
/// moves the proxy to the allowed place nearest to the tool (nearest_allowed), at most by the margin, so that it cannot
/// reach points further away.
///
/// Guarantee: after a pass whose contacts do not contradict each other, and which was not shortened because points were
/// inside the proxy, no shell point is inside the proxy by more than kViolationTolerance of the margin. The reason is
/// that the constraints are conservative (the tool is convex), and those of a proxy without penetration still hold for
/// a part of the move. If they contradict (a slot narrower than the tool), the proxy takes the least-squares
/// compromise, and each wall that it enters counts as one more spring of stiffness K.
///
/// A proxy may have points inside if it was placed on them or if walls leave no room. Moving it out at once would throw
/// the tool out. Instead, the depths are scaled so that the deepest point leaves at kRecoverySpeed. A proxy without
/// points inside keeps the guarantee, however fast the tool turns. Planes of springs have no inside.
///
/// With late contacts (LateContacts) the proxy follows the tool and looks for points in the rows of answers only, as of
/// the tool's pose in the query. Held, its spring stays as it was then. Linear, the constraints of its last pass are
/// planes in space that move and turn with the tool's material, and it goes to the allowed place nearest to the tool in
/// every row, without passes: points beyond the margin are not seen before the next query.
///
/// f_spring = K (x - p). S is the projector onto the span of the gradients that hold the proxy back, so lambda_max(S)
/// is 1 in contact. With angular damping v_n is S v plus the shortest velocity in that span whose components along the
/// u_i are those of the turning tool, <omega x r_i, u_i>. Normal damping and friction may follow S with a time constant
/// (`damping_time_s`): S gains and loses directions at once as points come and go, and with it -B S v would step. A
/// mean of projectors lies between 0 and I, so both stay passive. The rendered contacts are those that hold the proxy,
/// with depth lambda_i [m] and weight 1: f_spring = -K sum lambda_i u_i.
class ProxyRendering final : public ForceAlgorithm {
 public:
  explicit ProxyRendering(const RenderingConfig& config);

  void prepare(const Scene& scene) override;
  void reset() noexcept override;
  void compute(const ToolState& tool, ContactBuffer& contacts, RenderedForce& out) noexcept override;
  SpringState spring_state(const ToolState& tool, const ContactBuffer& contacts) const noexcept override;
  ForceJacobian jacobian() const noexcept override;
  std::optional<double> angular_velocity_cutoff() const noexcept override { return angular_velocity_cutoff_; }
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
  double damping_time_;                            ///< [s]
  std::optional<double> angular_velocity_cutoff_;  ///< none: no angular damping
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
