#pragma once

#include <cstdint>

#include "results/io/table_writer.hpp"
#include "results/observe/energy_ledger.hpp"
#include "results/record/recorder.hpp"

namespace hapbench {

/// energy.csv: the energy balance of every recorded row, summed since the first one (EnergyBalance says what is what).
/// Device columns are empty when the handle is the tool.
class EnergyRecorder final : public Recorder {
 public:
  static constexpr Column kColumns[] = {
      kStepColumn,
      kTimeColumn,
      {"kinetic_J", "J", "kinetic energy of the virtual mass, now"},
      {"stored_J", "J", "elastic energy of the penalty springs, now"},
      {"input_J", "J", "work of f_in on the tool since the first row"},
      {"spring_J", "J", "work of f_spring on the tool since the first row"},
      {"damping_J", "J", "work of damping, friction and force limit, of f - f_spring, since the first row"},
      {"rotation_J", "J", "what the tool's turning put into the springs since the first row"},
      {"created_J", "J", "what the springs store beyond the work that translation and rotation did on them"},
      {"integration_J", "J", "energy made by the integrator since the first row"},
      {"script_J", "J", "work of a prescribed motion since the first row"},
      {"residual_J", "J", "kinetic energy that the other terms do not explain: rounding"},
      {"hand_J", "J", "work of the hand on the handle since the first row"},
      {"actuator_J", "J", "work of the device's actuators since the first row"},
      {"device_dissipated_J", "J", "what the device's mechanics dissipated; empty when the handle is the tool"},
      {"device_stored_J", "J", "what the device's mechanics store, now; empty when the handle is the tool"}};

  /// Keeps rows 0, every, 2 every, … Must observe after `ledger`, which it reads. Precondition: every > 0. Throws
  /// IoError.
  EnergyRecorder(TableTarget target, std::uint64_t every, const EnergyLedger& ledger);

  void on_step(const StepRecord& record) noexcept override;
  void finish() override { writer_.finish(); }

 private:
  TableWriter writer_;
  std::uint64_t every_;
  const EnergyLedger* ledger_;
};

}  // namespace hapbench
