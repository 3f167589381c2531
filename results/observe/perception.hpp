#pragma once

#include <cstdint>
#include <optional>

#include "results/observe/butterworth.hpp"
#include "results/observe/reference_force.hpp"
#include "sim/loop/observer.hpp"

namespace hapbench {

/// From when on people feel something. The defaults are round numbers within what is published, for a hand that holds a
/// stylus; they differ between people, grips and tasks.
struct PerceptionThresholds {
  /// Smallest change of a force that is noticed, of the force itself: 7 to 10 % above half a newton (Jones 1989,
  /// Matching forces; Pang, Tan and Durlach 1991, Manual discrimination of force).
  double force_jnd = 0.1;
  /// Below this force the noticeable change is that of this force [N]: Weber's law ends there (the same).
  double least_force = 0.5;
  /// The band in which Pacinian corpuscles are most sensitive [Hz] (Bolanowski, Gescheider, Verrillo and Checkosky
  /// 1988, Four channels mediate the mechanical aspects of touch).
  double band_from = 40.0, band_to = 400.0;
  /// Amplitude of a 250 Hz vibration that is just felt [m] (the same: 0.1 to 0.2 um at a fingertip).
  double amplitude_at_250Hz = 0.15e-6;

  /// Root mean square of the acceleration of that vibration [m/s^2]. In the rising part of the band the threshold's
  /// amplitude falls as 1 / f^2, so that it is about this at every frequency.
  double acceleration_rms() const noexcept;
};

/// What a person would have felt of a run's errors and vibrations.
struct PerceptionMetrics {
  std::uint64_t rows_in_contact = 0;
  std::uint64_t reference_rows = 0;  ///< rows with a reference force
  std::uint64_t error_rows = 0;      ///< of them, those whose ||f - f_m|| is noticed
  std::uint64_t vibration_rows = 0;  ///< rows in contact whose force above 30 Hz is noticed
  std::optional<double>
      acceleration_rms;        ///< of the handle in the band [m/s^2]; none where the sampling rate holds none
  double threshold_rms = 0.0;  ///< PerceptionThresholds::acceleration_rms
};

/// Constant memory, no heap; some 60 ns a row.
class PerceptionObserver final : public Observer {
 public:
  /// `reference` may be null and must outlive this. `dt`: time from row to row [s]. Without the filters a sampling rate
  /// cannot hold, their metrics have no value; a band whose end it cannot hold ends at half of it.
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
  std::optional<HighPass> force_high_pass_;  ///< what is slower a hand means to do
  std::optional<HighPass> band_from_;
  std::optional<LowPass> band_to_;
  bool begun_ = false;
  Vec3 last_velocity_ = Vec3::Zero();
  std::uint64_t rows_ = 0;
  double acceleration_sum_ = 0.0;  ///< of squares
  PerceptionMetrics counts_;
};

}  // namespace hapbench
