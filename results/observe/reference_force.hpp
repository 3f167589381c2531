#pragma once

#include <array>
#include <optional>
#include <variant>
#include <vector>

#include "sim/core/profile.hpp"
#include "sim/core/types.hpp"

namespace hapbench {

/// The force on the tool that the rendered one is to match [N]: measured while a stroke was recorded, or what an ideal
/// rendering would give, where that is known.
class ReferenceForce {
 public:
  struct Sample {
    double time = 0.0;  ///< [s], strictly increasing from sample to sample
    Vec3 force = Vec3::Zero();
  };
  using Ideal = std::array<Profile, 3>;  ///< x, y, z over time

  /// Measured. Throws std::invalid_argument when there is no sample or times do not increase.
  explicit ReferenceForce(std::vector<Sample> samples);
  explicit ReferenceForce(Ideal ideal) : force_(std::move(ideal)) {}

  /// Linear between samples; none before the first and after the last, where nothing was measured. O(log n).
  std::optional<Vec3> at(double t) const noexcept;

 private:
  std::variant<std::vector<Sample>, Ideal> force_;
};

}  // namespace hapbench
