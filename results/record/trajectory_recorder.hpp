#pragma once

#include <cstdint>

#include "results/io/table_writer.hpp"
#include "results/record/recorder.hpp"

namespace hapbench {

/// What trajectory.csv has beyond its usual columns.
struct TrajectoryExtras {
  bool pose = false;    ///< record.pose
  bool torque = false;  ///< record.torque
};

/// trajectory.csv: one line per recorded row with pose, velocity, forces, handle and contact counts, everything before
/// the integrator moves the tool. f_spring and f_render (columns fspring, f) act on the tool; fmeas is what the sensor
/// read, fin what the input-force limiter made of it; h is the handle. depth_max_m is over the colliding points before
/// any point stage, 0 without contact; ratio_* are over the rendered points and empty when there is none. The torque is
/// SpringState::moment.
class TrajectoryRecorder final : public Recorder {
 public:
  static constexpr Column kColumns[] = {
      kStepColumn,
      kTimeColumn,
      {"px_m", "m", "x of the tip's centre"},
      {"py_m", "m", "y of the tip's centre"},
      {"pz_m", "m", "z of the tip's centre"},
      {"vx_m_per_s", "m/s", "x of its velocity"},
      {"vy_m_per_s", "m/s", "y of its velocity"},
      {"vz_m_per_s", "m/s", "z of its velocity"},
      {"axis_x", "1", "x of the tool's axis, the unit vector out of the tip"},
      {"axis_y", "1", "y of the tool's axis"},
      {"axis_z", "1", "z of the tool's axis"},
      {"fx_N", "N", "x of f = f_render, the rendered force on the tool"},
      {"fy_N", "N", "y of f"},
      {"fz_N", "N", "z of f"},
      {"fspring_x_N", "N", "x of f_spring, the part of f before damping, friction and limits"},
      {"fspring_y_N", "N", "y of f_spring"},
      {"fspring_z_N", "N", "z of f_spring"},
      {"fmeas_x_N", "N", "x of f_meas, what the force sensor read of the hand"},
      {"fmeas_y_N", "N", "y of f_meas"},
      {"fmeas_z_N", "N", "z of f_meas"},
      {"fin_x_N", "N", "x of f_in, what the input-force limiter made of f_meas: it moves the tool with f"},
      {"fin_y_N", "N", "y of f_in"},
      {"fin_z_N", "N", "z of f_in"},
      {"hx_m", "m", "x of the handle"},
      {"hy_m", "m", "y of the handle"},
      {"hz_m", "m", "z of the handle"},
      {"colliding", "1", "points in the tool or on its surface, before local average and reduction"},
      {"rendered", "1", "points that the force law saw"},
      {"depth_max_m", "m", "largest penetration depth of a colliding point; 0 without contact"},
      {"ratio_min", "1", "smallest stiffness ratio u^T S u of a rendered contact; empty without contact"},
      {"ratio_max", "1", "largest stiffness ratio u^T S u of a rendered contact; empty without contact"}};
  static constexpr Column kPoseColumns[] = {
      {"qw", "1", "w of the unit quaternion that turns the tool's frame, its axis along -z, into the world's; >= 0"},
      {"qx", "1", "x of this quaternion"},
      {"qy", "1", "y of this quaternion"},
      {"qz", "1", "z of this quaternion"}};
  static constexpr Column kTorqueColumns[] = {
      {"tx_Nm", "Nm",
       "x of the lost torque: what the rendered contacts would exert on the tool about its tip's centre and the device "
       "cannot render, sum r_i x f_i, f_i contact i's share of f_spring"},
      {"ty_Nm", "Nm", "y of the lost torque"},
      {"tz_Nm", "Nm", "z of the lost torque"}};

  /// The columns of a file with these extras, in order.
  static std::span<const Column> columns(const TrajectoryExtras& extras);

  /// Keeps rows 0, every, 2 every, … Precondition: every > 0. Throws IoError.
  explicit TrajectoryRecorder(TableTarget target, std::uint64_t every = 1, const TrajectoryExtras& extras = {});

  bool wants_ratio() const noexcept override { return true; }
  bool wants_roll() const noexcept override { return extras_.pose; }
  bool wants_springs() const noexcept override { return extras_.torque; }
  void on_step(const StepRecord& record) noexcept override;
  void finish() override { writer_.finish(); }

 private:
  TableWriter writer_;
  std::uint64_t every_;
  TrajectoryExtras extras_;
};

}  // namespace hapbench
