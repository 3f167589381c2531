#include "device_model/velocity_filter.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "sim/core/math.hpp"

namespace hapbench {
namespace {

using Complex = std::complex<double>;

/// A pole of the filter of cut-off 1 rad/s; the k-th in the upper half of the plane, the last of an odd order real.
Complex unit_pole(std::size_t k, std::size_t order) {
  if (2 * k + 1 == order) return {-1.0, 0.0};
  const auto [sine, cosine] =
      math::sine_cosine(std::numbers::pi * static_cast<double>(2 * k + 1) / static_cast<double>(2 * order));
  return {-sine, cosine};
}

/// e^z - 1, to rounding also for small z.
Complex exponential_minus_one(const Complex& z) {
  const double grown = math::expm1(z.real()), half = math::sin(0.5 * z.imag());
  return {grown - 2.0 * (1.0 + grown) * half * half, (1.0 + grown) * math::sin(z.imag())};
}

}  // namespace

// H(s) is the product of p_i / (p_i - s), which is the sum of share_i p_i / (p_i - s).
std::vector<LowPassMode> low_pass_modes(const LowPassFilter& filter, double dt) {
  std::vector<Complex> poles;
  const std::size_t order = filter.order, upper = (order + 1) / 2;
  for (std::size_t k = 0; k < upper; ++k) poles.push_back(unit_pole(k, order));
  for (std::size_t k = 0; k < order / 2; ++k) poles.push_back(std::conj(poles[k]));
  std::vector<LowPassMode> modes;
  for (std::size_t i = 0; i < upper; ++i) {
    const bool is_real = poles[i].imag() == 0.0;
    Complex share = is_real ? 1.0 : 2.0;
    for (std::size_t j = 0; j < order; ++j) {
      if (j == i) continue;
      const Complex apart = poles[j] - poles[i];
      share *= poles[j] * std::conj(apart) / std::norm(apart);
    }
    const double angle = -2.0 * std::numbers::pi * filter.cutoff * dt;  // negative, as in expm1(-2 pi f T)
    const Complex taken = -exponential_minus_one(-angle * poles[i]);
    modes.push_back(is_real ? LowPassMode{share.real(), -math::expm1(angle)} : LowPassMode{share, taken});
  }
  return modes;
}

std::complex<double> LowPassMode::response(double theta) const {
  const auto [sine, cosine] = math::sine_cosine(theta);
  const Complex back(cosine, -sine);
  const auto of = [&back](const Complex& s, const Complex& t) { return t * s / (1.0 - (1.0 - t) * back); };
  return 0.5 * (of(share, taken) + of(std::conj(share), std::conj(taken)));
}

SampledLowPass::SampledLowPass(const LowPassFilter& filter, double dt) {
  for (const LowPassMode& mode : low_pass_modes(filter, dt)) {
    terms_.push_back({.mode = mode});
    passes_all_ = passes_all_ && mode.taken == 1.0;
  }
}

void SampledLowPass::settle_at(const Vec3& value) noexcept {
  for (Term& term : terms_) {
    term.real = term.mode.share.real() * value;
    term.imaginary = term.mode.share.imag() * value;
  }
}

Vec3 SampledLowPass::filter(const Vec3& sample) noexcept {
  if (passes_all_) return sample;
  Vec3 output = Vec3::Zero();
  for (auto& [mode, real, imaginary] : terms_) {
    const Vec3 to_real = mode.share.real() * sample - real, to_imaginary = mode.share.imag() * sample - imaginary;
    real += mode.taken.real() * to_real - mode.taken.imag() * to_imaginary;
    imaginary += mode.taken.real() * to_imaginary + mode.taken.imag() * to_real;
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
  velocity_.setZero();
  if (low_pass_) low_pass_->settle_at(velocity_);
}

Vec3 VelocityFilter::read(const Vec3& position) noexcept {
  samples_[next_] = position;
  next_ = (next_ + 1) % samples_.size();
  known_ = std::min(known_ + 1, samples_.size());
  if (const auto* window = std::get_if<AdaptiveWindowFilter>(&config_)) {
    for (Eigen::Index axis = 0; axis < 3; ++axis) velocity_[axis] = end_fit(axis, window->noise);
    return velocity_;
  }
  const Vec3 difference = (position - sample(1)) / dt_;
  velocity_ = low_pass_ ? low_pass_->filter(difference) : difference;
  return velocity_;
}

double VelocityFilter::end_fit(Eigen::Index axis, double noise) const noexcept {
  const double now = sample(0)[axis];
  double rise = 0.0;  // of the line per sample
  for (std::size_t n = 1; n < known_; ++n) {
    const double longer = (now - sample(n)[axis]) / static_cast<double>(n);
    for (std::size_t i = 1; i < n; ++i) {
      if (std::abs(now - longer * static_cast<double>(i) - sample(i)[axis]) > noise) return rise / dt_;
    }
    rise = longer;
  }
  return rise / dt_;
}

}  // namespace hapbench
