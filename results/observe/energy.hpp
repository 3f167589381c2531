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

/// Energy balance of a run since its first row [J].
///
///   kinetic + stored = initial ones + input + damping + rotation + created + integration + script + residual
///   input = hand + actuator                                        (when the handle is the tool)
///   device.stored = device.hand + device.actuator + device.dissipated   (when it has mechanics of its own)
///
/// A tool that a handle moves has no virtual mass: kinetic, input and residual are zero, the work of a force is the
/// row's force times the displacement to the next row, and script is the work of the handle on the rendering.
///
/// If the integrator holds the row's force over the step (leapfrog), its work is force times dt times the mean of the
/// velocities before and after the step: exactly what it adds to the kinetic energy. Other integrators evaluate forces
/// at states that are not recorded: for them, work is the mean of the forces of both rows (f_in is held) times the
/// displacement between these, and the rest of the change of kinetic energy counts as the integrator's. So it is along
/// a prescribed motion, where the rest is the work of the script. Where a contact of stiffness K begins or ends between
/// two rows d apart, the trapezoidal rule is off by up to K d^2 / 8.
struct EnergyBalance {
  double kinetic = 0.0, stored = 0.0;  ///< of the virtual mass and of the penalty springs, now
  double input = 0.0, spring = 0.0;    ///< work of f_in and f_spring on the tool
  /// Work of f_render - f_spring: of damping, friction and the force limit. With angular damping, it may come from the
  /// tool's rotation, which has no balance of its own.
  double damping = 0.0;
  double rotation = 0.0;  ///< work of the tool's rotation on the springs: a torque that the device cannot render
  /// Energy stored in the springs beyond the work that translation and rotation did on them (trapezoidal rule): of
  /// contacts that appear, vanish or change their weight; zero for linear springs in lasting contact.
  double created = 0.0;
  /// Energy made by the integrator, or by holding a device's force: `spring` plus the work of translation on the
  /// springs (leapfrog and held forces).
  double integration = 0.0;
  double script = 0.0;    ///< work of the prescribed motion, or of the handle that moves the tool
  double residual = 0.0;  ///< kinetic energy not explained by the terms above (free position): rounding errors
  double hand = 0.0, actuator = 0.0;   ///< work of the hand on the handle; of actuators against it or on the carriage
  std::optional<DeviceEnergy> device;  ///< for devices with mechanics of their own
};

/// A step in which the rendering created energy.
struct EnergyEvent {
  std::uint64_t step = 0;                              ///< the row at whose contacts it appeared
  double time = 0.0;                                   ///< [s]
  double created = 0.0;                                ///< [J], > 0
  std::array<std::size_t, 2> colliding{}, rendered{};  ///< contacts, in the row before and in this one
  std::size_t appeared = 0, vanished = 0;              ///< rendered ones of this row only, and of that before only
};

/// Keeps the balance row by row. Allocates in the constructor and in `begin` only; about 100 ns a row.
class EnergyLedger final : public MetricObserver {
 public:
  static constexpr std::size_t kEvents = 10;

  /// `mass` of the virtual tool [kg], time step `dt` [s], most contacts of a row, `integrator` of a free position.
  /// `begin` sets them all.
  explicit EnergyLedger(double mass = 0.0, double dt = 0.0, bool position_is_free = true, std::size_t capacity = 0,
                        const IntegratorEntry& integrator = kLeapfrog);

  void begin(const TrialParts& trial) override;
  bool wants_energy() const noexcept override { return true; }
  void on_step(const StepRecord& record) noexcept override;

  void tell(Section& section) const override;
  /// Adds "events": events() as a list of objects.
  void add_members(nlohmann::ordered_json& section) const override;

  const EnergyBalance& balance() const noexcept { return balance_; }
  /// The steps that created the most energy, largest first.
  std::span<const EnergyEvent> events() const noexcept {
    return {events_.begin(), std::ranges::find(events_, 0.0, &EnergyEvent::created)};
  }

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

  double mass_, dt_;
  bool free_, row_force_moves_;  ///< the row's force acts during the whole step
  bool has_row_ = false;
  StepRecord last_;                                      ///< the row before, but for its contacts
  std::vector<std::uint32_t> rendered_, last_rendered_;  ///< sorted shell indices of this row and of that
  EnergyBalance balance_;
  double kinetic_at_start_ = 0.0, left_ = 0.0;  ///< left: sum of Works::left
  double created_sum_ = 0.0, created_max_ = 0.0, residual_max_ = 0.0;
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
