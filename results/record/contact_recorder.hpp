#pragma once

#include <cstdint>
#include <filesystem>

#include "results/io/csv_writer.hpp"
#include "results/record/recorder.hpp"

namespace hapbench {

/// contacts.csv: one line per rendered contact of each recorded row, in the order the force law saw them. `index` is
/// the shell point's or spring's; x, y, z the colliding point; n the environment's outward normal; the gradient points
/// to where the point would leave the tool; the weight is the law's c_i (0 for laws without weights).
class ContactRecorder final : public Recorder {
 public:
  static constexpr const char* kHeader =
      "step,time_s,index,x_m,y_m,z_m,nx,ny,nz,depth_m,gradient_x,gradient_y,gradient_z,weight";

  /// Keeps rows 0, every, 2 every, … Precondition: every > 0. Throws IoError.
  explicit ContactRecorder(std::filesystem::path file, std::uint64_t every = 1);

  void on_step(const StepRecord& record) noexcept override;
  void finish() override { csv_.finish(); }

 private:
  CsvWriter csv_;
  std::uint64_t every_;
};

}  // namespace hapbench
