#pragma once

namespace hapbench {

/// A tool stands while it comes less than this share of the way that its target goes.
inline constexpr double kMovingShare = 0.1;

/// A tool that stood still to the end while the target of its hand went on.
struct Stuck {
  double since = 0.0;                  ///< [s]
  double way = 0.0, target_way = 0.0;  ///< of tool and target from then on [m]
};

}  // namespace hapbench
