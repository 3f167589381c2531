#pragma once

#include "results/io/table_writer.hpp"
#include "results/observe/force_fidelity.hpp"
#include "results/record/recorder.hpp"

namespace hapbench {

/// force_reference.csv: the reference force, measured with the stroke or ideal, beside what is rendered at the same
/// place.
class ForceReferenceRecorder final : public Recorder {
 public:
  static constexpr Column kColumns[] = {
      kStepColumn,
      kTimeColumn,
      {"mfx_N", "N", "x of the reference force f_m on the tool; empty where none was measured"},
      {"mfy_N", "N", "y of f_m"},
      {"mfz_N", "N", "z of f_m"},
      {"force_error_x_N", "N", "x of f - f_m"},
      {"force_error_y_N", "N", "y of f - f_m"},
      {"force_error_z_N", "N", "z of f - f_m"}};

  /// Keeps rows 0, every, 2 every, …; must observe after `observer`. Throws IoError.
  ForceReferenceRecorder(TableTarget target, std::uint64_t every, const ForceFidelityObserver& observer);

  void on_step(const StepRecord& record) noexcept override;
  void finish() override { writer_.finish(); }

 private:
  TableWriter writer_;
  std::uint64_t every_;
  const ForceFidelityObserver* observer_;
};

}  // namespace hapbench
