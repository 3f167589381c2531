#pragma once

#include <cstdint>
#include <vector>

#include "results/io/table_writer.hpp"
#include "results/record/recorder.hpp"
#include "sim/contact/contact_buffer.hpp"

namespace hapbench {

/// Stiffness shaping as two operations on padded contacts. They are handed in because this folder knows no force law.
struct ShapingOperations {
  /// Sets all weights to 1; returns the stiffness tensor S.
  Mat3 (*start)(ContactBuffer& contacts) noexcept = nullptr;
  /// One update of the weights, given the S of the present ones; returns the new S.
  Mat3 (*update)(ContactBuffer& contacts, const Mat3& S) noexcept = nullptr;
};

/// ratios.csv: how the stiffness ratios of the rendered contacts converge with the number of shaping updates
/// (thesis 3.4, Fig. 5). For each recorded row with contact and each requested iteration m: the smallest and largest
/// ratio and the largest eigenvalue of S after m updates from equal weights 1, whatever law the run uses. Works on a
/// copy of the contacts, so the run does not notice. O(n) per update, m updates in all, for the largest requested m.
class RatioRecorder final : public Recorder {
 public:
  static constexpr Column kColumns[] = {
      kStepColumn,
      kTimeColumn,
      {"iteration", "1", "number m of shaping updates, from equal weights 1"},
      {"rendered", "1", "points that the force law saw"},
      {"ratio_min", "1", "smallest stiffness ratio u^T S u of a rendered contact after m updates"},
      {"ratio_max", "1", "largest stiffness ratio u^T S u of a rendered contact after m updates"},
      {"lambda_max", "1", "largest eigenvalue of S after m updates: the stiffness in units of K"}};

  /// Keeps rows 0, every, 2 every, … `capacity`: the most contacts a row can have (ContactQuery::capacity).
  /// `iterations` in any order, duplicates count once. Precondition: every > 0, iterations >= 0. Throws IoError.
  RatioRecorder(TableTarget target, std::uint64_t every, std::vector<int> iterations, ShapingOperations shaping,
                std::size_t capacity);

  void on_step(const StepRecord& record) noexcept override;
  void finish() override { writer_.finish(); }

 private:
  TableWriter writer_;
  std::uint64_t every_;
  std::vector<int> iterations_;  ///< ascending, unique
  ShapingOperations shaping_;
  ContactBuffer contacts_;
};

}  // namespace hapbench
