#pragma once

#include <optional>
#include <vector>

#include "sim/core/types.hpp"

namespace hapbench {

/// The force on the tool that was measured while a stroke was recorded [N].
class RecordedForce {
 public:
  struct Sample {
    double time = 0.0;  ///< [s], strictly increasing from sample to sample
    Vec3 force = Vec3::Zero();
  };

  /// Throws std::invalid_argument when there is no sample or times do not increase.
  explicit RecordedForce(std::vector<Sample> samples);

  /// Linear between samples; none before the first and after the last, where nothing was measured. O(log n).
  std::optional<Vec3> at(double t) const noexcept;

 private:
  std::vector<Sample> samples_;
};

}  // namespace hapbench
