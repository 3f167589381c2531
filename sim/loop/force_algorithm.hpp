#pragma once

#include <cstdint>
#include <optional>

#include "sim/contact/contact_buffer.hpp"
#include "sim/contact/contact_query.hpp"
#include "sim/geometry/point_shell.hpp"
#include "sim/geometry/springs.hpp"
#include "sim/tool/tool_shape.hpp"

namespace hapbench {

/// What a force algorithm may know of the scene before the first step. Everything pointed to outlives the algorithm.
struct Scene {
  std::size_t capacity = 0;            ///< the most contacts of a step
  const ToolShape* tool = nullptr;     ///< for algorithms that keep a proxy of it
  const PointShell* shell = nullptr;   ///< the environment, unless it is springs
  const SpringSet* springs = nullptr;  ///< the environment, unless it is a shell
  double dt = 0.0005;                  ///< time step [s]
  /// The present row and its f_in [N], which drives the tool together with f_render over the coming step. They change
  /// before the first `compute` of each row. Null if the algorithm is not stepped by a Simulation.
  const std::uint64_t* row = nullptr;
  const Vec3* input = nullptr;
};

/// What an algorithm answers for one step.
struct RenderedForce {
  Vec3 spring = Vec3::Zero();    ///< f_spring [N], on the tool
  Vec3 rendered = Vec3::Zero();  ///< f_render = spring + damping + friction, limited [N]
  Mat3 S = Mat3::Zero();         ///< stiffness tensor in units of K
  double depth_max = 0.0;        ///< largest penetration depth of the colliding points [m], before any point stage
};

/// The penalty springs of one step as a store of energy, and the torque that they would exert.
///
/// moment = sum r_i x f_i about the tip centre, over the rendered contacts, whose shares f_i make up f_spring:
///   - laws with weights: f_i = -K c_i d_i u_i;
///   - virtual_coupling, least_squares: the penalty springs as far as the coupling relieves them,
///     f_i = -K_p (d_i + <u_i, s>) u_i, s the stretch of the coupling, K_p = K or K / eps. They push and pull against
///     each other, so that the moment may be far larger than force and arms suggest;
///   - original_averaging, highest_depth: their one spring names no place; each of n contacts has f_spring / n;
///   - proxy: f_i = -K lambda_i m_i of the points that hold the proxy, r_i from the proxy's tip centre; less, as its
///     motion is, of points that are inside the proxy and that it leaves slowly. Of points that hold it equally well it
///     takes any, so that its force is unique and its moment need not be;
///   - a passivity controller scales all shares by what it leaves of the springs.
/// Damping, friction and force limits act on the tool as a whole and have no shares. Springs without a place (the
/// environment springs) act at the tip centre.
struct SpringState {
  double energy = 0.0;         ///< elastic energy [J]
  Vec3 moment = Vec3::Zero();  ///< on the tool about its tip centre [N m]; the device renders none
};

/// False when an algorithm's answer leaves nothing that could store energy: `spring_state` is zero then.
inline bool has_springs(const ContactBuffer& rendered, const RenderedForce& force) noexcept {
  return !rendered.empty() || !force.spring.isZero(0.0);
}

/// How the rendered force answers small motions of the tool, for integrators that look ahead:
/// df = -stiffness dp - damping dv.
struct ForceJacobian {
  Mat3 stiffness = Mat3::Zero();  ///< K S [N/m]
  Mat3 damping = Mat3::Zero();    ///< B S of normal damping and friction on the rest [N s/m]
};

/// What an algorithm has done since its last reset.
struct AlgorithmWork {
  std::uint64_t iterations = 0;        ///< of the law's inner solver (shaping, Newton), over all steps
  std::uint64_t points_dropped = 0;    ///< contacts a full buffer refused (reduction's max_points)
  SearchWork search = {};              ///< of queries of its own, at poses of its own
  std::uint64_t steps_controlled = 0;  ///< in which a passivity controller changed the force

  AlgorithmWork& operator+=(const AlgorithmWork& other) noexcept {
    iterations += other.iterations;
    points_dropped += other.points_dropped;
    search += other.search;
    steps_controlled += other.steps_controlled;
    return *this;
  }
};

/// A force algorithm: contacts and the tool's state to a force on the tool. One object is the state of one run.
class ForceAlgorithm {
 public:
  virtual ~ForceAlgorithm() = default;

  /// Once before the first step; the only call that may allocate or throw.
  virtual void prepare(const Scene& scene) = 0;
  /// Back to t = 0, bit for bit.
  virtual void reset() noexcept = 0;
  /// One step, or one state within it: some integrators (sim/loop/integrators) ask several times a step, the first
  /// time at the row. `contacts` holds the contacts at the tool's pose, with depth and gradient (ContactSource); on
  /// return it holds the rendered ones, with their weights.
  virtual void compute(const ToolState& tool, ContactBuffer& contacts, RenderedForce& out) noexcept = 0;
  /// Elastic energy and moment of the springs behind the last `compute`, whose contacts are handed in. Called only if
  /// an observer or controller needs them.
  virtual SpringState spring_state(const ToolState& tool, const ContactBuffer& contacts) const noexcept = 0;
  /// Jacobian of the force of the last `compute`, for constant contacts. Only implicit integrators call it.
  virtual ForceJacobian jacobian() const noexcept = 0;
  /// Cut-off frequency [Hz] of the low-pass through which `compute` reads the tool's angular velocity, infinite for the
  /// unfiltered velocity. Nothing if `compute` does not read it; it is then not computed.
  virtual std::optional<double> angular_velocity_cutoff() const noexcept { return std::nullopt; }
  /// Why the answer of the last `compute` is no number, where the algorithm knows: a fault of code from outside. Null
  /// otherwise. Asked when a run diverges.
  virtual const char* fault() const noexcept { return nullptr; }
  virtual AlgorithmWork work() const noexcept { return {}; }
};

}  // namespace hapbench
