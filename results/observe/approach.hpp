#pragma once

#include <limits>

#include "sim/core/types.hpp"
#include "sim/loop/observer.hpp"

namespace hapbench {

/// Distance of the tool's tip centre to the box around an environment; 0 within the box.
struct Approach {
  double closest = std::numeric_limits<double>::infinity();  ///< [m]
  double closest_time = 0.0;                                 ///< of the first row that close [s]
  double last = std::numeric_limits<double>::infinity();     ///< of the last row [m]
};

/// Measures the approach during a run; a few nanoseconds a row.
class ApproachObserver final : public Observer {
 public:
  explicit ApproachObserver(const Box& environment) : environment_(environment) {}

  void on_step(const StepRecord& record) noexcept override {
    approach_.last = distance_to(environment_, record.tool.pose.position);
    if (approach_.last >= approach_.closest) return;
    approach_.closest = approach_.last;
    approach_.closest_time = record.time;
  }
  const Approach& approach() const { return approach_; }
  const Box& environment() const { return environment_; }

 private:
  Box environment_;
  Approach approach_;
};

}  // namespace hapbench
