#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "scenarios/batch/axis.hpp"
#include "scenarios/batch/sampling.hpp"

namespace hapbench {

/// Most runs of a sweep.
inline constexpr std::size_t kMostRuns = 1'000'000;

/// The points of a sweep, numbered from 0: all combinations of the values of several axes, the last one fastest, or a
/// sample of them.
class SweepPoints {
 public:
  /// A grid. Throws InputError for two axes of one path and for more than kMostRuns combinations. Precondition: every
  /// axis has values.
  explicit SweepPoints(std::vector<Axis> axes);
  /// A sample of the box that the axes span. Throws InputError for two axes of one path and for too many axes.
  /// Precondition: every axis has a range or values.
  SweepPoints(std::vector<Axis> axes, const Sampling& sampling);

  std::size_t size() const { return size_; }
  const std::vector<Axis>& axes() const { return axes_; }
  /// None for a grid.
  const std::optional<Sampling>& sampling() const { return sampling_; }
  /// The number of the value that a run has of an axis. Precondition: the axis has a number of them (Axis::size).
  std::size_t place(std::size_t run, std::size_t axis) const;
  /// The value itself, computed anew at each call. Precondition, here and below: run < size().
  std::string value(std::size_t run, std::size_t axis) const;
  /// One value for each axis.
  std::vector<std::string> values(std::size_t run) const;
  /// The same as overrides "path=value".
  std::vector<std::string> overrides(std::size_t run) const;

 private:
  std::vector<Axis> axes_;
  std::optional<Sampling> sampling_;
  std::optional<UnitSample> sample_;
  std::vector<std::size_t> strides_;  ///< of a grid: from run to run that has the next value of an axis
  std::size_t size_ = 1;
};

}  // namespace hapbench
