#pragma once

#include <cstdint>

#include "results/io/table_writer.hpp"
#include "results/record/recorder.hpp"

namespace hapbench {

/// contacts.csv: one line per rendered contact of each recorded row, in the order the force law saw them. `index` is
/// the shell point's or spring's; x, y, z the colliding point; n the environment's outward normal; the gradient points
/// to where the point would leave the tool; the weight is the law's c_i (0 for laws without weights).
class ContactRecorder final : public Recorder {
 public:
  static constexpr Column kColumns[] = {
      kStepColumn,
      kTimeColumn,
      {"index", "1", "number of the shell point, spring or, of another library's contact, triangle, from 0"},
      {"x_m", "m", "x of the colliding point"},
      {"y_m", "m", "y of the colliding point"},
      {"z_m", "m", "z of the colliding point"},
      {"nx", "1", "x of the environment's outward unit normal there"},
      {"ny", "1", "y of the environment's outward unit normal there"},
      {"nz", "1", "z of the environment's outward unit normal there"},
      {"depth_m", "m", "penetration depth d, by the depth model"},
      {"gradient_x", "1", "x of the unit gradient u, along which the point would leave the tool"},
      {"gradient_y", "1", "y of the unit gradient u"},
      {"gradient_z", "1", "z of the unit gradient u"},
      {"weight", "1", "c_i of the law; 0 for laws without weights"}};

  /// Keeps rows 0, every, 2 every, … Precondition: every > 0. Throws IoError.
  explicit ContactRecorder(TableTarget target, std::uint64_t every = 1);

  void on_step(const StepRecord& record) noexcept override;
  void finish() override { writer_.finish(); }

 private:
  TableWriter writer_;
  std::uint64_t every_;
};

}  // namespace hapbench
