#include "scenarios/run/vibration_frequency.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <complex>
#include <cstddef>
#include <numbers>
#include <vector>

#include "sim/core/math.hpp"

namespace hapbench {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
// The constants of peaks_of() in scripts/python/hapbench_audit/force.py.
constexpr std::size_t kMinForces = 64;
constexpr double kLowest = 10.0, kMinPeriods = 6.0, kProminence = 4.0, kLasting = 0.5;

double hann(std::size_t i, std::size_t samples) {
  return 0.5 - 0.5 * math::cos(kTurn * static_cast<double>(i) / static_cast<double>(samples - 1));
}

/// Replaces x by its discrete Fourier transform. The size of x is a power of two. Unlike the transforms of libraries,
/// it uses the sine and cosine of sim/core/math.hpp, so that its result has the same bits on every machine.
void transform(std::vector<std::complex<double>>& x) {
  const std::size_t n = x.size();
  for (std::size_t i = 1, j = 0; i < n; ++i) {
    std::size_t bit = n >> 1U;
    for (; (j & bit) != 0; bit >>= 1U) j ^= bit;
    j ^= bit;
    if (i < j) std::swap(x[i], x[j]);
  }
  for (std::size_t size = 2; size <= n; size *= 2)
    for (std::size_t k = 0; k < size / 2; ++k) {
      const auto [sine, cosine] = math::sine_cosine(-kTurn * static_cast<double>(k) / static_cast<double>(size));
      const std::complex<double> w(cosine, sine);
      for (std::size_t i = k; i < n; i += size) {
        const std::complex<double> a = x[i], b = w * x[i + size / 2];
        x[i] = a + b;
        x[i + size / 2] = a - b;
      }
    }
}

Vec3 mean_of(std::span<const Vec3> force) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& f : force) sum += f;
  return sum / static_cast<double>(force.size());
}

/// Returns the amplitude spectrum of the force, padded with zeros to at least four times its length.
std::vector<double> spectrum(std::span<const Vec3> force) {
  const Vec3 mean = mean_of(force);
  std::vector<std::complex<double>> x(std::bit_ceil(4 * force.size()));
  std::vector<double> amplitude(x.size() / 2 + 1);
  for (int axis = 0; axis < 3; ++axis) {
    std::ranges::fill(x, 0.0);
    for (std::size_t i = 0; i < force.size(); ++i) x[i] = hann(i, force.size()) * (force[i] - mean)[axis];
    transform(x);
    for (std::size_t i = 0; i < amplitude.size(); ++i) amplitude[i] += std::norm(x[i]);
  }
  for (double& a : amplitude) a = std::sqrt(a);
  return amplitude;
}

/// Returns the amplitude of the force at a frequency, in cycles per sample.
double amplitude_at(std::span<const Vec3> force, double frequency) {
  const Vec3 mean = mean_of(force);
  Vec3 in_phase = Vec3::Zero(), quadrature = Vec3::Zero();
  double weights = 0.0;
  for (std::size_t i = 0; i < force.size(); ++i) {
    const double weight = hann(i, force.size());
    const auto [sine, cosine] = math::sine_cosine(kTurn * frequency * static_cast<double>(i));
    in_phase += weight * cosine * (force[i] - mean);
    quadrature += weight * sine * (force[i] - mean);
    weights += weight;
  }
  return 2.0 * std::sqrt(in_phase.squaredNorm() + quadrature.squaredNorm()) / weights;
}

}  // namespace

std::optional<double> oscillation_frequency(std::span<const Vec3> force, double dt) {
  if (force.size() < kMinForces) return std::nullopt;
  const std::vector<double> amplitude = spectrum(force);
  const auto bins = static_cast<double>(2 * (amplitude.size() - 1));
  const double seconds = dt * static_cast<double>(force.size());
  // Find the largest local maximum above the lowest frequency. `per_bin`: width of a bin [Hz].
  const double per_bin = 1.0 / (bins * dt), lowest = std::max(kLowest, kMinPeriods / seconds);
  std::size_t peak = 0;
  for (std::size_t i = 1; i < amplitude.size(); ++i) {
    const bool is_maximum =
        amplitude[i] > amplitude[i - 1] && (i + 1 == amplitude.size() || amplitude[i] >= amplitude[i + 1]);
    if (is_maximum && per_bin * static_cast<double>(i) > lowest && (peak == 0 || amplitude[i] > amplitude[peak]))
      peak = i;
  }
  if (peak == 0) return std::nullopt;
  // Compare the peak with its neighbourhood: ten times the width of a peak of the Hann window, or 20 %.
  const double frequency = per_bin * static_cast<double>(peak);
  const auto reach = static_cast<std::size_t>(std::max(40.0 / seconds, 0.2 * frequency) / per_bin);
  const auto first = amplitude.begin() + static_cast<std::ptrdiff_t>(peak - std::min(peak, reach));
  std::vector<double> near(
      first, amplitude.begin() + static_cast<std::ptrdiff_t>(std::min(amplitude.size(), peak + reach + 1)));
  const auto middle = near.begin() + static_cast<std::ptrdiff_t>(near.size() / 2);
  std::nth_element(near.begin(), middle, near.end());
  if (!(amplitude[peak] > kProminence * *middle)) return std::nullopt;
  // Compare the amplitude in the middle third with the amplitude in all samples.
  const std::size_t third = force.size() / 3;
  const double cycles = frequency * dt;
  const double lasting = amplitude_at(force.subspan(third, force.size() - 2 * third), cycles);
  return lasting >= kLasting * amplitude_at(force, cycles) ? std::optional(frequency) : std::nullopt;
}

}  // namespace hapbench
