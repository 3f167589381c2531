#include "scenarios/run/shared_shells.hpp"

#include "scenarios/run/assemble.hpp"
#include "scenarios/run/environment_points.hpp"

namespace hapbench {

SharedShells::SharedShells(const std::vector<std::size_t>& uses, ShellCache cache)
    : entries_(uses.size()), cache_(std::move(cache)) {
  for (std::size_t i = 0; i < uses.size(); ++i) entries_[i].uses = uses[i];
}

std::shared_ptr<const PointShell> SharedShells::take(std::size_t environment, const Scenario& scenario) {
  Entry& entry = entries_[environment];
  const std::lock_guard lock(entry.mutex);
  if (!entry.shell) entry.shell = make_shell(scenario, environment_points(scenario, cache_));
  auto shell = entry.shell;
  if (--entry.uses == 0) entry.shell.reset();
  return shell;
}

}  // namespace hapbench
