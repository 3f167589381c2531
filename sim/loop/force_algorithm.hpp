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

/// Description of the scene that a force algorithm receives before the first step. All objects behind the pointers
/// outlive the algorithm.
struct Scene {
  std::size_t capacity = 0;            ///< maximum number of contacts in a step
  const ToolShape* tool = nullptr;     ///< the tool, for algorithms that keep a proxy of it
  const PointShell* shell = nullptr;   ///< the environment; null if it is a spring set
  const SpringSet* springs = nullptr;  ///< the environment; null if it is a shell
  double dt = 0.0005;                  ///< time step [s]
  /// Schedule of the steps in which an algorithm with its own contact search may search; null if it may search in every
  /// step.
  const ContactSchedule* schedule = nullptr;
  /// `row`: number of the current step. `input`: input force f_in [N] of the current step, which drives the tool
  /// together with f_render until the next step. The caller updates both before the first `compute` of each step. Both
  /// are null if neither a Simulation nor a LiveLoop runs the algorithm.
  const std::uint64_t* row = nullptr;
  const Vec3* input = nullptr;
  bool position_is_free = true;    ///< false if a script prescribes the tool's position
  bool handle_moves_tool = false;  ///< true: the tool follows the measured handle; there is no virtual mass
};

/// State of dry friction in one step.
enum class Friction : std::uint8_t { none, sticks, slides };

/// The result of an algorithm for one state of the tool.
struct RenderedForce {
  Vec3 spring = Vec3::Zero();          ///< f_spring, force of the penalty springs on the tool [N]
  Vec3 rendered = Vec3::Zero();        ///< f_render = spring + damping + friction, after the force limits [N]
  Mat3 S = Mat3::Zero();               ///< stiffness tensor in units of the spring stiffness K
  double depth_max = 0.0;              ///< largest depth of the colliding points [m], before any point stage
  Friction friction = Friction::none;  ///< `none` if dry friction is off or no contact carries a normal force
};

/// Elastic energy of the penalty springs in one step, and the moment that they would exert about the tip
/// centre, sum r_i x f_i over the rendered contacts. r_i is the vector from the tip centre to contact i. The
/// contact forces f_i sum to f_spring. They depend on the algorithm:
///
///  - Laws with weights: f_i = -K c_i d_i u_i.
///  - virtual_coupling and least_squares: f_i = -K_p (d_i + <u_i, s>) u_i, the forces of the penalty springs while the
///    coupling is stretched by the vector s [m]. K_p is K for virtual_coupling, and K / eps with the regularisation eps
///    for least_squares. These forces push and pull against each other, so the moment may be much larger than the
///    product of f_spring and the lever arm.
///  - original_averaging and highest_depth: the law has one spring without a point of application, so each of
///    the n contacts gets f_spring / n.
///  - proxy: f_i = -K lambda_i m_i for the points that hold the proxy, with multiplier lambda_i and tool normal
///    m_i. Here r_i starts at the proxy's tip centre. If points lie deep inside the proxy, their depths are multiplied
///    by a factor < 1, so that the proxy moves out slowly. The forces f_i of these points are multiplied by the same
///    factor. If several sets of points hold the proxy equally well, the solver uses one of them. The total force is
///    the same for each set, but the moment may differ.
///  - A passivity controller scales all contact forces by the factor by which it scales f_spring.
///
/// Damping, friction and force limits act on the tool as a whole and contribute to neither value. The springs of a
/// spring set act at the tip centre, so their moment is zero.
struct SpringState {
  double energy = 0.0;         ///< elastic energy [J]
  Vec3 moment = Vec3::Zero();  ///< moment on the tool about its tip centre [N m]; the device does not render it
};

/// Returns false if the result of an algorithm contains no spring that could store energy. `spring_state` is
/// then zero.
inline bool has_springs(const ContactBuffer& rendered, const RenderedForce& force) noexcept {
  return !rendered.empty() || !force.spring.isZero(0.0);
}

/// Linearisation of the rendered force for small motions of the tool, for implicit integrators: df = -stiffness
/// dp - damping dv, with displacement dp [m] and velocity change dv [m/s] of the tip centre.
struct ForceJacobian {
  Mat3 stiffness = Mat3::Zero();  ///< K S, stiffness [N/m]
  Mat3 damping = Mat3::Zero();    ///< normal damping (B S for a linear damper) plus friction [N s/m]
};

/// Counters of the work of an algorithm since its last reset.
struct AlgorithmWork {
  std::uint64_t iterations = 0;        ///< iterations of the law's solver (shaping, Newton), over all steps
  std::uint64_t points_dropped = 0;    ///< contacts dropped because a buffer was full (max_points of the reduction)
  SearchWork search = {};              ///< work of the algorithm's own contact searches, at other poses than the tool's
  std::uint64_t steps_controlled = 0;  ///< steps in which a passivity controller changed the force

  /// Steps in which a force stage (energy tank or actuator-limited passivity) changed the force.
  std::uint64_t steps_staged = 0;
  /// Work on the tool [J] of the forces before the force stage, minus the work of the rendered forces, both over the
  /// simulated motion.
  double energy_staged = 0.0;

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

/// Computes the force on the tool from its contacts and its state. One instance holds the state of one run.
class ForceAlgorithm {
 public:
  virtual ~ForceAlgorithm() = default;

  /// Called once before the first step. Only this function may allocate or throw.
  virtual void prepare(const Scene& scene) = 0;
  /// Resets the algorithm to t = 0. A run after the reset is bitwise identical to the first run.
  virtual void reset() noexcept = 0;
  /// Computes the force for the state of the step. Some integrators then also call it for states within the
  /// step. On entry, `contacts` holds the contacts at the tool's pose with depth and gradient (ContactSource).
  /// On return it holds the rendered contacts with their weights.
  virtual void compute(const ToolState& tool, ContactBuffer& contacts, RenderedForce& out) noexcept = 0;
  /// Returns the elastic energy and the moment of the springs in the last `compute`. The arguments are the tool and the
  /// rendered contacts of this `compute`. Called only if an observer or a passivity controller needs the result.
  virtual SpringState spring_state(const ToolState& tool, const ContactBuffer& contacts) const noexcept = 0;
  /// Returns the Jacobian of the force of the last `compute` with the contacts held constant. Called by
  /// implicit integrators only.
  virtual ForceJacobian jacobian() const noexcept = 0;
  /// Returns the cut-off frequency [Hz] of the low-pass filter through which `compute` reads the tool's angular
  /// velocity: infinite for the unfiltered velocity, nullopt if `compute` does not read it. With nullopt, the angular
  /// velocity is not computed.
  virtual std::optional<double> angular_velocity_cutoff() const noexcept { return std::nullopt; }
  /// Returns the description of a failure in external code that made the result of the last `compute` invalid,
  /// or null. Called when a run diverges.
  virtual const char* fault() const noexcept { return nullptr; }
  virtual AlgorithmWork work() const noexcept { return {}; }
};

}  // namespace hapbench
