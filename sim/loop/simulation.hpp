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

/// How the stepping of a run ended. What the run means for the tool is judged from its rows
/// (results/summary/outcome.hpp).
enum class Ending {
  completed,        ///< all steps are done, or the hand has finished its task
  left_hole,        ///< by a StopRule
  tool_horizontal,  ///< by a StopRule
  diverged          ///< a value was not finite or left its bound
};

/// Ends a run early, with `ending`, after the first row for which that holds (the ends of the thesis's peg-in-hole
/// runs, A.1.2): left_hole, the tip centre has risen above height 0, where the hole's mouth is; tool_horizontal, the
/// tool's axis, which points down at first, has reached the plane perpendicular to `up`.
struct StopRule {
  Ending ending;
  Vec3 up;  ///< unit vector against gravity
};

/// A run beyond these bounds is stopped as diverged. They are absurd for a dental drill, but far from overflow.
struct DivergenceBounds {
  double position = 1e3;  ///< of tool and handle [m]
  double speed = 1e6;     ///< of tool and handle [m/s]
  double force = 1e12;    ///< f_render and f_meas [N]
};

/// Parameters of one run.
struct SimulationConfig {
  double dt = 0.0005;                              ///< [s]
  std::uint64_t steps = 0;                         ///< rows 0 … steps - 1
  double mass = 0.2;                               ///< of the virtual tool, if there is one [kg]
  const IntegratorEntry* integrator = &kLeapfrog;  ///< of a virtual tool whose position is free; never null
  double event_tolerance = kEventTolerance;        ///< of the integrator `event` [s]
  Vec3 position = Vec3::Zero();     ///< of the tip centre at t = 0 [m]; ignored if the motion prescribes it
  Vec3 velocity = Vec3::Zero();     ///< at t = 0 [m/s]
  std::vector<StopRule> stop_when;  ///< the first one that holds counts
  DivergenceBounds bounds;
  Skips skips = Skips::on;  ///< of ratios and energies that no observer wants
};

/// The parts of a run; the simulation owns them.
struct SimulationParts {
  std::shared_ptr<const ToolShape> tool;
  std::shared_ptr<const PointShell> shell;   ///< null for springs
  std::shared_ptr<const SpringSet> springs;  ///< null for a shell
  std::unique_ptr<ContactSource> source;     ///< of contacts with the shell or the springs
  std::unique_ptr<ForceAlgorithm> algorithm;
  std::unique_ptr<Motion> motion;
  std::unique_ptr<Hand> hand;
  std::unique_ptr<Device> device;
};

/// The row at which a run diverged, which observers do not see.
struct Divergence {
  std::uint64_t step = 0;
  double time = 0.0;          ///< [s]
  const char* quantity = "";  ///< as in "position", "handle velocity" or "rendered force"
  double magnitude = 0.0;     ///< norm of the quantity, possibly not finite
  double bound = 0.0;
  std::string fault = {};  ///< reason reported by the contact source or the algorithm; mostly empty
};

struct SimulationResult {
  Ending ending = Ending::completed;
  std::uint64_t rows = 0;  ///< rows observed
  Divergence divergence;   ///< if the run diverged
};

/// Row k of a run: everything evaluated from (p_k, v_k, axis(t_k)), before the integrator moves the tool.
struct StepRecord {
  std::uint64_t step = 0;
  double time = 0.0;  ///< t_k = k dt [s]
  ToolState tool;
  double roll = 0.0;  ///< of the tool, even if round, in which case its pose omits it; filled only if wanted
  RenderedForce force;
  Vec3 hand_force = Vec3::Zero();  ///< of the hand on the handle [N]
  MeasuredForce hand;              ///< hand_force as measured by the device
  HandleState handle;
  bool handle_moves_tool = false;           ///< the tool follows the measured handle; there is no virtual mass
  const TargetTask* task = nullptr;         ///< of the hand at this row; null without such a task
  std::size_t colliding = 0;                ///< colliding points before any point stage
  const ContactBuffer* rendered = nullptr;  ///< contacts seen by the law; valid during on_step only
  const ContactBuffer* found = nullptr;     ///< contacts before any point stage; null unless an observer wants them
  RatioRange ratio;                         ///< over the rendered contacts; filled only if an observer wants it
  SpringState springs;                      ///< filled only if an observer wants springs or energy
  std::optional<DeviceEnergy> device;       ///< filled only if an observer wants energy

  /// True velocity of the moving body, virtual mass or handle [m/s], without the effects of encoder and filter.
  const Vec3& body_velocity() const noexcept { return handle_moves_tool ? handle.velocity : tool.velocity; }
};

/// Watches a run without changing it.
class Observer {
 public:
  virtual ~Observer() = default;
  /// True if on_step reads `ratio`, which is otherwise not computed.
  virtual bool wants_ratio() const noexcept { return false; }
  /// True if on_step reads `roll`, which is otherwise not computed.
  virtual bool wants_roll() const noexcept { return false; }
  /// True if on_step reads `springs` and `device`, which are otherwise not computed.
  virtual bool wants_energy() const noexcept { return false; }
  /// True if on_step reads `springs`.
  virtual bool wants_springs() const noexcept { return wants_energy(); }
  /// True if on_step reads `found`, which is otherwise not kept.
  virtual bool wants_found() const noexcept { return false; }
  virtual void on_step(const StepRecord& record) noexcept = 0;
};

/// The step loop: hand -> device -> contacts -> force algorithm -> observers -> integrator, or the device again if its
/// handle moves the tool. Owns the contact buffer and allocates only in the constructor.
class Simulation {
 public:
  /// Prepares the algorithm. Observers must outlive the simulation. Throws what `prepare` throws.
  Simulation(SimulationConfig config, SimulationParts parts, std::vector<Observer*> observers);
  // The algorithm has pointers to the row (Scene).
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  /// Returns to t = 0, bit for bit; does not reset the observers.
  void reset() noexcept;
  /// Evaluates row k, passes it to the observers and moves on to row k + 1. Once the run has ended, does nothing and
  /// returns false. Allocates nothing.
  bool step() noexcept;
  /// Takes up to `steps` steps; returns false once the run has ended.
  bool advance(std::uint64_t steps) noexcept;
  /// Steps to the end.
  SimulationResult run() noexcept;

  const SimulationResult& result() const { return result_; }
  std::uint64_t next_row() const { return row_; }
  const ToolState& tool() const { return tool_; }
  const ContactSource& source() const { return *parts_.source; }
  const ForceAlgorithm& algorithm() const { return *parts_.algorithm; }

 private:
  class ForceWithinStep;

  void move_tool_by_script() noexcept;
  void put_tool_on_handle() noexcept;
  double roll_at(double t) const noexcept;
  Vec3 angular_velocity_after(double part, const Vec3& axis, double roll) const noexcept;
  /// Ends the run and returns false if a value is not finite or beyond its bound.
  bool check_bounds() noexcept;
  /// Ends the run and returns true if a stop rule holds or the hand has finished.
  bool check_stop_rules() noexcept;
  void end(Ending ending) noexcept;

  SimulationConfig config_;
  SimulationParts parts_;
  std::vector<Observer*> observers_;
  bool ratio_wanted_ = false;
  bool springs_wanted_ = false;
  bool energy_wanted_ = false;
  std::unique_ptr<ContactBuffer> found_;  ///< copy of the contacts as they were found; null unless wanted
  bool position_is_free_ = false;
  bool tool_rolls_ = false;                        ///< the tool is not round, so its pose has the roll
  bool turn_rolls_ = false;                        ///< the angular velocity includes the turn about the tool's axis
  bool roll_wanted_ = false;                       ///< something reads the roll
  bool handle_is_apart_ = false;                   ///< the handle is a separate body
  bool handle_moves_tool_ = false;                 ///< there is no virtual mass
  std::optional<double> angular_velocity_cutoff_;  ///< nullopt if nothing reads the angular velocity
  ContactBuffer contacts_;

  std::uint64_t row_ = 0;
  bool ended_ = false;
  ToolState tool_;
  double roll_ = 0.0;  ///< of the row; 0 unless wanted
  StepRecord record_;
  RenderedForce within_step_;  ///< result of the last ForceWithinStep::force_at
  SimulationResult result_;
};

}  // namespace hapbench
