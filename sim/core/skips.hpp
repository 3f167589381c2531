#pragma once

namespace hapbench {

/// Whether a run may skip work that cannot change its results. The output must be identical either way, and `off`
/// exists to test that. So it is no field of a scenario file, though a scenario in memory carries it, beside what the
/// force algorithm is made of (RenderingConfig).
enum class Skips {
  taken,  ///< compute only what the results depend on
  off     ///< compute everything, by brute force, even if nothing reads it
};

}  // namespace hapbench
