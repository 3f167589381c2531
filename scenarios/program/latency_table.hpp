#pragma once

#include "results/observe/step_times.hpp"
#include "scenarios/program/table.hpp"

namespace hapbench {

/// Step latencies for the terminal, a row each: percentiles in microseconds and the steps that missed a deadline.
class LatencyTable {
 public:
  LatencyTable();
  void add(const std::string& name, const StepLatency& latency);
  std::string text() const { return table_.text(); }

 private:
  Table table_;
};

}  // namespace hapbench
