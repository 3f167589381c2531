#include "device_model/impedance_device.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/core/math.hpp"

namespace hapbench {

using Complex = std::complex<double>;

/// Returns a pole of the Butterworth filter with cutoff 1 rad/s: the k-th pole in the upper half of the complex
/// plane. The last pole of an odd order is real.
static Complex unit_pole(std::size_t k, std::size_t order) {
  if (2 * k + 1 == order) return {-1.0, 0.0};
  const auto [sine, cosine] =
      math::sine_cosine(std::numbers::pi * static_cast<double>(2 * k + 1) / static_cast<double>(2 * order));
  return {-sine, cosine};
}

/// Returns e^z - 1, accurate also for small z.
static Complex exponential_minus_one(const Complex& z) {
  const double grown = math::expm1(z.real()), half = math::sin(0.5 * z.imag());
  return {grown - 2.0 * (1.0 + grown) * half * half, (1.0 + grown) * math::sin(z.imag())};
}

// With the poles p_i, H(s) is the product of p_i / (p_i - s), which equals the sum of residue_i p_i / (p_i - s).
std::vector<LowPassMode> low_pass_modes(const LowPassFilter& filter, double dt) {
  // List the poles of the upper half plane, then their conjugates.
  std::vector<Complex> poles;
  const std::size_t order = filter.order, upper = (order + 1) / 2;
  for (std::size_t k = 0; k < upper; ++k) poles.push_back(unit_pole(k, order));
  for (std::size_t k = 0; k < order / 2; ++k) poles.push_back(std::conj(poles[k]));
  // Compute the residue of each pole, and the gain of its mode.
  std::vector<LowPassMode> modes;
  for (std::size_t i = 0; i < upper; ++i) {
    const bool is_real = poles[i].imag() == 0.0;
    Complex residue = is_real ? 1.0 : 2.0;
    for (std::size_t j = 0; j < order; ++j) {
      if (j == i) continue;
      const Complex difference = poles[j] - poles[i];
      residue *= poles[j] * std::conj(difference) / std::norm(difference);
    }
    const double angle = -2.0 * std::numbers::pi * filter.cutoff * dt;  // -2 pi f T, negative
    const Complex gain = -exponential_minus_one(-angle * poles[i]);
    modes.push_back(is_real ? LowPassMode{residue.real(), -math::expm1(angle)} : LowPassMode{residue, gain});
  }
  return modes;
}

std::complex<double> LowPassMode::response(double theta) const {
  const auto [sine, cosine] = math::sine_cosine(theta);
  const Complex back(cosine, -sine);
  const auto of = [&back](const Complex& s, const Complex& t) { return t * s / (1.0 - (1.0 - t) * back); };
  return 0.5 * (of(residue, gain) + of(std::conj(residue), std::conj(gain)));
}

SampledLowPass::SampledLowPass(const LowPassFilter& filter, double dt) {
  for (const LowPassMode& mode : low_pass_modes(filter, dt)) {
    terms_.push_back({.mode = mode});
    is_identity_ = is_identity_ && mode.gain == 1.0;
  }
}

void SampledLowPass::settle_at(const Vec3& value) noexcept {
  for (Term& term : terms_) {
    term.real = term.mode.residue.real() * value;
    term.imaginary = term.mode.residue.imag() * value;
  }
}

Vec3 SampledLowPass::filter(const Vec3& sample) noexcept {
  if (is_identity_) return sample;
  Vec3 output = Vec3::Zero();
  for (auto& [mode, real, imaginary] : terms_) {
    const Vec3 to_real = mode.residue.real() * sample - real, to_imaginary = mode.residue.imag() * sample - imaginary;
    real += mode.gain.real() * to_real - mode.gain.imag() * to_imaginary;
    imaginary += mode.gain.real() * to_imaginary + mode.gain.imag() * to_real;
    output += real;
  }
  return output;
}

VelocityFilter::VelocityFilter(const VelocityFilterConfig& config, double dt) : config_(config), dt_(dt) {
  if (const auto* low_pass = std::get_if<LowPassFilter>(&config)) low_pass_.emplace(*low_pass, dt);
}

void VelocityFilter::reset(const Vec3& position) noexcept {
  samples_[0] = position;
  next_ = known_ = 1;
  if (low_pass_) low_pass_->settle_at(Vec3::Zero());
}

Vec3 VelocityFilter::read(const Vec3& position) noexcept {
  samples_[next_] = position;
  next_ = (next_ + 1) % samples_.size();
  known_ = std::min(known_ + 1, samples_.size());
  // Estimate the velocity by the configured method.
  if (const auto* window = std::get_if<AdaptiveWindowFilter>(&config_)) {
    const double noise = window->noise;
    return {end_fit(0, noise), end_fit(1, noise), end_fit(2, noise)};
  }
  const Vec3 difference = (position - sample(1)) / dt_;
  return low_pass_ ? low_pass_->filter(difference) : difference;
}

/// Returns the velocity of one axis by adaptive windowing [m/s].
double VelocityFilter::end_fit(Eigen::Index axis, double noise) const noexcept {
  const double now = sample(0)[axis];
  double rise = 0.0;  // rise of the fitted line per sample [m]
  // Lengthen the window while the line through its ends fits all samples in it.
  for (std::size_t n = 1; n < known_; ++n) {
    const double longer = (now - sample(n)[axis]) / static_cast<double>(n);
    for (std::size_t i = 1; i < n; ++i) {
      if (std::abs(now - longer * static_cast<double>(i) - sample(i)[axis]) > noise) return rise / dt_;
    }
    rise = longer;
  }
  return rise / dt_;
}

/// Returns `v` with each component rounded to the nearest multiple of `step`; halves are rounded away from zero.
/// Returns `v` unchanged if `step` is 0.
static Vec3 rounded_to(const Vec3& v, double step) noexcept {
  if (step == 0.0) return v;
  return {std::round(v.x() / step) * step, std::round(v.y() / step) * step, std::round(v.z() / step) * step};
}

// The ring buffer holds the command of this period, one command for each whole period of the delay, and one more
// command for the rest of the delay, a fraction of a period.
ForcePath::ForcePath(const ImpedanceDeviceConfig& config, double dt)
    : config_(config),
      max_change_(config.force_slew.value_or(0.0) * dt),
      switch_fraction_(config.delay_samples - std::floor(config.delay_samples)),
      commands_(static_cast<std::size_t>(config.delay_samples) + 2, Vec3::Zero()) {}

void ForcePath::reset() noexcept {
  std::fill(commands_.begin(), commands_.end(), Vec3::Zero());
  next_ = 0;
  last_.setZero();
}

HeldForce ForcePath::hold(const Vec3& rendered) noexcept {
  last_ = commands_[next_] = command(rendered);
  next_ = (next_ + 1) % commands_.size();
  return {commands_[next_], commands_[(next_ + 1) % commands_.size()]};
}

/// Applies resolution, saturation and slew limit to a rendered force [N].
Vec3 ForcePath::command(const Vec3& rendered) const noexcept {
  Vec3 force = rounded_to(rendered, config_.force_step);
  if (const auto& limit = config_.force_max) {
    if (const double norm = force.norm(); norm > *limit) force *= *limit / norm;
  }
  if (config_.force_slew) {
    const Vec3 change = force - last_;
    if (const double norm = change.norm(); norm > max_change_) force = last_ + change * (max_change_ / norm);
  }
  return force;
}

ImpedanceDevice::ImpedanceDevice(const ImpedanceDeviceConfig& config, double dt, const AttachedHand& hand)
    : config_(config),
      filter_(config.velocity_filter, dt),
      random_(config.seed),
      path_(config, dt),
      motion_(config, hand),
      before_(free_motion(motion_.law(), path_.switch_fraction() * dt)),
      after_(free_motion(motion_.law(), (1.0 - path_.switch_fraction()) * dt)) {
  if (config.position_filter) position_filter_.emplace(*config.position_filter, dt);
  if (config.transmission) {
    const ElasticMotion motion(config, *config.transmission, hand);
    elastic_.emplace(Elastic{motion, motion.stretch(before_.time), motion.stretch(after_.time)});
  }
}

void ImpedanceDevice::reset(const ToolState& tool) noexcept {
  motion_.reset({tool.pose.position, tool.velocity});
  if (elastic_) elastic_->parts.reset({tool.pose.position, tool.velocity});
  path_.reset();
  if (config_.position_noise > 0.0) random_ = Random(config_.seed);
  sampled_ = {read_position(), Vec3::Zero()};
  filter_.reset(sampled_.position);
  if (position_filter_) position_filter_->settle_at(sampled_.position);
}

Vec3 ImpedanceDevice::read_position() noexcept {
  Vec3 position = elastic_ ? elastic_->parts.motor().position : motion_.handle().position;
  if (config_.position_noise > 0.0)
    for (double& axis : position) axis += config_.position_noise * random_.normal();
  return rounded_to(position, config_.encoder_step);
}

void ImpedanceDevice::drive(const Vec3& rendered, const Vec3& hand_force) noexcept {
  // Move the handle over the period; the motors' force may change within it.
  const HeldForce motors = path_.hold(rendered);
  const auto advance = [&](auto& motion, const auto& before, const auto& after) {
    motion.set_hand_force(hand_force);
    if (before_.time > 0.0) motion.advance(motors.before, before);
    motion.advance(motors.after, after);
  };
  elastic_ ? advance(elastic_->parts, elastic_->before, elastic_->after) : advance(motion_, before_, after_);
  sampled_.position = read_position();
  sampled_.velocity = filter_.read(sampled_.position);
  // Filter the position that the force algorithm gets. The velocity was computed from unfiltered positions.
  if (position_filter_) sampled_.position = position_filter_->filter(sampled_.position);
}

namespace {

constexpr SourcedNumber chai(double value) {
  return {value, kFromChai3d};
}
constexpr SourcedNumber sheet(double value) {
  return {value, kFromDataSheet};
}
// Factors that bound an estimate of an unpublished value (kPresetRanges). They are wide because we found no measured
// friction of these devices. The friction of a haptic paddle was measured as 3 to 4 N s/m, although the data sheet of
// its motor gives 0.04 N s/m (scenarios/library/validation).
struct Factors {
  double low, high;
};
constexpr Factors kMass = {1.0 / 1.3, 1.3}, kViscous = {1.0, 10.0}, kCoulomb = {0.0, 2.0}, kEncoder = {0.5, 2.0};
constexpr SourcedNumber ours(double value, const Factors& range) {
  return {value, kOurEstimate, range.low * value, range.high * value};
}

/// Returns the preset of the omega.6 or the omega.7. The two presets differ only in the mass of the handle [kg].
constexpr DevicePreset omega_with_wrist(const char* name, const char* device, double handle_mass) {
  return {
      .name = name,
      .device = device,
      .handle_mass = ours(handle_mass, kMass),
      .viscous = ours(0.5, kViscous),
      .coulomb = ours(0.3, kCoulomb),
      .encoder_step = ours(0.01e-3, kEncoder),
      .force_max = chai(12),
      .max_stiffness = chai(5000),
      .max_damping = chai(30),
  };
}

constexpr DevicePreset kPresets[] = {
    {
        .name = "touch",
        .device = "3D Systems Touch",
        .handle_mass = sheet(0.045),
        .viscous = ours(0.1, kViscous),
        .coulomb = ours(0.2, kCoulomb),
        .encoder_step = sheet(0.055e-3),
        .force_max = chai(3.3),
        .max_stiffness = chai(400),
        .max_damping = chai(4),
    },
    {
        .name = "omni",
        .device = "SensAble Phantom Omni",
        .handle_mass = ours(0.045, kMass),
        .viscous = ours(0.1, kViscous),
        .coulomb = ours(0.2, kCoulomb),
        .encoder_step = ours(0.055e-3, kEncoder),
        .force_max = chai(3.3),
        .max_stiffness = chai(700),
        .max_damping = chai(5),
    },
    {
        .name = "desktop",
        .device = "SensAble Phantom Desktop",
        .handle_mass = ours(0.045, kMass),
        .viscous = ours(0.1, kViscous),
        .coulomb = ours(0.06, kCoulomb),
        .encoder_step = ours(0.025e-3, kEncoder),
        .force_max = chai(7.9),
        .max_stiffness = chai(1000),
        .max_damping = chai(5),
    },
    {
        .name = "premium_1.5",
        .device = "SensAble Phantom Premium 1.5",
        .handle_mass = ours(0.075, kMass),
        .viscous = ours(0.1, kViscous),
        .coulomb = ours(0.04, kCoulomb),
        .encoder_step = ours(0.03e-3, kEncoder),
        .force_max = chai(8.5),
        .max_stiffness = chai(800),
        .max_damping = chai(5),
    },
    {
        .name = "premium_3.0",
        .device = "SensAble Phantom Premium 3.0",
        .handle_mass = ours(0.16, kMass),
        .viscous = ours(0.2, kViscous),
        .coulomb = ours(0.2, kCoulomb),
        .encoder_step = ours(0.02e-3, kEncoder),
        .force_max = chai(22),
        .max_stiffness = chai(1000),
        .max_damping = chai(5),
    },
    {
        .name = "falcon",
        .device = "Novint Falcon",
        .handle_mass = ours(0.1, kMass),
        .viscous = ours(0.5, kViscous),
        .coulomb = ours(0.5, kCoulomb),
        .encoder_step = ours(0.06e-3, kEncoder),
        .force_max = chai(8),
        .max_stiffness = chai(3000),
        .max_damping = chai(20),
    },
    {
        .name = "omega.3",
        .device = "Force Dimension omega.3",
        .handle_mass = ours(0.2, kMass),
        .viscous = ours(0.5, kViscous),
        .coulomb = ours(0.3, kCoulomb),
        .encoder_step = sheet(0.01e-3),
        .force_max = chai(12),
        .max_stiffness = chai(5000),
        .max_damping = chai(30),
    },
    omega_with_wrist("omega.6", "Force Dimension omega.6", 0.3),
    omega_with_wrist("omega.7", "Force Dimension omega.7", 0.35),
    {
        .name = "delta.3",
        .device = "Force Dimension delta.3",
        .handle_mass = ours(0.3, kMass),
        .viscous = ours(0.5, kViscous),
        .coulomb = ours(0.5, kCoulomb),
        .encoder_step = ours(0.02e-3, kEncoder),
        .force_max = chai(20),
        .max_stiffness = chai(5000),
        .max_damping = chai(30),
    },
    {
        .name = "sigma.7",
        .device = "Force Dimension sigma.7",
        .handle_mass = ours(0.4, kMass),
        .viscous = ours(0.5, kViscous),
        .coulomb = ours(0.4, kCoulomb),
        .encoder_step = ours(0.01e-3, kEncoder),
        .force_max = chai(12),
        .max_stiffness = chai(4000),
        .max_damping = chai(30),
    },
    {
        .name = "lambda.7",
        .device = "Force Dimension lambda.7",
        .handle_mass = ours(0.4, kMass),
        .viscous = ours(0.5, kViscous),
        .coulomb = ours(0.4, kCoulomb),
        .encoder_step = ours(0.01e-3, kEncoder),
        .force_max = chai(12),
        .max_stiffness = chai(8000),
        .max_damping = chai(30),
    },
};

}  // namespace

std::span<const DevicePreset> device_presets() noexcept {
  return kPresets;
}

const DevicePreset* find_device_preset(std::string_view name) noexcept {
  const auto* found = std::ranges::find(kPresets, name, &DevicePreset::name);
  return found == std::end(kPresets) ? nullptr : found;
}

ImpedanceDeviceConfig config_of(const DevicePreset& preset, PresetVariant end) {
  const auto at = [end](const SourcedNumber& number) {
    return end == PresetVariant::own ? number.value : end == PresetVariant::soft ? number.low : number.high;
  };
  ImpedanceDeviceConfig config;
  config.handle_mass = at(preset.handle_mass);
  config.viscous = at(preset.viscous);
  config.coulomb = at(preset.coulomb);
  const SourcedNumber& step = preset.encoder_step;
  config.encoder_step = end == PresetVariant::own ? step.value : end == PresetVariant::soft ? step.high : step.low;
  config.force_max = preset.force_max.value;
  return config;
}

}  // namespace hapbench
