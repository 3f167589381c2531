#include "scenarios/thesis_claims/swing_decay.hpp"

#include <cmath>
#include <numbers>

namespace hapbench {

void SwingDecay::add(double x) {
  const bool is_extreme = rows_ >= 2 && (last_ - before_) * (x - last_) < 0.0;
  if (is_extreme && !decayed_) {
    const double extreme = std::abs(last_);
    if (extreme < kSmallest) {
      decayed_ = true;
    } else {
      if (extremes_ == 0) first_extreme_ = extreme;
      last_extreme_ = extreme;
      ++extremes_;
    }
  }
  before_ = last_;
  last_ = x;
  ++rows_;
}

double SwingDecay::damping_ratio() const {
  if (extremes_ < 2) return std::abs(last_) < kSmallest ? 1.0 : 0.0;
  const double q = std::pow(last_extreme_ / first_extreme_, 1.0 / static_cast<double>(extremes_ - 1));
  if (q >= 1.0) return 0.0;
  const double log_q = std::log(q);
  return -log_q / std::sqrt(std::numbers::pi * std::numbers::pi + log_q * log_q);
}

}  // namespace hapbench
