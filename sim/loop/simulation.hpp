#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/contact/contact_source.hpp"
#include "sim/core/skips.hpp"
#include "sim/loop/device.hpp"
#include "sim/loop/force_algorithm.hpp"
#include "sim/loop/hand.hpp"
#include "sim/loop/integrators/table.hpp"
#include "sim/loop/observer.hpp"
#include "sim/tool/motion.hpp"
#include "sim/tool/tool_shape.hpp"

namespace hapbench {

/// How a run ended, from the best to the worst: several trials end as the worst of them does.
enum class Outcome {
  completes,        ///< all steps done, or the hand has finished its task
  leaves_hole,      ///< the tip centre rose above height 0 (stop_rules.hpp)
  tool_horizontal,  ///< the axis reached the horizontal plane (stop_rules.hpp)
  not_dragged,      ///< all steps done, but a hand that drags led the tool nowhere (scenarios/run/encounter.hpp)
  no_contact,       ///< all steps done, and the tool never touched the environment (there, too)
  lost_contact,     ///< all steps done, but the tool left the environment behind (there, too)
  diverges          ///< a value stopped being finite or left its bound
};

/// Ends a run early: after the first row for whose tool `holds` is true.
struct StopRule {
  Outcome outcome;
  std::function<bool(const ToolState& tool)> holds;
};

/// A run beyond these is stopped as diverged: absurd for a dental drill, still far from overflow.
struct DivergenceBounds {
  double position = 1e3;  ///< of tool and handle [m]
  double speed = 1e6;     ///< of tool and handle [m/s]
  double force = 1e12;    ///< f_render and f_meas [N]
};

/// Numbers of one run.
struct SimulationConfig {
  double dt = 0.0005;                              ///< [s]
  std::uint64_t steps = 0;                         ///< rows 0 … steps - 1
  double mass = 0.2;                               ///< of the virtual tool, if there is one [kg]
  const IntegratorEntry* integrator = &kLeapfrog;  ///< of a virtual tool whose position is free; never null
  Vec3 position = Vec3::Zero();     ///< of the tip centre at t = 0 [m]; ignored when the motion prescribes it
  Vec3 velocity = Vec3::Zero();     ///< [m/s]
  std::vector<StopRule> stop_when;  ///< if several hold, the first one counts
  DivergenceBounds bounds;
  Skips skips = Skips::taken;  ///< ratios and energies that no observer wants
};

/// The parts a run is made of; the simulation owns them.
struct SimulationParts {
  std::shared_ptr<const ToolShape> tool;
  std::shared_ptr<const PointShell> shell;   ///< null for springs
  std::shared_ptr<const SpringSet> springs;  ///< null for a shell
  std::unique_ptr<ContactSource> source;     ///< of contacts with either
  std::unique_ptr<ForceAlgorithm> algorithm;
  std::unique_ptr<Motion> motion;
  std::unique_ptr<Hand> hand;
  std::unique_ptr<Device> device;
};

/// Where a diverged run left its bounds; the row is not passed to observers.
struct Divergence {
  std::uint64_t step = 0;
  double time = 0.0;          ///< [s]
  const char* quantity = "";  ///< as in "position", "handle velocity" or "rendered force"
  double magnitude = 0.0;     ///< its norm, possibly not finite
  double bound = 0.0;
  std::string fault = {};  ///< the reason, where the source of contacts or the algorithm knows it; mostly empty
};

struct SimulationResult {
  Outcome outcome = Outcome::completes;
  std::uint64_t rows = 0;  ///< rows observed
  Divergence divergence;   ///< meaningful when the outcome is `diverges`
};

/// The step loop: hand -> device -> contacts -> force algorithm -> observers -> integrator, or device again where its
/// handle moves the tool. Owns the contact buffer and allocates only in the constructor.
class Simulation {
 public:
  /// Prepares the algorithm. Observers must outlive the simulation. Throws what `prepare` throws.
  Simulation(SimulationConfig config, SimulationParts parts, std::vector<Observer*> observers);
  // The algorithm has pointers to the row (Scene).
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;

  /// Back to t = 0, bit for bit (observers keep what they saw).
  void reset() noexcept;
  /// Evaluates row k, shows it to the observers and moves on to row k + 1. Returns false, and does nothing, once the
  /// run has ended. Allocates nothing.
  bool step() noexcept;
  /// Takes up to so many steps; returns false once the run has ended.
  bool advance(std::uint64_t steps) noexcept;
  /// Steps to the end.
  SimulationResult run() noexcept;

  const SimulationResult& result() const { return result_; }
  std::uint64_t next_row() const { return row_; }
  const ToolState& tool() const { return tool_; }
  const ContactSource& source() const { return *parts_.source; }
  const ForceAlgorithm& algorithm() const { return *parts_.algorithm; }

 private:
  class Surroundings;

  void move_tool_by_force() noexcept;
  void move_tool_by_script() noexcept;
  void put_tool_on_handle() noexcept;
  double roll_at(double t) const noexcept;
  Vec3 angular_velocity_after(double part, const Vec3& axis, double roll) const noexcept;
  void note_springs() noexcept;
  bool check_bounds() noexcept;
  bool check_stop_rules() noexcept;
  void end(Outcome outcome) noexcept;

  SimulationConfig config_;
  SimulationParts parts_;
  std::unique_ptr<Integrator> integrator_;
  std::vector<Observer*> observers_;
  bool ratio_wanted_ = false;
  bool springs_wanted_ = false;
  bool energy_wanted_ = false;
  bool position_is_free_ = false;
  bool tool_rolls_ = false;   ///< it is no solid of revolution
  bool turn_rolls_ = false;   ///< the turn about its axis belongs to its angular velocity
  bool roll_wanted_ = false;  ///< somebody reads it
  bool handle_is_apart_ = false;                   ///< the handle is a body of its own
  bool handle_moves_tool_ = false;                 ///< and there is no virtual mass
  std::optional<double> angular_velocity_cutoff_;  ///< none: nobody wants it
  ContactBuffer contacts_;

  std::uint64_t row_ = 0;
  bool ended_ = false;
  ToolState tool_;
  double roll_ = 0.0;  ///< of the row; 0 unless wanted
  StepRecord record_;
  RenderedForce within_step_;   ///< of the last state an integrator asked about
  bool springs_noted_ = false;  ///< record_.springs are not zero
  SimulationResult result_;
};

}  // namespace hapbench
