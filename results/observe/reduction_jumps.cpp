#include "results/observe/reduction_jumps.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <span>

namespace hapbench {
namespace {

constexpr double kFarMore = 3.0;

}  // namespace

ReductionJumps& ReductionJumps::operator+=(const ReductionJumps& other) noexcept {
  changes += other.changes;
  step_max_squared = std::max(step_max_squared, other.step_max_squared);  // nothing is less than any number
  step_max_squared_elsewhere = std::max(step_max_squared_elsewhere, other.step_max_squared_elsewhere);
  return *this;
}

std::optional<double> ReductionJumps::step_max() const noexcept {
  return step_max_squared ? std::optional(std::sqrt(*step_max_squared)) : std::nullopt;
}

double ReductionJumps::step_max_elsewhere() const noexcept {
  return std::sqrt(step_max_squared_elsewhere);
}

bool ReductionJumps::stand_out() const noexcept {
  return step_max().value_or(0.0) > kFarMore * step_max_elsewhere();
}

void ReductionJumpObserver::add(const ContactBuffer& kept, double step_squared, bool settled) noexcept {
  const std::span now(kept.index.data(), kept.size());
  const bool same = std::is_permutation(now.begin(), now.end(), last_.begin(), last_.end());
  const bool changed = !same && !now.empty() && !last_.empty();
  if (changed) ++jumps_.changes;
  if (settled && changed) jumps_.step_max_squared = std::max(jumps_.step_max_squared.value_or(0.0), step_squared);
  if (settled && !changed && !changed_) {
    jumps_.step_max_squared_elsewhere = std::max(jumps_.step_max_squared_elsewhere, step_squared);
  }
  changed_ = changed;
  assert(now.size() <= last_.capacity());
  if (!same) last_.assign(now.begin(), now.end());
}

}  // namespace hapbench
