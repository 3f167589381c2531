#pragma once

#include <cstdint>
#include <filesystem>

#include "results/io/csv_writer.hpp"
#include "results/record/recorder.hpp"

namespace hapbench {

/// trajectory.csv: one line per recorded row with pose, velocity, forces, handle and contact counts, everything before
/// the integrator moves the tool. f_spring and f_render (columns fspring, f) act on the tool; fmeas is what the sensor
/// read, fin what the input-force limiter made of it; h is the handle. depth_max_m is over the colliding points before
/// any point stage, 0 without contact; ratio_* are over the rendered points and empty when there is none.
class TrajectoryRecorder final : public Recorder {
 public:
  static constexpr const char* kHeader =
      "step,time_s,px_m,py_m,pz_m,vx_m_per_s,vy_m_per_s,vz_m_per_s,axis_x,axis_y,axis_z,"
      "fx_N,fy_N,fz_N,fspring_x_N,fspring_y_N,fspring_z_N,fmeas_x_N,fmeas_y_N,fmeas_z_N,fin_x_N,fin_y_N,fin_z_N,"
      "hx_m,hy_m,hz_m,colliding,rendered,depth_max_m,ratio_min,ratio_max";

  /// Keeps rows 0, every, 2 every, … Precondition: every > 0. Throws IoError.
  explicit TrajectoryRecorder(std::filesystem::path file, std::uint64_t every = 1);

  bool wants_ratio() const noexcept override { return true; }
  void on_step(const StepRecord& record) noexcept override;
  void finish() override { csv_.finish(); }

 private:
  CsvWriter csv_;
  std::uint64_t every_;
};

}  // namespace hapbench
