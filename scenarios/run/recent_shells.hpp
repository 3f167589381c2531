#pragma once

#include <cstddef>
#include <list>
#include <memory>
#include <mutex>
#include <string>

#include "scenarios/description/load_scenario.hpp"

namespace hapbench {

/// The point shells used last, shared by runs in equal environments that come in no known order (where it is known:
/// shared_shells.hpp). For several threads.
class RecentShells {
 public:
  /// Keeps up to `most` shells; the one used longest ago goes first. Runs may hold more.
  explicit RecentShells(std::size_t most = 12) : most_(most) {}

  /// The shell of the scenario's environment; null for springs. Waits while another thread makes it. Throws InputError
  /// when a named file cannot be used.
  std::shared_ptr<const PointShell> of(const LoadedScenario& loaded);
  /// The same where the caller has a text that is equal for equal environments, and for those alone.
  std::shared_ptr<const PointShell> of(const LoadedScenario& loaded, const std::string& environment);

 private:
  struct Entry {
    explicit Entry(std::string content) : environment(std::move(content)) {}

    std::string environment;
    std::mutex mutex;
    bool made = false;
    std::shared_ptr<const PointShell> shell;
  };
  std::shared_ptr<Entry> entry_of(const std::string& environment);
  std::size_t most_;
  std::mutex mutex_;
  std::list<std::shared_ptr<Entry>> entries_;  ///< the one used last first
};

}  // namespace hapbench
