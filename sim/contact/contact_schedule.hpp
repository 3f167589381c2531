#pragma once

#include <cstdint>

#include "sim/tool/tool_shape.hpp"

namespace hapbench {

/// How late contacts come: a slow loop finds them while a fast one renders (multi-rate rendering).
struct Lateness {
  std::int64_t every = 1;  ///< contacts are found at rows 0, every, 2 every, …
  std::int64_t delay = 0;  ///< rows from a query until its contacts serve
  bool linear = false;     ///< depths follow the tool until the next answer; else they are held
  double dropout = 0.0;    ///< probability that a query after the first is lost

  /// False where every row has its own contacts.
  bool any() const { return every > 1 || delay > 0 || dropout > 0.0; }
};

/// When a source finds contacts that does not find them in every row, and which query serves in the present row. The
/// source changes it at the first query of each row.
struct ContactSchedule {
  struct Query {
    ToolPose pose;
    std::uint64_t row = 0;
  };

  Lateness lateness;
  bool serves = false;      ///< a query has been answered
  Query latest;             ///< the query that serves, if any does
  std::uint64_t asked = 0;  ///< queries so far, lost queries included
  std::uint64_t lost = 0;

  /// The query whose contacts serve in the present row; null before the first.
  const Query* used() const noexcept { return serves ? &latest : nullptr; }
};

}  // namespace hapbench
