#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <variant>
#include <vector>

#include "device_model/handle_motion.hpp"
#include "sim/core/random.hpp"
#include "sim/loop/device.hpp"

namespace hapbench {

/// A continuous Butterworth low-pass, |H(f)|^2 = 1 / (1 + (f / cutoff)^(2 order)).
struct LowPassFilter {
  double cutoff = 100.0;              ///< half-power frequency [Hz]
  std::size_t order = 1;              ///< 1 to kHighest
  static constexpr int kHighest = 8;  ///< order; rounding of its sum of modes is below 1e-12 of the input
};

/// A term of the partial fractions of a low-pass, sampled: y += taken (share u - y) for each sample u, which is exact
/// for a u held over the period before. The output is the sum of the real parts of the terms.
struct LowPassMode {
  std::complex<double> share, taken;  ///< of a pair of poles, one with twice its share; real for a real pole

  /// The term's transfer function at z = e^(j theta).
  std::complex<double> response(double theta) const;
};

/// The terms of a low-pass for samples at intervals of `dt` [s]; one for order 1.
std::vector<LowPassMode> low_pass_modes(const LowPassFilter& filter, double dt);

/// A low-pass of sampled vectors. Allocates in the constructor only; a sample takes about 5 ns a mode.
class SampledLowPass {
 public:
  SampledLowPass(const LowPassFilter& filter, double dt);

  /// Sets the state to that of a constant past input.
  void settle_at(const Vec3& value) noexcept;
  Vec3 filter(const Vec3& sample) noexcept;

 private:
  struct Term {
    LowPassMode mode;
    Vec3 real = Vec3::Zero(), imaginary = Vec3::Zero();
  };
  std::vector<Term> terms_;
  bool passes_all_ = true;  ///< the cut-off is so high that nothing is remembered
};

/// v_k = (x_k - x_(k-1)) / T.
struct DifferenceFilter {};

/// First-order adaptive windowing, the end-fit of F. Janabi-Sharifi, V. Hayward and C.-S. J. Chen, "Discrete-time
/// adaptive windowing for velocity estimation", IEEE Transactions on Control Systems Technology 8(6), 2000: the slope
/// (x_k - x_(k-n)) / (n T), each axis on its own. The window n is the longest for which every sample within it, and
/// within all shorter windows, is no further than the noise from the straight line through its ends.
struct AdaptiveWindowFilter {
  double noise = 1e-5;  ///< largest error of a sample [m]; half the encoder's step for a rounded position
  /// The longest window [samples] (ours). It reduces the effect of an encoder's step to a fifteenth of that on the
  /// difference and lags by half its length, 7.5 ms at 1 kHz.
  static constexpr std::size_t kLongest = 15;
};

/// With LowPassFilter: the continuous low-pass of the difference d_k held over its period, for order 1
/// v_k = v_(k-1) + (1 - e^(-2 pi f T)) (d_k - v_(k-1)).
using VelocityFilterConfig = std::variant<DifferenceFilter, LowPassFilter, AdaptiveWindowFilter>;

/// Estimates a controller's velocity from sampled positions. Allocates in the constructor only.
class VelocityFilter {
 public:
  /// dt: sampling period T [s].
  VelocityFilter(const VelocityFilterConfig& config, double dt);

  /// Starts with the sample `position` [m] and the velocity zero.
  void reset(const Vec3& position) noexcept;
  /// Takes the next sample [m] and returns the velocity there [m/s].
  Vec3 read(const Vec3& position) noexcept;

 private:
  double end_fit(Eigen::Index axis, double noise) const noexcept;
  /// The sample `ago` periods before the last one.
  const Vec3& sample(std::size_t ago) const noexcept {
    return samples_[(next_ + samples_.size() - 1 - ago) % samples_.size()];
  }

  VelocityFilterConfig config_;
  double dt_;
  std::optional<SampledLowPass> low_pass_;
  std::array<Vec3, AdaptiveWindowFilter::kLongest + 1> samples_{};  ///< ring
  std::size_t next_ = 0;                                            ///< index of the next sample
  std::size_t known_ = 0;  ///< samples since the reset, at most the size of the ring
};

/// An impedance display: a light handle with motors, which measures positions and renders forces.
struct ImpedanceDeviceConfig {
  double handle_mass = 0.05;   ///< m, of everything that moves, as felt at the handle [kg]
  double viscous = 0.0;        ///< friction b of each axis [N s/m]
  double coulomb = 0.0;        ///< friction c of each axis [N]
  double encoder_step = 0.0;   ///< q [m]; 0: exact
  double delay_samples = 0.0;  ///< d, from the sample to the force [periods], whole or fractional
  /// The same [s] where it is known in seconds; who has the period makes delay_samples of it. Nothing here reads it.
  std::optional<double> delay = {};
  VelocityFilterConfig velocity_filter = {};
  std::optional<double> force_max = {};               ///< norm at which the motors saturate [N]
  double force_step = 0.0;                            ///< resolution of each component [N]; 0: exact
  std::optional<double> force_slew = {};              ///< fastest change of the force, by its norm [N/s]
  std::optional<LowPassFilter> position_filter = {};  ///< of the encoder's positions, before they are rendered
  double position_noise = 0.0;                        ///< standard deviation of each axis, before the encoder [m]
  std::uint64_t seed = 0;                             ///< of the noise
  std::optional<Transmission> transmission = {};      ///< elastic, between motors and handle; none: they are one body
};

/// Force of the motors over one period: `before` for ForcePath::switch_part of it, `after` for the rest.
struct HeldForce {
  Vec3 before = Vec3::Zero();  ///< [N]
  Vec3 after = Vec3::Zero();   ///< [N]
};

/// The way from a rendered force to the motors: resolution, saturation and slew limit, in this order, then a delay line
/// and a zero-order hold. Allocates in the constructor only.
class ForcePath {
 public:
  /// dt: period T [s].
  ForcePath(const ImpedanceDeviceConfig& config, double dt);

  /// Sets the force to zero everywhere on the way.
  void reset() noexcept;
  /// Takes the force rendered at the beginning of a period [N] and returns the force of the motors during it.
  HeldForce hold(const Vec3& rendered) noexcept;
  /// Fraction of a period after which the motors change their force, in [0, 1): the fraction of the delay.
  double switch_part() const noexcept { return switch_part_; }

 private:
  Vec3 command(const Vec3& rendered) const noexcept;

  ImpedanceDeviceConfig config_;
  double largest_change_;  ///< per period if the slew is limited [N]
  double switch_part_;
  Vec3 last_ = Vec3::Zero();    ///< command of the last period
  std::vector<Vec3> commands_;  ///< ring of the commands that are on their way
  std::size_t next_ = 0;
};

/// The loop of an impedance display (Colgate and Brown, "Factors affecting the Z-width of a haptic display", ICRA 1994;
/// Diolaiti et al., IEEE Transactions on Robotics 22(2), 2006):
///
///   handle -> noise -> encoder -> x_k -> filter -> v_k -> f_render(x_k, v_k) -> resolution, saturation, slew
///     -> delay d T -> hold -> motors -> handle <- hand
///
/// No virtual mass: the tool is at the measured position of the handle, and f_in is zero. x_k is the position with its
/// noise, rounded to q in each axis; a position filter changes the x_k that is rendered, not that of the velocity. v_0
/// = 0. The motors give no force before the first one arrives, at t = d T; a fraction of d changes the force within the
/// period. Between samples the handle moves exactly (HandleMotion), or motors and handle do as two bodies
/// (ElasticMotion), and x_k is measured at the motors. In the energy balance `actuator` is the motors' work. Allocates
/// in the constructor only; a step without Coulomb friction takes about 50 ns.
class ImpedanceDevice final : public Device {
 public:
  /// dt: period T [s]. hand: zeros for a hand whose force is held from sample to sample.
  ImpedanceDevice(const ImpedanceDeviceConfig& config, double dt, const AttachedHand& hand = {});

  void reset(const ToolState& tool) noexcept override;
  MeasuredForce measure(const Vec3& hand_force) noexcept override { return {hand_force, Vec3::Zero()}; }
  const HandleState& handle() const noexcept override { return elastic_ ? elastic_->parts.handle() : motion_.handle(); }
  std::optional<DeviceEnergy> energy() const noexcept override {
    return elastic_ ? elastic_->parts.energy() : motion_.energy();
  }

  bool moves_tool() const noexcept override { return true; }
  void drive(const Vec3& rendered, const Vec3& hand_force) noexcept override;
  HandleState sampled() const noexcept override { return sampled_; }

 private:
  /// The encoder's position.
  Vec3 read_position() noexcept;

  ImpedanceDeviceConfig config_;
  VelocityFilter filter_;
  std::optional<SampledLowPass> position_filter_;
  Random random_;
  ForcePath path_;
  HandleMotion motion_;
  FreeMotion before_, after_;  ///< the two parts of a period
  struct Elastic {
    ElasticMotion parts;
    ElasticMotion::Stretch before, after;
  };
  std::optional<Elastic> elastic_;  ///< instead of motion_
  HandleState sampled_;
};

/// Sources of the numbers of presets.
inline constexpr std::string_view kFromChai3d = "CHAI3D 3.3.0, src/devices/CPhantomDevices.cpp and CDeltaDevices.cpp",
                                  kFromDataSheet = "the maker's data sheet", kOurEstimate = "(ours)";

struct SourcedNumber {
  double value;
  std::string_view source;
  double low = value, high = value;  ///< what it may be as well, where it is ours
};

/// A published impedance display. Filter, delay and resolution of the force belong to its controller and are not
/// included.
struct DevicePreset {
  const char* name;
  const char* device;           ///< make and model
  SourcedNumber handle_mass;    ///< [kg]
  SourcedNumber viscous;        ///< [N s/m]
  SourcedNumber coulomb;        ///< [N]
  SourcedNumber encoder_step;   ///< [m]
  SourcedNumber force_max;      ///< [N]
  SourcedNumber max_stiffness;  ///< published largest stable stiffness of a wall [N/m]
  SourcedNumber max_damping;    ///< published largest stable damping [N s/m]
};

/// All presets, in the order of their makers.
std::span<const DevicePreset> device_presets() noexcept;
/// Null if there is no preset of that name.
const DevicePreset* find_device_preset(std::string_view name) noexcept;

/// Which of the values that a preset's unpublished numbers may have: its own, or all those that let a wall vibrate
/// sooner (little friction and mass, a coarse encoder), or later.
enum class PresetEnd { own, soft, stiff };
inline constexpr const char* kPresetRanges =
    "dry friction 0 to twice our value, viscous friction 1 to 10 times, mass smaller or larger by a factor of 1.3, "
    "encoder finer or coarser by a factor of 2";

/// The device, with defaults for fields that a preset does not contain.
ImpedanceDeviceConfig config_of(const DevicePreset& preset, PresetEnd end = PresetEnd::own);

}  // namespace hapbench
