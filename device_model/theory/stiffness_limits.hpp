#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "device_model/theory/sampled_loop.hpp"

/// What the literature knows of the largest stiffness K that an impedance device renders.
namespace hapbench {

/// One known limit. `b` in the texts is the handle's damping, `m` the moving mass, t_d = d T.
struct StiffnessLimit {
  const char* name;  ///< of its column and its curve
  const char* formula;
  const char* source;
  const char* applies;  ///< when it does
  /// The largest K [N/m] of the loop, whose own K does not count; none where the limit does not apply, zero where it
  /// allows no K, infinite where it allows every K.
  std::optional<double> (*largest)(const SampledLoop& loop);
};

/// The table. A limit is a row of it; those who draw and write limits go through it.
std::span<const StiffnessLimit> stiffness_limits();

/// Null when the table has no such name.
const StiffnessLimit* find_stiffness_limit(std::string_view name);

}  // namespace hapbench
