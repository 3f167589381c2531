#pragma once

#include <cstdint>

#include "sim/tool/tool_shape.hpp"

namespace hapbench {

/// Timing of multi-rate contacts: a slow loop finds the contacts while the fast loop renders the force in every
/// step.
struct MultiRateSchedule {
  std::int64_t every = 1;  ///< contacts are searched in steps 0, every, 2 every, …
  std::int64_t delay = 0;  ///< steps from a query until its contacts are used
  bool linear = false;     ///< true: depths follow the tool's motion until the next result; false: depths are held
  double dropout = 0.0;    ///< probability that a query is lost; the first query is never lost

  /// Returns true if contacts are held, delayed or lost; false if every step searches and uses its own contacts.
  bool any() const { return every > 1 || delay > 0 || dropout > 0.0; }
};

/// State of multi-rate contacts: their timing and the query whose contacts are used in the current step. The
/// contact source updates it at the first query of each step.
struct ContactSchedule {
  /// A query of the slow loop: the tool's pose and the step in which the query was sent.
  struct Query {
    ToolPose pose;
    std::uint64_t row = 0;
  };

  MultiRateSchedule timing;
  bool has_result = false;    ///< true once a query has returned contacts
  Query latest;               ///< query whose contacts are used; undefined while no query has returned
  std::uint64_t queries = 0;  ///< queries sent so far, including lost queries
  std::uint64_t lost = 0;

  /// Returns the query whose contacts are used in the current step, or null if no query has returned yet.
  const Query* used() const noexcept { return has_result ? &latest : nullptr; }
};

}  // namespace hapbench
