#pragma once

#include "results/io/columns.hpp"
#include "sim/loop/observer.hpp"

namespace hapbench {

/// What a force stage does to the force of its algorithm.
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
    const AlgorithmWork work = algorithm_.work();
    ++metrics_.rows;
    metrics_.changed_share = static_cast<double>(work.steps_staged) / static_cast<double>(metrics_.rows);
    metrics_.taken = work.energy_staged;
  }
  /// Of the rows seen so far.
  ForceStageMetrics metrics() const noexcept { return metrics_; }

 private:
  const ForceAlgorithm& algorithm_;
  ForceStageMetrics metrics_;
};

}  // namespace hapbench
