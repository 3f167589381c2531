#pragma once

#include <cstdint>

#include "results/io/table_writer.hpp"
#include "results/record/recorder.hpp"

namespace hapbench {

/// stiffness_tensor.csv: for each recorded row the six entries of the stiffness tensor S that the algorithm rendered
/// with and its largest eigenvalue, in units of K; e^T S e is the stiffness along a direction e. Zeros without contact.
class StiffnessRecorder final : public Recorder {
 public:
  static constexpr Column kColumns[] = {
      kStepColumn,
      kTimeColumn,
      {"sxx", "1", "entry xx of the stiffness tensor S that the force was rendered with, in units of K"},
      {"sxy", "1", "entry xy of S"},
      {"sxz", "1", "entry xz of S"},
      {"syy", "1", "entry yy of S"},
      {"syz", "1", "entry yz of S"},
      {"szz", "1", "entry zz of S"},
      {"lambda_max", "1", "largest eigenvalue of S"}};

  /// Keeps rows 0, every, 2 every, … Precondition: every > 0. Throws IoError.
  explicit StiffnessRecorder(TableTarget target, std::uint64_t every = 1);

  void on_step(const StepRecord& record) noexcept override;
  void finish() override { writer_.finish(); }

 private:
  TableWriter writer_;
  std::uint64_t every_;
};

}  // namespace hapbench
