#pragma once

#include <cstdint>
#include <filesystem>

#include "results/io/csv_writer.hpp"
#include "results/observe/energy_ledger.hpp"
#include "results/record/recorder.hpp"

namespace hapbench {

/// energy.csv: the energy balance of every recorded row, summed since the first one (EnergyBalance says what is what).
/// Device columns are empty when the handle is the tool.
class EnergyRecorder final : public Recorder {
 public:
  static constexpr const char* kHeader =
      "step,time_s,kinetic_J,stored_J,input_J,spring_J,damping_J,rotation_J,created_J,integration_J,script_J,residual_"
      "J,"
      "hand_J,actuator_J,device_dissipated_J,device_stored_J";

  /// Keeps rows 0, every, 2 every, … Must observe after `ledger`, which it reads. Precondition: every > 0. Throws
  /// IoError.
  EnergyRecorder(std::filesystem::path file, std::uint64_t every, const EnergyLedger& ledger);

  void on_step(const StepRecord& record) noexcept override;
  void finish() override { csv_.finish(); }

 private:
  CsvWriter csv_;
  std::uint64_t every_;
  const EnergyLedger* ledger_;
};

}  // namespace hapbench
