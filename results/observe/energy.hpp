#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "results/observe/metric_observer.hpp"
#include "sim/loop/integrators/table.hpp"
#include "sim/loop/observed_energy.hpp"

namespace hapbench {

/// Energy balance of a run since its first step [J].
///
///   kinetic + stored = initial values + input + damping + rotation + created + integration + script + residual
///   input = hand + actuator                                        (when the handle is the tool)
///   device.stored = device.hand + device.actuator + device.dissipated   (when the device has its own mechanics;
///                                                                    device.dissipated <= 0)
///
/// A tool that follows the handle has no virtual mass. Then kinetic, input and residual are zero, the work of a
/// force is the force of a step times the displacement to the next step, and script is the work of the handle
/// against the rendered force.
///
/// If the integrator holds the force of a step until the next step (leapfrog), the work is force times dt times the
/// mean of the velocities at the beginning and at the end of the step: exactly the change of the kinetic energy. Other
/// integrators evaluate forces at states that are not recorded. For other integrators, the work is the displacement
/// between two successive steps times the mean of the forces of these steps; f_in, which is constant between the steps,
/// is taken from the first step. The remaining change of kinetic energy is assigned to the integrator. A prescribed
/// motion is treated the same way, but the remainder is the work of the script. If the tool moves by a distance d
/// between two steps, and a contact of stiffness K begins or ends between them, the trapezoidal rule has an error of up
/// to K d^2 / 8.
struct EnergyBalance {
  double kinetic = 0.0, stored = 0.0;  ///< current energy of the virtual mass and of the penalty springs
  double input = 0.0, spring = 0.0;    ///< work of f_in and f_spring on the tool
  /// Work of f_render - f_spring: damping, friction and the force limit. With angular damping, part of this work may
  /// come from the tool's rotation, which has no energy balance.
  double damping = 0.0;
  /// Work that the tool's rotation does on the springs, against their torque. The device does not render this torque.
  double rotation = 0.0;
  /// Energy stored in the springs beyond the work done on them by translation and rotation (trapezoidal rule). Contacts
  /// that appear, vanish or change their weight create this energy. It is zero for linear springs in permanent contact.
  double created = 0.0;
  /// Energy created by the integrator, or by the zero-order hold of a device's force. If the force is held over a
  /// step (leapfrog, or a device), it is the sum of two works: the work of f_spring on the tool (`spring`), and the
  /// work of the tool's translation on the springs (trapezoidal rule).
  double integration = 0.0;
  double script = 0.0;  ///< work of the prescribed motion, or of the handle that moves the tool
  /// If the position is free: change of kinetic energy that no other term explains, which consists of rounding errors.
  double residual = 0.0;
  double hand = 0.0, actuator = 0.0;   ///< works of the hand on the handle and of the actuators on handle or carriage
  std::optional<DeviceEnergy> device;  ///< empty for devices without mechanics
};

/// A step in which the rendered springs created energy.
struct EnergyEvent {
  std::uint64_t step = 0;  ///< step in which the energy appeared
  double time = 0.0;       ///< [s]
  double created = 0.0;    ///< energy created in this step [J], > 0
  /// Number of colliding and of rendered contacts. Entry 0: in the previous step; entry 1: in this step.
  std::array<std::size_t, 2> colliding{}, rendered{};
  /// appeared: number of rendered contacts that exist in this step but not in the previous step. vanished: number of
  /// rendered contacts that exist in the previous step but not in this step.
  std::size_t appeared = 0, vanished = 0;
};

/// Updates the energy balance in every step. Allocates only in the constructor and in `begin`; about 100 ns a step.
class EnergyLedger final : public MetricObserver {
 public:
  static constexpr std::size_t kEvents = 10;

  /// `mass`: virtual mass [kg]. `dt`: time step [s]. `capacity`: largest number of contacts in a step.
  /// `integrator`: integrator of a free position. `begin` sets all of them from the trial.
  explicit EnergyLedger(double mass = 0.0, double dt = 0.0, bool position_is_free = true, std::size_t capacity = 0,
                        const IntegratorEntry& integrator = kLeapfrog);

  void begin(const TrialParts& trial) override;
  bool wants_energy() const noexcept override { return true; }
  void on_step(const StepRecord& record) noexcept override;

  void report(Section& section) const override;
  /// Adds "events": events() as a list of objects.
  void add_members(nlohmann::ordered_json& section) const override;

  const EnergyBalance& balance() const noexcept { return balance_; }
  /// The kEvents steps that created the most energy, largest first.
  std::span<const EnergyEvent> events() const noexcept {
    return {events_.begin(), std::ranges::find(events_, 0.0, &EnergyEvent::created)};
  }

 private:
  /// Work of each force from the previous step to this step [J].
  struct Works {
    double input = 0.0, hand = 0.0, actuator = 0.0;
    double spring = 0.0, damping = 0.0;
    double unexplained = 0.0;  ///< change of kinetic energy that these works do not explain: the integrator's error
  };
  /// Returns the works of all forces along `displacement` [m]. `spring` is f_spring and `rendered` is f_render [N];
  /// f_in and the hand's force have their values of the previous step.
  Works works(const Vec3& spring, const Vec3& rendered, const Vec3& displacement) const noexcept;
  Works works_until(const StepRecord& now) const noexcept;
  void add_step(const StepRecord& now) noexcept;
  double created_in_step(const StepRecord& now, double spring_work) noexcept;
  void add_event(const StepRecord& now, double created) noexcept;

  double mass_, dt_;
  /// position_is_free_: true if the position is not prescribed. holds_force_: true if the integrator holds the force
  /// of a step until the next step.
  bool position_is_free_, holds_force_;
  bool has_row_ = false;
  StepRecord last_;  ///< the previous step, without its contacts
  /// Sorted shell indices of the rendered contacts of this step and the previous step.
  std::vector<std::uint32_t> rendered_, last_rendered_;
  EnergyBalance balance_;
  double kinetic_at_start_ = 0.0, unexplained_ = 0.0;  ///< unexplained_: sum of Works::unexplained
  double created_sum_ = 0.0, created_max_ = 0.0, residual_max_ = 0.0;
  std::array<EnergyEvent, kEvents> events_{};  ///< largest first; unused entries have created = 0
};

/// Reports whether the rendering was passive: extremes of the observed energy E (sim/loop/observed_energy.hpp). After
/// several trials, reports the trial that created the most energy. If several trials created equal energy, reports the
/// first of them. Constant memory. A step with a moment and a turning tool takes about 100 ns, a step without force 4
/// ns.
class PassivityObserver final : public MetricObserver {
 public:
  /// `dt`: time step [s]; `position_is_free`: true if the position is not prescribed. `begin` sets both.
  explicit PassivityObserver(double dt = 0.0, bool position_is_free = true) : observed_(dt, position_is_free) {}

  void begin(const TrialParts& trial) override;
  bool wants_springs() const noexcept override { return true; }
  void on_step(const StepRecord& record) noexcept override;
  void report(Section& section) const override;

  /// Returns the energy that the rendering created in the current trial, max(0, -E_min) [J]; NaN if any rendered
  /// force was NaN.
  double net_created() const noexcept { return now_.net_created(); }

 private:
  struct Extremes {
    bool rows = false;  ///< true if there was a step with a force or a moment
    /// Smallest value of the accumulated energy E over all steps [J]; negative if the rendering gave more energy than
    /// it had received.
    double energy_min = 0.0;
    double time_of_min = 0.0;  ///< time of the first step with E = energy_min [s]
    double energy_end = 0.0;   ///< E at the last step [J], valid after the end of the trial
    double net_created() const noexcept { return energy_min >= 0.0 ? 0.0 : -energy_min; }
  };
  Extremes worst() const noexcept;

  ObservedEnergy observed_;
  Extremes now_, worst_before_;  ///< extremes of this trial, and of the earlier trial that created the most energy
};

}  // namespace hapbench
