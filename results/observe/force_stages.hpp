#pragma once

#include <algorithm>
#include <cstdint>

#include "results/io/columns.hpp"
#include "sim/loop/observer.hpp"

namespace hapbench {

/// How a tool under dry friction goes: by sticking or by sliding.
struct FrictionMetrics {
  std::uint64_t rows_with_load = 0;  ///< rows in which friction sticks or slides
  double stick_share = 0.0;          ///< share of these in which it sticks
  double slips_per_s = 0.0;          ///< times that a sticking tool began to slide, per second of the run
};

MetricList metric_list(const FrictionMetrics& friction);

/// Counts what dry friction (algorithms/stages/damping_and_limits.hpp) does. Constant memory.
class FrictionObserver final : public Observer {
 public:
  explicit FrictionObserver(double dt) : dt_(dt) {}

  void on_step(const StepRecord& record) noexcept override;

  /// The metrics of the rows seen so far.
  FrictionMetrics metrics() const noexcept;

 private:
  double dt_;
  std::uint64_t rows_ = 0, sticking_ = 0, sliding_ = 0, slips_ = 0;
  Friction last_ = Friction::none;
};

/// How much a force stage changes the force of its algorithm.
struct ForceStageMetrics {
  std::uint64_t rows = 0;
  double changed_share = 0.0;  ///< share of the rows in which it changes the force
  double taken = 0.0;          ///< energy that it kept the force from giving to the tool [J]
};

inline MetricList metric_list(const ForceStageMetrics& m) {
  return {{"changed_share", "1", "share of the rows in which the force stage changes the force",
           if_any(m.rows > 0, m.changed_share)},
          {"taken_J", "J", "energy that the force stage kept the force from giving to the tool, along the way it went",
           if_any(m.rows > 0, m.taken)}};
}

/// Reads the work of an algorithm with a force stage in every row.
class ForceStageObserver final : public Observer {
 public:
  /// `algorithm` must live as long as rows are observed.
  explicit ForceStageObserver(const ForceAlgorithm& algorithm) : algorithm_(algorithm) {}

  void on_step(const StepRecord&) noexcept override {
    ++rows_;
    work_ = algorithm_.work();
  }
  /// The metrics of all rows up to the present one.
  ForceStageMetrics metrics() const noexcept {
    return {rows_, static_cast<double>(work_.steps_staged) / static_cast<double>(std::max<std::uint64_t>(rows_, 1)),
            work_.energy_staged};
  }

 private:
  const ForceAlgorithm& algorithm_;
  std::uint64_t rows_ = 0;
  AlgorithmWork work_;
};

}  // namespace hapbench
