#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "scenarios/batch/axis.hpp"
#include "scenarios/batch/sampling.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/scene/load_scenario.hpp"

/// Cases of a batch: scenes with overrides, in which some fields vary.
namespace hapbench {

/// Appends each text of `more`, such as a warning, that `texts` does not contain yet.
void append_new(std::vector<std::string>& texts, const std::vector<std::string>& more);

/// The cases of a batch, numbered from 0: scenes with overrides, in which some fields vary. The cases are
/// either a grid (all combinations of the axes' values; the last axis varies fastest) or a sample. Memory: 8
/// bytes for each case and axis of a sample, and 8 bytes for each case if scenes or environment fields vary.
class Cases {
 public:
  /// `scenes` contains one scene, or one for each value of the axis kSceneAxis. `sets` are overrides for all
  /// cases, as in --set. Precondition: without a sampling, every axis has values. Throws InputError if two axes
  /// have the same path, if one axis would override the values of another axis, or for more than kMaxRuns
  /// combinations.
  Cases(std::vector<ScenarioText> scenes, std::vector<std::string> sets, std::vector<Axis> axes,
        std::optional<Sampling> sampling = {});

  std::size_t size() const { return size_; }
  const std::vector<ScenarioText>& scenes() const { return scenes_; }
  const std::vector<std::string>& sets() const { return sets_; }
  const std::vector<Axis>& axes() const { return axes_; }
  /// Returns the sampling; empty for a grid.
  const std::optional<Sampling>& sampling() const { return sampling_; }

  // Precondition of all following functions: i < size().

  /// Returns the index of the axis value that case i has. Precondition: the axis has listed values or is part
  /// of a grid.
  std::size_t value_index(std::size_t i, std::size_t axis) const {
    return sampling_ ? axes_[axis].index_at(unit_[axis][i]) : i / strides_[axis] % axes_[axis].size();
  }
  /// Returns the value of each axis in case i. The values are computed at each call.
  std::vector<std::string> values(std::size_t i) const;
  /// Returns the values of case i as "path=value", followed by the overrides of Axis::along.
  std::vector<std::string> changes(std::size_t i) const;
  /// Returns the scene of case i.
  const ScenarioText& scene(std::size_t i) const;
  /// Returns all overrides of case i: `sets` and the changes, without values that are only labels
  /// (Axis::named).
  std::vector<std::string> overrides(std::size_t i) const;
  /// Loads the scenario of case i. Thread-safe. Throws InputError.
  LoadedScenario load(std::size_t i) const;
  /// Returns the case at a position of the execution order. In this order, scenes vary slowest, then fields of
  /// the environment, so that consecutive runs can share a point shell. Cases with equal scene and environment
  /// are in the order of their numbers.
  std::size_t at(std::size_t position) const { return sorted_.empty() ? position : sorted_[position]; }

 private:
  void sort_runs();
  LoadedScenario load_case(std::size_t i) const;
  /// Returns a copy of `error` in which each fault in a field of an axis is located at the line of case i in the file
  /// of --points.
  InputError with_line_of_point(const InputError& error, std::size_t i) const;
  std::string value(std::size_t i, std::size_t axis) const {
    return sampling_ ? axes_[axis].value_at(unit_[axis][i]) : axes_[axis].value(value_index(i, axis));
  }

  std::vector<ScenarioText> scenes_;
  std::vector<std::string> sets_;
  std::vector<Axis> axes_;
  std::optional<Sampling> sampling_;
  std::vector<std::vector<double>> unit_;  ///< sample: coordinates in [0, 1) by axis, then by case
  /// For each axis of a grid: difference between the numbers of two cases with neighbouring values of this axis.
  std::vector<std::size_t> strides_;
  std::vector<std::size_t> sorted_;  ///< cases in execution order; empty: in the order of their numbers
  std::size_t size_ = 1;
};

}  // namespace hapbench
