#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "results/observe/metric_observer.hpp"
#include "sim/loop/integrators/table.hpp"
#include "sim/loop/observed_energy.hpp"

namespace hapbench {

/// Energy balance of a run since its first row [J].
///
///   kinetic + stored = initial ones + input + damping + rotation + created + integration + script + residual
///   input = hand + actuator                                        (when the handle is the tool)
///   device.stored = device.hand + device.actuator + device.dissipated   (when it has mechanics of its own)
///
/// A tool that a handle moves has no virtual mass: kinetic, input and residual are zero, the work of a force is the
/// row's force times the displacement to the next row, and script is the work of the handle on the rendering.
///
/// If the integrator holds the row's force over the step (leapfrog), the work of a force is the row's force times dt
/// times the mean of the velocities before and after the step, which equals its contribution to the kinetic energy
/// exactly. Other integrators evaluate forces at intermediate states that are not recorded. For them, work is the mean
/// of the forces of both rows (f_in is held) times the displacement between the rows, and the difference to the change
/// of kinetic energy counts as the integrator's. A prescribed motion is treated alike, but what is left is the work of
/// the script: nothing is integrated. Where a contact of stiffness K begins or ends between two rows d apart, the
/// trapezoidal rule is off by up to K d^2 / 8.
struct EnergyBalance {
  double kinetic = 0.0;  ///< of the virtual mass, now
  double stored = 0.0;   ///< elastic energy of the penalty springs, now
  double input = 0.0;    ///< work of f_in on the tool
  double spring = 0.0;   ///< work of f_spring on the tool
  /// Work of damping, friction and the force limit: of f_render - f_spring. It includes angular damping, which may
  /// transfer energy from the tool's rotation, which has no balance of its own, to the tip's translation.
  double damping = 0.0;
  double rotation = 0.0;  ///< work of the tool's rotation on the springs: a torque that the device cannot render
  /// Energy stored in the springs beyond the work that translation and rotation did on them (trapezoidal rule): zero
  /// for linear springs in lasting contact; contacts that appear, vanish or change their weight create or destroy it.
  double created = 0.0;
  /// Energy made by the integrator, or by holding a device's force: `spring` plus the work of translation on the
  /// springs (leapfrog and held forces).
  double integration = 0.0;
  double script = 0.0;    ///< work of the prescribed motion, or of the handle that moves the tool
  double residual = 0.0;  ///< kinetic energy not explained by the terms above (free position): rounding errors
  double hand = 0.0;      ///< work of the hand on the handle
  double actuator = 0.0;  ///< work of the actuators: against the hand (ideal device) or on the carriage
  std::optional<DeviceEnergy> device;  ///< for devices with mechanics of their own
};

/// A step in which the rendering created energy.
struct EnergyEvent {
  std::uint64_t step = 0;  ///< the row at whose contacts it appeared
  double time = 0.0;       ///< [s]
  double created = 0.0;    ///< [J], > 0
  std::size_t colliding_before = 0, colliding_after = 0;
  std::size_t rendered_before = 0, rendered_after = 0;
  std::size_t appeared = 0;  ///< rendered contacts that were not rendered in the row before
  std::size_t vanished = 0;  ///< contacts of the row before that are not rendered any more
};

/// Keeps the balance row by row. Allocates in the constructor and in `begin` only; about 100 ns a row.
class EnergyLedger final : public MetricObserver {
 public:
  static constexpr std::size_t kEvents = 10;

  /// `mass` of the virtual tool [kg], time step `dt` [s], most contacts of a row, `integrator` of a free position.
  EnergyLedger(double mass, double dt, bool position_is_free, std::size_t capacity,
               const IntegratorEntry& integrator = kLeapfrog);
  /// To be given all that by `begin`.
  EnergyLedger() : EnergyLedger(0.0, 0.0, true, 0) {}

  void begin(const TrialParts& trial) override;
  bool wants_energy() const noexcept override { return true; }
  void on_step(const StepRecord& record) noexcept override;

  void tell(Section& section) const override;
  /// Adds "events": events() as a list of objects.
  void add_members(nlohmann::ordered_json& section) const override;

  const EnergyBalance& balance() const noexcept { return balance_; }
  /// The steps that created the most energy, largest first.
  std::span<const EnergyEvent> events() const noexcept;

 private:
  /// Work of each force over the step before a row [J].
  struct Works {
    double input = 0.0, hand = 0.0, actuator = 0.0;
    double spring = 0.0, damping = 0.0;
    double left = 0.0;  ///< change of kinetic energy that these works do not explain: the integrator's error
  };
  /// Works of f_spring and f_render along the displacement `way` [m]; f_in and the hand's force are held constant.
  Works works(const Vec3& spring, const Vec3& rendered, const Vec3& way) const noexcept;
  Works works_until(const StepRecord& now) const noexcept;
  void add_step(const StepRecord& now) noexcept;
  double created_in_step(const StepRecord& now, double spring_work) noexcept;
  void note_event(const StepRecord& now, double created) noexcept;

  double mass_;
  double dt_;
  bool free_;
  bool row_force_moves_;  ///< the row's force acts during the whole step
  bool has_row_ = false;
  StepRecord last_;                                      ///< the row before, but for its contacts
  std::vector<std::uint32_t> rendered_, last_rendered_;  ///< sorted shell indices of this row and of that
  EnergyBalance balance_;
  double kinetic_at_start_ = 0.0;
  double left_ = 0.0;  ///< sum of Works::left
  double created_sum_ = 0.0;
  double created_max_ = 0.0;
  double residual_max_ = 0.0;
  std::array<EnergyEvent, kEvents> events_{};  ///< largest first; unused entries have created = 0
};

/// Tells whether a rendering was passive: extremes of its observed energy E (sim/loop/observed_energy.hpp), of the
/// first trial that created the most. Constant memory; about 100 ns a row with a turning moment, 4 ns without force.
class PassivityObserver final : public MetricObserver {
 public:
  /// `dt`: time from row to row [s]; `position_is_free`: the motion is not prescribed. `begin` sets both.
  explicit PassivityObserver(double dt = 0.0, bool position_is_free = true) : observed_(dt, position_is_free) {}

  void begin(const TrialParts& trial) override;
  bool wants_springs() const noexcept override { return true; }
  void on_step(const StepRecord& record) noexcept override;
  void tell(Section& section) const override;

  /// Energy that the rendering created in the trial begun last, max(0, -E_min) [J]; NaN if any rendered force was.
  double net_created() const noexcept { return now_.net_created(); }

 private:
  struct Extremes {
    bool rows = false;         ///< a row had a force or a moment
    double energy_min = 0.0;   ///< least E of a row [J]; negative when the rendering gave more than it had
    double time_of_min = 0.0;  ///< of the first row that has it [s]
    double energy_end = 0.0;   ///< E of the last row [J], once the trial has ended
    double net_created() const noexcept { return energy_min >= 0.0 ? 0.0 : -energy_min; }
  };
  Extremes worst() const noexcept;

  ObservedEnergy observed_;
  Extremes now_, worst_before_;  ///< of this trial, and the worst of the earlier ones
};

}  // namespace hapbench
