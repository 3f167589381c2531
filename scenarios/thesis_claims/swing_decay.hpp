#pragma once

#include <cstddef>

namespace hapbench {

/// The damping ratio that the decay of a swing shows: from the ratio q of successive extremes, about zero,
/// zeta = -ln q / sqrt(pi^2 + ln^2 q). Takes a coordinate row by row.
class SwingDecay {
 public:
  /// Extremes closer to zero than this end the decay [m]: rounding and grazing contact are no swings.
  static constexpr double kSmallest = 1e-6;

  void add(double x);
  /// From the first and the last extreme; 0 for a motion that has fewer than two and has not come to zero, as nothing
  /// brings it back, 1 for one that comes to zero without a swing.
  double damping_ratio() const;

 private:
  double before_ = 0.0, last_ = 0.0;
  std::size_t rows_ = 0;
  std::size_t extremes_ = 0;
  bool decayed_ = false;
  double first_extreme_ = 0.0, last_extreme_ = 0.0;
};

}  // namespace hapbench
