#pragma once

namespace hapbench {

/// Whether a run leaves out work that cannot change its results. A switch of the run, not of the scenario: results are
/// the same bytes either way, which is what turning skips off is for.
enum class Skips {
  taken,  ///< only what is needed is computed
  off     ///< everything is computed, by brute force and whether or not anybody looks at it
};

}  // namespace hapbench
