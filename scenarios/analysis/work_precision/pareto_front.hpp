#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

/// Pareto fronts of cost and error, and their knees.
namespace hapbench {

/// A setting with its cost and error. Both are > 0.
struct CostAndError {
  double cost = 0.0, error = 0.0;
};

/// Returns the indices of the points that no other point beats in both cost and error, ordered by increasing cost.
std::vector<std::size_t> pareto_front(std::span<const CostAndError> points);

/// Returns the index of the knee: the interior point of the front that is farthest below the chord between the ends of
/// the front, in the logarithms of cost and error, each scaled to [0, 1] (Satopää et al. 2011). Returns nothing for
/// fewer than four points, and for a front that is straight or bends upwards: no point is more than kMinKnee below the
/// chord.
std::optional<std::size_t> knee(std::span<const CostAndError> points, std::span<const std::size_t> front);

/// Smallest distance of a knee from the chord, as a fraction of the scaled axes. A timing that is wrong by 10 % shifts
/// a point by 0.04 decades of cost. On a front over one decade, this changes the distance from the chord by 0.04 /
/// sqrt(2), which must not give a straight front a knee.
inline constexpr double kMinKnee = 0.05;

}  // namespace hapbench
