#include "scenarios/run/shared_shells.hpp"

#include <chrono>

#include "scenarios/run/assemble.hpp"

namespace hapbench {

SharedShells::SharedShells(const std::vector<std::size_t>& uses) : entries_(uses.size()) {
  for (std::size_t i = 0; i < uses.size(); ++i) entries_[i].uses = uses[i];
}

std::shared_ptr<const PointShell> SharedShells::take(std::size_t environment, const Scenario& scenario,
                                                     RunTiming* timing) {
  const auto start = std::chrono::steady_clock::now();
  Entry& entry = entries_[environment];
  const std::lock_guard lock(entry.mutex);
  if (!entry.shell) entry.shell = make_shell(scenario);
  auto shell = entry.shell;
  if (--entry.uses == 0) entry.shell.reset();
  if (timing != nullptr) {
    timing->shell = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }
  return shell;
}

}  // namespace hapbench
