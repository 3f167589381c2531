#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "results/summary/timing.hpp"
#include "scenarios/description/scenario.hpp"

namespace hapbench {

/// The point shells of the environments of many runs, each made once, by the first run in it, and dropped after the
/// last one. For several threads.
class SharedShells {
 public:
  /// `uses` says for each environment how many runs are in it.
  explicit SharedShells(const std::vector<std::size_t>& uses);

  /// The shell of an environment, which is the scenario's; null for springs. Waits while another thread makes it. To be
  /// called once for each run in it. `timing`, if given, learns how long that took. Throws InputError when a named file
  /// cannot be used.
  std::shared_ptr<const PointShell> take(std::size_t environment, const Scenario& scenario,
                                         RunTiming* timing = nullptr);

 private:
  struct Entry {
    std::mutex mutex;
    std::size_t uses = 0;  ///< still to come
    std::shared_ptr<const PointShell> shell;
  };
  std::vector<Entry> entries_;
};

}  // namespace hapbench
