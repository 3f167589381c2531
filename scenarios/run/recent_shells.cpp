#include "scenarios/run/recent_shells.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "scenarios/run/assemble.hpp"

namespace hapbench {

std::shared_ptr<const PointShell> RecentShells::of(const LoadedScenario& loaded) {
  return of(loaded, environment_content(loaded.scenario, loaded.files).dump());
}

std::shared_ptr<const PointShell> RecentShells::of(const LoadedScenario& loaded, const std::string& environment) {
  const auto entry = entry_of(environment);
  const std::lock_guard lock(entry->mutex);
  if (!entry->made) {
    entry->shell = make_shell(loaded.scenario, loaded.files);
    entry->made = true;
  }
  return entry->shell;
}

std::shared_ptr<RecentShells::Entry> RecentShells::entry_of(const std::string& environment) {
  const std::lock_guard lock(mutex_);
  const auto found = std::find_if(entries_.begin(), entries_.end(),
                                  [&](const auto& entry) { return entry->environment == environment; });
  if (found != entries_.end()) {
    entries_.splice(entries_.begin(), entries_, found);
  } else {
    entries_.push_front(std::make_shared<Entry>(environment));
    if (entries_.size() > most_) entries_.pop_back();
  }
  return entries_.front();
}

}  // namespace hapbench
