#pragma once

#include <cstdint>
#include <optional>

#include "results/io/columns.hpp"
#include "results/observe/butterworth.hpp"
#include "results/observe/force_fidelity.hpp"
#include "sim/loop/observer.hpp"

namespace hapbench {

/// Thresholds above which people feel something. The defaults are round numbers within the published ranges, for a hand
/// that holds a stylus; thresholds differ between people, grips and tasks.
struct PerceptionThresholds {
  /// Smallest noticed change of a force, relative to that force: 7 to 10 % above half a newton (Jones 1989, Matching
  /// forces; Pang, Tan and Durlach 1991, Manual discrimination of force).
  double force_jnd = 0.1;
  /// Below this force [N] the noticed change is that of this force: Weber's law ends there (same sources).
  double least_force = 0.5;
  /// Band in which Pacinian corpuscles are most sensitive [Hz] (Bolanowski, Gescheider, Verrillo and Checkosky 1988,
  /// Four channels mediate the mechanical aspects of touch).
  double band_from = 40.0, band_to = 400.0;
  /// Amplitude of a 250 Hz vibration that is just felt [m] (same source: 0.1 to 0.2 um at a fingertip).
  double amplitude_at_250Hz = 0.15e-6;

  /// Root mean square of the acceleration of that vibration [m/s^2]. In the band the threshold's amplitude falls as
  /// 1 / f^2, so that the threshold of the acceleration is about this at every frequency.
  double acceleration_rms() const noexcept;
  /// True when half the sampling rate lies beyond the band; `dt` is the time between samples [s].
  bool band_is_sampled(double dt) const noexcept;
};

/// The errors and vibrations of a run that a person would have felt.
struct PerceptionMetrics {
  std::uint64_t rows_in_contact = 0;
  std::uint64_t reference_rows = 0;  ///< rows with a reference force
  std::uint64_t error_rows = 0;      ///< those of them whose ||f - f_m|| is noticed
  std::uint64_t vibration_rows = 0;  ///< rows in contact in which the force's vibration above 30 Hz is noticed
  bool vibration_is_sampled = false;
  std::optional<double>
      acceleration_rms;        ///< of the handle in the band [m/s^2]; nothing if the sampling rate is too low
  double threshold_rms = 0.0;  ///< PerceptionThresholds::acceleration_rms
};

MetricList metric_list(const PerceptionMetrics& perception);

/// Constant memory, no heap; about 60 ns a row.
class PerceptionObserver final : public Observer {
 public:
  /// `reference` may be null and must outlive this. `dt`: time from row to row [s]. Metrics whose band the sampling
  /// rate does not cover have no value.
  PerceptionObserver(const PerceptionThresholds& thresholds, const ReferenceForce* reference, double dt);

  void on_step(const StepRecord& record) noexcept override;
  PerceptionMetrics metrics() const noexcept;

 private:
  /// The smallest noticed change of a force of this magnitude [N].
  double noticed(double force) const noexcept;
  void add_force(const StepRecord& record) noexcept;
  void add_motion(const Vec3& velocity) noexcept;

  PerceptionThresholds thresholds_;
  const ReferenceForce* reference_;
  double dt_;
  double envelope_gain_;                     ///< of the first-order low-pass that gives vibration_square_
  double vibration_square_ = 0.0;            ///< mean square of the force's vibration [N^2]
  std::optional<HighPass> force_high_pass_;  ///< removes voluntary movement
  std::optional<HighPass> band_from_;
  std::optional<LowPass> band_to_;
  bool begun_ = false;
  Vec3 last_velocity_ = Vec3::Zero();
  std::uint64_t rows_ = 0;
  double acceleration_sum_ = 0.0;  ///< of squares
  PerceptionMetrics counts_;
};

}  // namespace hapbench
