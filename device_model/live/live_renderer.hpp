#pragma once

#include <array>
#include <optional>

#include "device_model/impedance_device.hpp"
#include "device_model/live/hapbench_renderer.h"
#include "sim/loop/live_loop.hpp"

/// The renderer behind hapbench_renderer.h, which documents its behaviour: a LiveLoop computes forces from the poses of
/// a device, and the renderer protects the user's hand: it limits and ramps the force, and renders no
/// force after a fault.
namespace hapbench {

/// Rotation of vectors by a quaternion. If the rotation is the identity, it returns vectors unchanged, bit for bit.
class MountRotation {
 public:
  /// `wxyz`: quaternion whose norm is close to 1.
  explicit MountRotation(const double (&wxyz)[4]);

  Vec3 turned(const Vec3& v) const noexcept { return is_identity_ ? v : Vec3(matrix_ * v); }
  Vec3 turned_back(const Vec3& v) const noexcept { return is_identity_ ? v : Vec3(matrix_.transpose() * v); }
  bool is_identity() const { return is_identity_; }
  const Eigen::Quaterniond& quaternion() const { return quaternion_; }

 private:
  Eigen::Quaterniond quaternion_;
  Mat3 matrix_;
  bool is_identity_;
};

/// Inputs of a LiveRenderer from the scenario and from the caller's setup.
struct LiveRendererConfig {
  bool is_admittance = false;
  bool wants_torque = false;
  /// The caller's mount after all checks. Each force limit is the smaller of the limits of caller and scenario.
  HapbenchMount mount = HAPBENCH_MOUNT_INIT;
  std::optional<VelocityFilterConfig> velocity_filter = {};
  std::optional<LowPassFilter> position_filter = {};
  std::optional<double> input_force_limit = {};  ///< [N]
};

/// Computes the force for one measured pose in each call of `step`. Allocates in the constructor only.
class LiveRenderer {
 public:
  /// Throws the exceptions of the constructor of LiveLoop.
  LiveRenderer(const LiveRendererConfig& config, SimulationConfig simulation, SimulationParts parts);

  void step(const HapbenchInput& input, HapbenchOutput& output) noexcept;
  /// Returns the reason of the last fault; empty if there was no fault.
  const char* fault() const noexcept { return fault_text_.data(); }
  double period() const { return loop_.dt(); }
  /// Returns the state of the tool after the last call; not meaningful if its status was STALE or FAULT.
  const ToolState& tool() const noexcept { return tool_; }
  /// Returns the depth of the deepest contact in the last call that rendered [m]. 0 if that call had no contact, and
  /// after a restart until the next call that renders.
  double deepest_contact() const noexcept { return loop_.force().depth_max; }

 private:
  /// Reason why the held force of an earlier call is falling to 0; `none` if no force is falling.
  enum class Release { none, clutch, stale, fault, rearm };
  /// A measurement in the device's frame, and the orientation of the tool in the world.
  struct Measurement {
    Vec3 tip = Vec3::Zero();  ///< tip centre [m]
    Vec3 arm = Vec3::Zero();  ///< vector from the handle's origin to the tip centre [m]
    /// Rotation from the tool frame to the world frame.
    Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();
    double roll = 0.0;  ///< roll of the tool [rad]; 0 if neither the pose nor the angular velocity needs it
  };

  std::uint32_t problem_of(const HapbenchInput& input) const noexcept;
  Measurement measured(const HapbenchPose3& handle) const noexcept;
  Vec3 to_world(const Vec3& tip) const noexcept { return scale_ * world_.turned(tip) + origin_; }
  void set_orientation(const Measurement& now, const HapbenchInput& input) noexcept;
  Vec3 angular_velocity_of(const Measurement& now, const HapbenchInput& input) const noexcept;
  void follow_handle(const Measurement& now, const HapbenchInput& input) noexcept;
  void handle_clutch(const Measurement& now, bool pressed) noexcept;
  bool takes_rest(double elapsed, HapbenchOutput& output) noexcept;
  void render(const Measurement& now, const HapbenchInput& input, double elapsed, HapbenchOutput& output) noexcept;
  void limit(Vec3& force, double elapsed, HapbenchOutput& output) const noexcept;
  void report_set_point(const Measurement& now, const HapbenchInput& input, HapbenchOutput& output) noexcept;
  void restart() noexcept;
  void release(Release why) noexcept;
  void fail(std::uint32_t reason) noexcept;

  LiveRendererConfig config_;
  LiveLoop loop_;
  VelocityFilter velocity_filter_;
  std::optional<SampledLowPass> position_filter_;
  MountRotation world_, tip_rotation_;
  double scale_;
  Vec3 origin_;  ///< position of world_from_device, which a released clutch moves [m]
  Vec3 tip_;     ///< position of handle_from_tip [m]

  std::uint64_t calls_ = 0;
  std::uint64_t last_time_ = 0;  ///< HapbenchInput::time_ns of the last call
  bool has_time_ = false;
  std::uint32_t last_bits_ = 0;  ///< HapbenchInput::has of the last call

  ToolState tool_;
  Measurement last_measurement_;
  bool has_tool_ = false;      ///< true if tool_ belongs to the previous call; false after a restart
  bool has_position_ = false;  ///< true if tool_ has a valid position, at which a pressed clutch keeps the tool

  Release release_ = Release::none;
  double release_gain_ = 0.0;         ///< factor on held_force_, from 1 to 0
  double held_gain_ = 0.0;            ///< gain of the last call before the release
  Vec3 held_force_ = Vec3::Zero();    ///< force of the last call before the release, device frame [N]
  Vec3 last_force_ = Vec3::Zero();    ///< force of the last call, device frame [N]
  Vec3 set_position_ = Vec3::Zero();  ///< set-point of the last call, device frame [m]
  double gain_ = 0.0;
  int calls_below_ = 0;  ///< calls in a row with a rendered force below engage_force
  bool is_clutched_ = false;
  std::optional<Vec3> kept_position_;  ///< position of the tool while clutched, world frame [m]
  std::uint32_t reason_ = HAPBENCH_NO_FAULT;
  std::array<char, 400> fault_text_{};
};

}  // namespace hapbench
