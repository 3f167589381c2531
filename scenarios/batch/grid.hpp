#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "scenarios/batch/axis.hpp"

namespace hapbench {

/// Most runs of a sweep.
inline constexpr std::size_t kMostRuns = 1'000'000;

/// All combinations of the values of several axes, numbered from 0; the last axis varies fastest.
class Grid {
 public:
  /// Throws InputError for two axes of one path and for more than kMostRuns combinations. Precondition: every axis has
  /// values.
  explicit Grid(std::vector<Axis> axes);

  std::size_t size() const { return size_; }
  const std::vector<Axis>& axes() const { return axes_; }
  /// One value for each axis. Precondition: run < size().
  std::vector<std::string> values(std::size_t run) const;
  /// The same as overrides "path=value".
  std::vector<std::string> overrides(std::size_t run) const;

 private:
  std::vector<Axis> axes_;
  std::size_t size_ = 1;
};

}  // namespace hapbench
