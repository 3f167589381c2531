#pragma once

#include <memory>

#include "algorithms/proxy/nearest_allowed.hpp"
#include "algorithms/proxy/proxy_constraints.hpp"
#include "algorithms/stages/damping_and_limits.hpp"
#include "algorithms/theory.hpp"
#include "sim/core/model_info.hpp"
#include "sim/loop/force_algorithm.hpp"

namespace hapbench {

extern const ModelInfo kProxyInfo;
extern const AlgorithmTheory kProxyTheory;

/// Most passes of a step: to bring the proxy near, and to make the constraints exact where it ends. Most steps take
/// two.
inline constexpr int kProxyPasses = 64;
/// How fast a proxy that starts with points inside it leaves them, in half widths of the tool a second: a drill of 1 mm
/// at 0.02 m/s, as fast as the simulated subjects lead it at most.
inline constexpr double kRecoverySpeed = 40.0;

/// Constraint-based rendering for a tool that cannot be turned back: a proxy of the tool that has its orientation and
/// never enters the environment follows it, and a spring pulls the tool to the proxy (Zilles and Salisbury, 1995, for a
/// point; the thesis's section 1.2 rejects it for whole bodies as too expensive). Orientation is scripted, so only the
/// translation x of the proxy is free: three unknowns.
///
/// Each pass asks for the constraints on the proxy (ProxyConstraints: one for each shell point within a margin of it)
/// and moves the proxy to the allowed place nearest to the tool (nearest_allowed), at most by the margin; points
/// further away cannot be reached by that.
///
/// Guarantee: after a pass whose contacts do not contradict each other, and which was not cut short while points were
/// inside the proxy, no shell point is inside the proxy, but for kViolationTolerance of the margin. For the constraints
/// are conservative (the tool is convex), and those of a proxy without penetration still hold for a part of the move.
/// When they contradict (a slot narrower than the tool) the proxy takes the least-squares compromise, and each wall
/// that it enters counts as one more spring of stiffness K.
///
/// A proxy that has points inside it, since it was placed on them or walls leave no room, is not put where it belongs
/// at once, which would throw the tool out: their depths are scaled so that the deepest point leaves at kRecoverySpeed.
/// One that has none keeps its guarantee, however fast the tool turns. Planes of springs have no inside to start in.
///
/// f_spring = K (x - p), S = the projector onto the span of the gradients that hold the proxy back, so lambda_max(S) is
/// 1 in contact. With angular damping v_n is S v and the shortest velocity in that span whose components along the u_i
/// are those of the turning tool, <omega x r_i, u_i>. The rendered contacts are those, with depth lambda_i [m] and
/// weight 1: f_spring = -K sum lambda_i u_i.
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
  /// False when the passes did not suffice.
  bool follow(const ToolPose& tool) noexcept;
  AllowedMove next_move(const Vec3& wanted) noexcept;
  void slow_down(double factor) noexcept;
  double multiplier(std::size_t i) const noexcept;
  void hand_over_holding(ContactBuffer& contacts) const noexcept;
  ContactVelocity velocity_at(const ToolState& tool) const noexcept;

  double K_;
  std::optional<double> angular_velocity_cutoff_;  ///< none without angular damping
  DampingAndLimits damping_and_limits_;
  Skips skips_;
  std::unique_ptr<ProxyConstraints> constraints_;
  std::unique_ptr<ContactBuffer> near_contacts_;  ///< of the last pass, with its weights [m]

  bool placed_ = false;  ///< false before the first step
  Vec3 proxy_ = Vec3::Zero();
  Mat3 held_ = Mat3::Zero();
  bool feasible_ = true;
  bool clear_ = false;         ///< no points inside the proxy, since the last pass kept them all out
  double recovery_ = 0.0;      ///< how far the deepest point may leave in a step [m]
  double slowed_ = 1.0;        ///< what the depths of points inside were multiplied by in the last pass
  Vec3 share_ = Vec3::Zero();  ///< AllowedMove::share of the last pass [m]
  Vec3 spring_ = Vec3::Zero();
  AlgorithmWork work_;
};

std::unique_ptr<ForceAlgorithm> make_proxy(const RenderingConfig& config);

}  // namespace hapbench
