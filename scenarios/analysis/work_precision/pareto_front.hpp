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

/// Returns the indices of the points on the Pareto front, ordered by increasing cost. A point is on the front if every
/// other point has a larger cost or a larger error. Of equal points, only the first is on the front.
std::vector<std::size_t> pareto_front(std::span<const CostAndError> points);

/// Returns the index of the knee of a front in `points` (Satopää et al. 2011). The coordinates are the logarithms of
/// cost and error, each scaled to [0, 1]. The knee is the interior point of the front that is farthest below the chord
/// between the ends of the front. Returns nothing if the front has fewer than four points. Also returns nothing if no
/// point is more than kMinKnee below the chord: such a front is straight or bends upwards.
std::optional<std::size_t> knee(std::span<const CostAndError> points, std::span<const std::size_t> front);

/// Smallest distance of a knee from the chord, as a fraction of the scaled axes. A timing that is wrong by 10 % shifts
/// a point by 0.04 decades of cost. On a front over one decade, this changes the distance from the chord by 0.04 /
/// sqrt(2), which must not give a straight front a knee.
inline constexpr double kMinKnee = 0.05;

}  // namespace hapbench
