#pragma once

#include <cstdint>
#include <optional>

#include "sim/contact/contact_buffer.hpp"
#include "sim/contact/contact_query.hpp"
#include "sim/contact/contact_schedule.hpp"
#include "sim/contact/spring_source.hpp"
#include "sim/geometry/point_shell.hpp"
#include "sim/tool/tool_shape.hpp"

namespace hapbench {

/// The scene as known to a force algorithm before the first step. Everything pointed to outlives the algorithm.
struct Scene {
  std::size_t capacity = 0;            ///< maximum number of contacts in a step
  const ToolShape* tool = nullptr;     ///< for algorithms that keep a proxy of it
  const PointShell* shell = nullptr;   ///< the environment, unless it is springs
  const SpringSet* springs = nullptr;  ///< the environment, unless it is a shell
  double dt = 0.0005;                  ///< time step [s]
  /// When algorithms that look for contacts themselves have to look; null: in every row.
  const ContactSchedule* schedule = nullptr;
  /// The present row and its f_in [N], which drives the tool together with f_render over the coming step. They change
  /// before the first `compute` of each row. Null if the algorithm is not stepped by a Simulation.
  const std::uint64_t* row = nullptr;
  const Vec3* input = nullptr;
  bool position_is_free = true;    ///< false: a script moves the tool
  bool handle_moves_tool = false;  ///< the tool follows the measured handle; there is no virtual mass
};

/// What dry friction does in one step.
enum class Friction : std::uint8_t { none, sticks, slides };

/// The result of an algorithm in one step.
struct RenderedForce {
  Vec3 spring = Vec3::Zero();    ///< f_spring [N], on the tool
  Vec3 rendered = Vec3::Zero();  ///< f_render = spring + damping + friction, limited [N]
  Mat3 S = Mat3::Zero();         ///< stiffness tensor in units of K
  double depth_max = 0.0;        ///< largest penetration depth of the colliding points, before any point stage [m]
  Friction friction = Friction::none;  ///< none without load or without dry friction
};

/// Elastic energy of the penalty springs of one step, and the torque that they would exert: moment = sum r_i x f_i
/// about the tip centre, over the rendered contacts, whose contributions f_i add up to f_spring:
///   - laws with weights: f_i = -K c_i d_i u_i;
///   - virtual_coupling, least_squares: the penalty springs as relieved by the coupling,
///     f_i = -K_p (d_i + <u_i, s>) u_i, s the stretch of the coupling, K_p = K or K / eps. They push and pull against
///     each other, so that the moment may be far larger than force and arms suggest;
///   - original_averaging, highest_depth: their one spring has no place; each of n contacts has f_spring / n;
///   - proxy: f_i = -K lambda_i m_i of the points that hold the proxy, r_i from the proxy's tip centre; reduced, as its
///     motion is, for points inside the proxy, which it leaves slowly. Of several that hold it equally well it uses
///     any, so that its force is unique but its moment need not be;
///   - a passivity controller scales all contributions like the springs.
/// Damping, friction and force limits act on the tool as a whole and do not contribute. Environment springs act at the
/// tip centre.
struct SpringState {
  double energy = 0.0;         ///< elastic energy [J]
  Vec3 moment = Vec3::Zero();  ///< on the tool about its tip centre [N m]; the device renders none
};

/// False if the result of an algorithm leaves nothing that could store energy; `spring_state` is then zero.
inline bool has_springs(const ContactBuffer& rendered, const RenderedForce& force) noexcept {
  return !rendered.empty() || !force.spring.isZero(0.0);
}

/// Response of the rendered force to small motions of the tool, for implicit integrators:
/// df = -stiffness dp - damping dv.
struct ForceJacobian {
  Mat3 stiffness = Mat3::Zero();  ///< K S [N/m]
  Mat3 damping = Mat3::Zero();    ///< B S of normal damping and friction on the rest [N s/m]
};

/// Work done by an algorithm since its last reset.
struct AlgorithmWork {
  std::uint64_t iterations = 0;        ///< of the law's inner solver (shaping, Newton), over all steps
  std::uint64_t points_dropped = 0;    ///< contacts beyond the capacity of a buffer (reduction's max_points)
  SearchWork search = {};              ///< of the algorithm's own queries, at other poses
  std::uint64_t steps_controlled = 0;  ///< steps in which a passivity controller changed the force

  std::uint64_t steps_staged = 0;  ///< steps in which a force stage changed the force
  double energy_staged = 0.0;      ///< energy that the stage kept the force from giving to the tool [J]

  AlgorithmWork& operator+=(const AlgorithmWork& other) noexcept {
    iterations += other.iterations;
    points_dropped += other.points_dropped;
    search += other.search;
    steps_controlled += other.steps_controlled;
    steps_staged += other.steps_staged;
    energy_staged += other.energy_staged;
    return *this;
  }
};

/// Computes the force on the tool from the contacts and the tool's state. One object is the state of one run.
class ForceAlgorithm {
 public:
  virtual ~ForceAlgorithm() = default;

  /// Called once before the first step; the only call that may allocate or throw.
  virtual void prepare(const Scene& scene) = 0;
  /// Returns to t = 0, bit for bit.
  virtual void reset() noexcept = 0;
  /// Computes one step or, for some integrators, one state within a step after that of the row. `contacts` holds the
  /// contacts at the tool's pose, with depth and gradient (ContactSource); on return it holds the rendered ones, with
  /// their weights.
  virtual void compute(const ToolState& tool, ContactBuffer& contacts, RenderedForce& out) noexcept = 0;
  /// Elastic energy and moment of the springs in the last `compute`, given its contacts. Called only if an observer or
  /// controller needs them.
  virtual SpringState spring_state(const ToolState& tool, const ContactBuffer& contacts) const noexcept = 0;
  /// Jacobian of the force of the last `compute`, for constant contacts. Only implicit integrators call it.
  virtual ForceJacobian jacobian() const noexcept = 0;
  /// Cut-off frequency [Hz] of the low-pass through which `compute` reads the tool's angular velocity, infinite for the
  /// unfiltered velocity; nullopt if `compute` does not read it, which is then not computed.
  virtual std::optional<double> angular_velocity_cutoff() const noexcept { return std::nullopt; }
  /// If a failure in external code made the result of the last `compute` invalid, its description; else null. Called
  /// when a run diverges.
  virtual const char* fault() const noexcept { return nullptr; }
  virtual AlgorithmWork work() const noexcept { return {}; }
};

}  // namespace hapbench
