#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "scenarios/batch/axis.hpp"
#include "scenarios/batch/sampling.hpp"
#include "scenarios/scene/load_scenario.hpp"

/// Cases: scenes with overrides, of which fields vary.
namespace hapbench {

/// Appends the texts, such as warnings of cases, that are not in the list yet.
void append_new(std::vector<std::string>& texts, const std::vector<std::string>& more);

/// Scenes with overrides, of which fields vary: all combinations of the values of the axes, the last one fastest, or a
/// sample of them. Numbered from 0. Memory: 8 bytes a case and axis of a sample, and 8 bytes a case where scenes or
/// fields of the environment vary.
class Cases {
 public:
  /// `scenes` has one, or one for each value of the axis kSceneAxis. `sets` are overrides of all cases, as in --set.
  /// Throws InputError for two axes of one path and for more than kMostRuns combinations. Precondition: without a
  /// sampling every axis has values.
  Cases(std::vector<ScenarioText> scenes, std::vector<std::string> sets, std::vector<Axis> axes,
        std::optional<Sampling> sampling = {});

  std::size_t size() const { return size_; }
  const std::vector<ScenarioText>& scenes() const { return scenes_; }
  const std::vector<std::string>& sets() const { return sets_; }
  const std::vector<Axis>& axes() const { return axes_; }
  /// None for a grid.
  const std::optional<Sampling>& sampling() const { return sampling_; }

  // Precondition, here and below: i < size().

  /// Index of the value of an axis. Precondition: Axis::size() > 0.
  std::size_t place(std::size_t i, std::size_t axis) const {
    return sampling_ ? axes_[axis].place_at(unit_[axis][i]) : i / strides_[axis] % axes_[axis].size();
  }
  /// One value for each axis, computed anew at each call.
  std::vector<std::string> values(std::size_t i) const;
  /// The values as "path=value", then what goes along with them.
  std::vector<std::string> changes(std::size_t i) const;
  const ScenarioText& scene(std::size_t i) const;
  /// The overrides of the scene: the sets, and the changes but for names.
  std::vector<std::string> overrides(std::size_t i) const;
  /// The scenario. Thread-safe. Throws InputError.
  LoadedScenario load(std::size_t i) const;
  /// The case that runs at a place of the order of runs, in which scenes, then fields of the environment vary slowest,
  /// so that neighbours share a shell; apart from that cases are in order.
  std::size_t at(std::size_t place) const { return sorted_.empty() ? place : sorted_[place]; }

 private:
  void sort_runs();
  std::string value(std::size_t i, std::size_t axis) const {
    return sampling_ ? axes_[axis].value_at(unit_[axis][i]) : axes_[axis].value(place(i, axis));
  }

  std::vector<ScenarioText> scenes_;
  std::vector<std::string> sets_;
  std::vector<Axis> axes_;
  std::optional<Sampling> sampling_;
  std::vector<std::vector<double>> unit_;  ///< by axis: the coordinates of a sample
  std::vector<std::size_t> strides_;       ///< of a grid: distance of cases with neighbouring values of an axis
  std::vector<std::size_t> sorted_;        ///< in the order of runs; empty: as they are numbered
  std::size_t size_ = 1;
};

}  // namespace hapbench
