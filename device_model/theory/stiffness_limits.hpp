#pragma once

#include <optional>
#include <span>

#include "device_model/theory/linear_loops.hpp"

/// Known limits of the stiffness K that an impedance device can render.
namespace hapbench {

/// A limit from the literature. In the texts, b is the damping of the handle, m the moving mass, t_d = d T.
struct StiffnessLimit {
  const char* name;  ///< name of its column and its curve
  const char* formula;
  const char* source;
  const char* applies;  ///< conditions
  /// The largest K [N/m], whatever the loop's own K is. No value if the limit does not apply, zero if it allows no K,
  /// infinity if it allows every K.
  std::optional<double> (*largest)(const SampledLoop& loop);
};

/// The table of limits, which everything that draws or writes limits reads.
std::span<const StiffnessLimit> stiffness_limits();

}  // namespace hapbench
