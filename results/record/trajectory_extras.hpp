#pragma once

#include <optional>
#include <span>

#include "results/io/columns.hpp"
#include "sim/loop/observer.hpp"

namespace hapbench {

class InsideObserver;

/// The fields of a scenario's `record` that add columns to trajectory.csv.
struct TrajectoryExtras {
  bool pose = false;
  bool torque = false;
  bool inside = false;
};

/// One of these fields and its columns.
struct TrajectoryGroup {
  bool TrajectoryExtras::*is_wanted;
  const char* field;   ///< its name
  const char* effect;  ///< what it does
  std::span<const Column> columns;
  /// Writes a cell for each column. `inside` observes before the recorder; null without an inside.
  void (*fill)(const StepRecord& record, const InsideObserver* inside, std::optional<double>* cells);
  bool wants_roll = false, wants_springs = false;  ///< as those of Observer
};

/// All of them, in the order of their columns.
std::span<const TrajectoryGroup> trajectory_groups();

}  // namespace hapbench
