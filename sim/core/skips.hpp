#pragma once

namespace hapbench {

/// Whether a run may skip work that cannot change its results. This is an option of the run and not of the scenario:
/// the output must be identical either way, and `off` exists to test that.
enum class Skips {
  taken,  ///< compute only what the results depend on
  off     ///< compute everything, by brute force, even if nothing reads it
};

}  // namespace hapbench
