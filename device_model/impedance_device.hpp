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

/// Continuous Butterworth low-pass filter, |H(f)|^2 = 1 / (1 + (f / cutoff)^(2 order)).
struct LowPassFilter {
  double cutoff = 100.0;  ///< half-power frequency [Hz]
  std::size_t order = 1;  ///< 1 to kMaxOrder
  /// Largest order. Up to this order, the rounding error of the sum of the modes is less than 1e-12 of the input.
  static constexpr int kMaxOrder = 8;
};

/// Mode of a sampled low-pass filter: a term in the partial fractions of the filter's transfer function. For each
/// sample u, the state y of the mode changes by gain * (residue * u - y). This is exact if the input was constant at u
/// over the preceding period. The filter's output is the sum of the real parts of all states.
struct LowPassMode {
  /// Dimensionless coefficients. A pair of complex poles has one mode, with twice the residue of one pole. The mode of
  /// a real pole has real coefficients.
  std::complex<double> residue, gain;

  /// Returns the mode's transfer function at z = e^(j theta), theta = 2 pi f dt.
  std::complex<double> response(double theta) const;
};

/// Returns the modes of a low-pass for samples at intervals of `dt` [s]; a single mode for order 1.
std::vector<LowPassMode> low_pass_modes(const LowPassFilter& filter, double dt);

/// Low-pass filter of sampled vectors, component by component. Allocates only in the constructor; a sample takes about
/// 5 ns for each mode.
class SampledLowPass {
 public:
  SampledLowPass(const LowPassFilter& filter, double dt);

  /// Sets the steady state of a constant input `value`: the output stays `value` until the input changes.
  void settle_at(const Vec3& value) noexcept;
  /// Filters the next sample and returns the output.
  Vec3 filter(const Vec3& sample) noexcept;

 private:
  struct Term {
    LowPassMode mode;
    Vec3 real = Vec3::Zero(), imaginary = Vec3::Zero();  ///< real and imaginary part of the mode's state
  };
  std::vector<Term> terms_;
  bool is_identity_ = true;  ///< true if the cutoff is so high that the output equals the input
};

/// Velocity as the difference of positions, v_k = (x_k - x_(k-1)) / T, with the sampling period T.
struct DifferenceFilter {};

/// First-order adaptive windowing, the end-fit method of F. Janabi-Sharifi, V. Hayward and C.-S. J. Chen,
/// "Discrete-time adaptive windowing for velocity estimation", IEEE Transactions on Control Systems Technology
/// 8(6), 2000. The velocity is the slope (x_k - x_(k-n)) / (n T), separately for each axis. The window n is the
/// longest for which each sample within it, and within all shorter windows, differs by at most `noise` from the
/// straight line through the window's ends.
struct AdaptiveWindowFilter {
  double noise = 1e-5;  ///< largest error of a sample [m]; half the encoder's resolution for a rounded position
  /// Longest window [samples] (our choice). With this window, one encoder step changes the estimated velocity by 1/15
  /// of the change that DifferenceFilter would give. The estimate is delayed by half the window, 7.5 ms at 1 kHz.
  static constexpr std::size_t kLongest = 15;
};

/// Method of estimating the velocity. The method LowPassFilter filters the differences d_k = (x_k - x_(k-1)) / T; each
/// difference is held over one period as input of the continuous filter. For order 1, this gives v_k = v_(k-1) + (1 -
/// e^(-2 pi f T)) (d_k - v_(k-1)), with the cutoff f.
using VelocityFilterConfig = std::variant<DifferenceFilter, LowPassFilter, AdaptiveWindowFilter>;

/// Estimates the velocity from sampled positions, as a controller does. Allocates only in the constructor.
class VelocityFilter {
 public:
  /// `dt`: sampling period T [s].
  VelocityFilter(const VelocityFilterConfig& config, double dt);

  /// Starts with a first sample at `position` [m] and velocity zero.
  void reset(const Vec3& position) noexcept;
  /// Adds the next sample [m] and returns the estimated velocity at this sample [m/s].
  Vec3 read(const Vec3& position) noexcept;

 private:
  double end_fit(Eigen::Index axis, double noise) const noexcept;
  /// Returns the sample `ago` periods before the last sample.
  const Vec3& sample(std::size_t ago) const noexcept {
    return samples_[(next_ + samples_.size() - 1 - ago) % samples_.size()];
  }

  VelocityFilterConfig config_;
  double dt_;
  std::optional<SampledLowPass> low_pass_;
  std::array<Vec3, AdaptiveWindowFilter::kLongest + 1> samples_{};  ///< ring buffer [m]
  std::size_t next_ = 0;                                            ///< index of the next sample
  std::size_t known_ = 0;  ///< number of samples since the reset, at most the size of the ring buffer
};

/// Impedance-type haptic device: a light handle with motors, which measures positions and renders forces.
struct ImpedanceDeviceConfig {
  double handle_mass = 0.05;   ///< m, effective mass of all moving parts at the handle [kg]
  double viscous = 0.0;        ///< viscous friction b of each axis [N s/m]
  double coulomb = 0.0;        ///< Coulomb friction c of each axis [N]
  double encoder_step = 0.0;   ///< resolution q of the measured position [m]; 0: exact
  double delay_samples = 0.0;  ///< delay d from the sample to the force [periods], may be fractional
  /// The delay [s], if the scenario gives it in seconds. resolve_delay() converts it to delay_samples. The device reads
  /// only delay_samples.
  std::optional<double> delay = {};
  VelocityFilterConfig velocity_filter = {};
  std::optional<double> force_max = {};   ///< norm of the force at which the motors saturate [N]; empty: no limit
  double force_step = 0.0;                ///< resolution of each force component [N]; 0: exact
  std::optional<double> force_slew = {};  ///< largest rate of change of the force (norm) [N/s]; empty: no limit
  /// Filter of the measured positions from which the force is computed; the velocity filter gets unfiltered positions.
  std::optional<LowPassFilter> position_filter = {};
  double position_noise = 0.0;  ///< standard deviation of the noise of each axis, added before rounding [m]
  std::uint64_t seed = 0;       ///< seed of the noise's random numbers
  std::optional<Transmission> transmission = {};  ///< elastic transmission between motors and handle; empty: rigid
};

/// Force of the motors over one period: `before` during the first fraction ForcePath::switch_fraction of the period,
/// `after` during the rest.
struct HeldForce {
  Vec3 before = Vec3::Zero();  ///< [N]
  Vec3 after = Vec3::Zero();   ///< [N]
};

/// Signal path from a rendered force to the motors: resolution, saturation and slew limit, in this order, then a
/// delay line and a zero-order hold. Allocates only in the constructor.
class ForcePath {
 public:
  /// `dt`: sampling period T [s].
  ForcePath(const ImpedanceDeviceConfig& config, double dt);

  /// Sets all delayed forces to zero.
  void reset() noexcept;
  /// Adds the force rendered at the beginning of a period [N] and returns the motors' force during this period.
  HeldForce hold(const Vec3& rendered) noexcept;
  /// Returns the fractional part of the delay, in [0, 1). After this fraction of each period, the motors change from
  /// HeldForce::before to HeldForce::after.
  double switch_fraction() const noexcept { return switch_fraction_; }

 private:
  Vec3 command(const Vec3& rendered) const noexcept;

  ImpedanceDeviceConfig config_;
  double max_change_;  ///< largest change of the force in one period [N], if the slew rate is limited
  double switch_fraction_;
  Vec3 last_ = Vec3::Zero();    ///< command of the last period [N]
  std::vector<Vec3> commands_;  ///< ring buffer of delayed commands [N]
  std::size_t next_ = 0;
};

/// Sampled loop of an impedance-type haptic device (Colgate and Brown, "Factors affecting the Z-width of a haptic
/// display", ICRA 1994; Diolaiti et al., IEEE Transactions on Robotics 22(2), 2006):
///
///   handle -> noise -> encoder -> x_k -> filter -> v_k -> f_render(x_k, v_k) -> resolution, saturation, slew
///     -> delay d T -> hold -> motors -> handle <- hand
///
/// There is no virtual mass: the tool is at the measured position of the handle, and f_in is zero. x_k is the
/// position with noise, rounded to the resolution q in each axis. A position filter changes the position that
/// f_render gets, but the velocity v_k is computed from unfiltered positions; v_0 = 0. The motors give no force
/// before the first rendered force arrives, at t = d T. With a fractional d, the force changes within the period.
/// Between samples the motion of the handle is computed exactly (HandleMotion). With a transmission, motors and handle
/// move as two bodies (ElasticMotion), and x_k is measured at the motors. In the energy balance, `actuator` is the
/// motors' work.
/// Allocates only in the constructor; a step without Coulomb friction takes about 50 ns.
class ImpedanceDevice final : public Device {
 public:
  /// `dt`: sampling period T [s]. `hand`: all zero for a hand whose force is held from sample to sample.
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
  /// Returns the position with noise, rounded to the encoder's resolution [m].
  Vec3 read_position() noexcept;

  ImpedanceDeviceConfig config_;
  VelocityFilter filter_;
  std::optional<SampledLowPass> position_filter_;
  Random random_;
  ForcePath path_;
  HandleMotion motion_;
  FreeMotion before_, after_;  ///< motion in a period before and after the motors change their force
  struct Elastic {
    ElasticMotion parts;
    ElasticMotion::Stretch before, after;
  };
  std::optional<Elastic> elastic_;  ///< replaces motion_ if the device has a transmission
  HandleState sampled_;
};

/// Sources of the values in device presets: the code of CHAI3D, the maker's data sheet, or an estimate of this project.
inline constexpr std::string_view kFromChai3d = "CHAI3D 3.3.0, src/devices/CPhantomDevices.cpp and CDeltaDevices.cpp",
                                  kFromDataSheet = "the maker's data sheet", kOurEstimate = "(ours)";

/// A value with its source.
struct SourcedNumber {
  double value;
  std::string_view source;
  double low = value, high = value;  ///< plausible range of an estimate; equal to `value` if published
};

/// A commercial impedance-type device. The velocity filter, the delay and the force resolution belong to the controller
/// and are not included.
struct DevicePreset {
  const char* name;
  const char* device;           ///< make and model
  SourcedNumber handle_mass;    ///< [kg]
  SourcedNumber viscous;        ///< [N s/m]
  SourcedNumber coulomb;        ///< [N]
  SourcedNumber encoder_step;   ///< [m]
  SourcedNumber force_max;      ///< [N]
  SourcedNumber max_stiffness;  ///< largest stable stiffness of a wall that the source states [N/m]
  SourcedNumber max_damping;    ///< largest stable damping of a wall that the source states [N s/m]
};

/// Returns all presets, grouped by manufacturer.
std::span<const DevicePreset> device_presets() noexcept;
/// Returns the preset with this name; null if no preset has this name.
const DevicePreset* find_device_preset(std::string_view name) noexcept;

/// Selects the values of a preset's unpublished parameters. `own`: the estimates. `soft`: the end of each plausible
/// range that lowers the stability limit of a wall (little friction, little mass, a coarse encoder). `stiff`: the
/// opposite end of each range.
enum class PresetVariant { own, soft, stiff };
inline constexpr const char* kPresetRanges =
    "dry friction 0 to twice our value, viscous friction 1 to 10 times, mass smaller or larger by a factor of 1.3, "
    "encoder finer or coarser by a factor of 2";

/// Returns the configuration of the device with the estimates that `end` selects. Fields that a preset does not contain
/// have their defaults.
ImpedanceDeviceConfig config_of(const DevicePreset& preset, PresetVariant end = PresetVariant::own);

}  // namespace hapbench
