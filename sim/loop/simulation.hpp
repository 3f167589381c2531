#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/contact/contact_source.hpp"
#include "sim/contact/spring_source.hpp"
#include "sim/core/types.hpp"
#include "sim/loop/device.hpp"
#include "sim/loop/force_algorithm.hpp"
#include "sim/loop/integrators/table.hpp"
#include "sim/tool/motion.hpp"
#include "sim/tool/tool_shape.hpp"

namespace hapbench {

/// Reason why the step loop of a run ended. Whether the tool got stuck, lost contact or passed through the surface is
/// judged afterwards from the recorded steps (results/summary/outcome.hpp).
enum class Ending {
  completed,        ///< all steps are done, or the hand has finished its task
  left_hole,        ///< stopped by a StopRule
  tool_horizontal,  ///< stopped by a StopRule
  diverged          ///< a value was not finite or exceeded its bound
};

/// Ends a run early after the first step in which its condition holds, as in the thesis's peg-in-hole runs
/// (section A.1.2). The condition depends on `ending`. left_hole: the tip centre is above the hole's mouth, which has
/// height 0 along `up`. tool_horizontal: the tool's axis, which points down at first, has reached the plane
/// perpendicular to `up`.
struct StopRule {
  Ending ending;
  Vec3 up;  ///< unit vector against gravity
};

/// Bounds of the simulated quantities. A run that exceeds a bound is stopped as diverged. The bounds are far beyond the
/// values of a dental drill, and far below overflow.
struct DivergenceBounds {
  double position = 1e3;  ///< position of tool and handle [m]
  double speed = 1e6;     ///< speed of tool and handle [m/s]
  double force = 1e12;    ///< f_render and f_meas [N]
};

/// Parameters of one run.
struct SimulationConfig {
  double dt = 0.0005;       ///< time step [s]
  std::uint64_t steps = 0;  ///< the run has steps 0 … steps - 1
  double mass = 0.2;        ///< the virtual mass [kg]; not used if a device's handle or a script moves the tool
  const IntegratorEntry* integrator = &kLeapfrog;  ///< moves the virtual mass; never null
  double event_tolerance = kEventTolerance;        ///< time tolerance of the integrator `event` [s]
  Vec3 position = Vec3::Zero();     ///< tip centre at t = 0 [m]; ignored if the motion prescribes the position
  Vec3 velocity = Vec3::Zero();     ///< velocity at t = 0 [m/s]
  std::vector<StopRule> stop_when;  ///< the first rule whose condition holds ends the run
  DivergenceBounds bounds;
  Skips skips = Skips::on;  ///< `on`: skips ratios and energies that no observer reads
};

/// The components of a run, owned by the simulation.
struct SimulationParts {
  std::shared_ptr<const ToolShape> tool;
  std::shared_ptr<const PointShell> shell;   ///< null if the environment is a spring set
  std::shared_ptr<const SpringSet> springs;  ///< null if the environment is a shell
  std::unique_ptr<ContactSource> source;     ///< finds the contacts with the shell or the springs
  std::unique_ptr<ForceAlgorithm> algorithm;
  std::unique_ptr<Motion> motion;
  std::unique_ptr<Hand> hand;
  std::unique_ptr<Device> device;
};

/// The step in which a run diverged. Observers are not notified of this step.
struct Divergence {
  std::uint64_t step = 0;
  double time = 0.0;          ///< [s]
  const char* quantity = "";  ///< such as "position", "handle velocity" or "rendered force"
  double magnitude = 0.0;     ///< norm of the quantity, possibly not finite
  double bound = 0.0;
  std::string fault = {};  ///< failure reported by the contact source or the algorithm; usually empty
};

struct SimulationResult {
  Ending ending = Ending::completed;
  std::uint64_t rows = 0;  ///< number of steps passed to the observers
  Divergence divergence;   ///< set if the run diverged
};

/// Record of step k: the tool at time t_k, and everything that is evaluated from this state before the integrator moves
/// the tool.
struct StepRecord {
  std::uint64_t step = 0;
  double time = 0.0;  ///< t_k = k dt [s]
  ToolState tool;
  /// Roll angle of the tool about its axis [rad], also for a solid of revolution, whose pose omits the roll. Computed
  /// only if an observer, the pose or the angular velocity needs it; 0 otherwise.
  double roll = 0.0;
  RenderedForce force;
  Vec3 hand_force = Vec3::Zero();  ///< force of the hand on the handle [N]
  MeasuredForce hand;              ///< hand_force as measured by the device
  HandleState handle;
  bool handle_moves_tool = false;           ///< true if the tool follows the handle; there is then no virtual mass
  const TargetTask* task = nullptr;         ///< target task of the hand; null if the hand has no task
  std::size_t colliding = 0;                ///< number of colliding points, before point stages merge or drop contacts
  const ContactBuffer* rendered = nullptr;  ///< contacts that the law used; valid during on_step only
  const ContactBuffer* found = nullptr;     ///< contacts before any point stage; null unless an observer reads them
  /// Stiffness ratios of the rendered contacts; computed only if an observer reads them.
  RatioRange ratio;
  SpringState springs;                 ///< computed only if an observer reads springs or energy
  std::optional<DeviceEnergy> device;  ///< computed only if an observer reads the energy

  /// Returns true if the surface acts on the tool: a point collides, or springs exert a force although none does. The
  /// proxy holds the tool on patches between the points of the surface.
  bool bears_contact() const noexcept { return colliding > 0 || !force.spring.isZero(0.0); }
  /// Returns the velocity of the moving body [m/s]: of the handle if the tool follows the handle, and of the tool
  /// otherwise. The effects of encoder and filter are not included.
  const Vec3& body_velocity() const noexcept { return handle_moves_tool ? handle.velocity : tool.velocity; }
};

/// Receives every step of a run and does not change the run.
class Observer {
 public:
  virtual ~Observer() = default;
  /// Returns true if on_step reads `ratio`. If no observer reads `ratio`, it need not be computed.
  virtual bool wants_ratio() const noexcept { return false; }
  /// Returns true if on_step reads `roll`. If no observer reads `roll`, it need not be computed.
  virtual bool wants_roll() const noexcept { return false; }
  /// Returns true if on_step reads `springs` and `device`. If no observer reads them, they need not be computed.
  virtual bool wants_energy() const noexcept { return false; }
  /// Returns true if on_step reads `springs`. If no observer reads `springs`, it need not be computed.
  virtual bool wants_springs() const noexcept { return wants_energy(); }
  /// Returns true if on_step reads `found`. If no observer reads `found`, it is null.
  virtual bool wants_found() const noexcept { return false; }
  /// Called once in every step, before the integrator moves the tool.
  virtual void on_step(const StepRecord& record) noexcept = 0;
};

/// The step loop. Each step reads hand and device, finds the contacts, computes the force, notifies the
/// observers, and moves the tool: with the integrator, or with the device if its handle moves the tool. Owns
/// the contact buffer. Allocates in the constructor only.
class Simulation {
 public:
  /// Prepares the algorithm. Observers must outlive the simulation. Throws the exceptions of
  /// ForceAlgorithm::prepare.
  Simulation(SimulationConfig config, SimulationParts parts, std::vector<Observer*> observers);
  // Not copyable, because the algorithm has pointers to members (Scene::row, Scene::input).
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  /// Resets the run to t = 0. A run after the reset is bitwise identical to the first run. Does not reset the
  /// observers.
  void reset() noexcept;
  /// Evaluates the next step k, passes it to the observers and moves the tool on to step k + 1. Returns false
  /// and does nothing if the run has ended. Allocates nothing.
  bool step() noexcept;
  /// Takes up to `steps` steps. Returns false once the run has ended.
  bool advance(std::uint64_t steps) noexcept;
  /// Takes all remaining steps and returns the result.
  SimulationResult run() noexcept;
  /// Removes all observers. Later steps do not compute the ratios, springs, energies and found contacts that only
  /// observers read. The motion does not change.
  void drop_observers() noexcept;

  const SimulationResult& result() const { return result_; }
  /// Number of the next step.
  std::uint64_t next_row() const { return row_; }
  const ToolState& tool() const { return tool_; }
  const ContactSource& source() const { return *parts_.source; }
  const ForceAlgorithm& algorithm() const { return *parts_.algorithm; }

 private:
  class ForceWithinStep;

  void move_tool_by_script() noexcept;
  void put_tool_on_handle() noexcept;
  double roll_at(double t) const noexcept;
  Vec3 angular_velocity_after(double fraction, const Vec3& axis, double roll) const noexcept;
  /// Ends the run and returns false if a value is not finite or exceeds its bound.
  bool check_bounds() noexcept;
  /// Ends the run and returns true if a stop rule's condition holds or the hand has finished its task.
  bool check_stop_rules() noexcept;
  void end(Ending ending) noexcept;

  SimulationConfig config_;
  SimulationParts parts_;
  std::vector<Observer*> observers_;
  bool ratio_wanted_ = false;
  bool springs_wanted_ = false;
  bool energy_wanted_ = false;
  /// Copy of the contacts before any point stage merges or drops contacts; null unless an observer reads the copy.
  std::unique_ptr<ContactBuffer> found_;
  bool position_is_free_ = false;
  /// True if the pose of the tool includes the roll, because the tool is not a solid of revolution.
  bool tool_rolls_ = false;
  /// True if the angular velocity includes the rotation about the tool's axis.
  bool turn_rolls_ = false;
  /// True if the roll angle has to be computed, because an observer, the pose or the angular velocity needs it.
  bool roll_wanted_ = false;
  bool handle_is_separate_ = false;  ///< true if the handle is a body separate from the tool
  /// True if the tool follows the handle; there is then no virtual mass.
  bool handle_moves_tool_ = false;
  std::optional<double> angular_velocity_cutoff_;  ///< [Hz]; nullopt if nothing reads the angular velocity
  ContactBuffer contacts_;

  std::uint64_t row_ = 0;
  bool ended_ = false;
  ToolState tool_;
  double roll_ = 0.0;  ///< roll angle of the current step [rad]; 0 if nothing needs it
  StepRecord record_;
  RenderedForce within_step_;  ///< result of the last ForceWithinStep::force_at
  SimulationResult result_;
};

}  // namespace hapbench
