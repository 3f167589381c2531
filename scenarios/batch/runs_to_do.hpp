#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "scenarios/batch/shard.hpp"
#include "scenarios/batch/sweep_points.hpp"

namespace hapbench {

/// A text that is equal for runs whose varied fields of the environment have equal values; empty when none varies.
std::string environment_of(const SweepPoints& points, std::size_t run);

/// The runs of a shard one by one: those of one environment after each other, so that few shells are needed at a time,
/// and in their order besides. Where no listed field of the environment varies that needs no memory, otherwise 8 bytes
/// a run. `points` must outlive it.
class RunsToDo {
 public:
  RunsToDo(const SweepPoints& points, const Shard& shard);

  std::optional<std::size_t> next();

 private:
  Shard shard_;
  std::size_t count_;
  std::size_t given_ = 0;
  std::vector<std::uint64_t> order_;  ///< environment and run, each in half of the bits; or empty
};

}  // namespace hapbench
