#include "scenarios/analysis/tuning/explanation.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "scenarios/analysis/tuning/verification.hpp"

namespace hapbench {
namespace {

/// Returns a clause with the K and the setting that are feasible after the limit is relaxed.
std::string then_text(const TuneTrial& trial) {
  return fmt::format("then K = {:.4g} N/m{}", trial.stiffness, setting_text(trial.setting));
}

/// Returns a clause with a relaxed value of a limit, at which the trial keeps the limit. The value includes the
/// metric's error.
std::string relaxed(const Trials& trials, const TuneTrial& trial, const std::string& name) {
  const auto worst = value_in(trial.worst, name);
  if (!worst) return fmt::format("drop the bound on {}, which has no value here", name);
  const double more = value_in(trials.error(), name).value_or(0.0);
  const auto requested = trials.question().limits.find(name);
  const MetricBound& bound = requested == trials.question().limits.end() ? trials.limit_on(name) : requested->second;
  if (bound.max)
    return fmt::format("relax {} to at most {:.3g} (now {:.3g})", name, (*worst + more) * 1.001, *bound.max);
  return fmt::format("relax {} to at least {:.3g} (now {:.3g})", name, (*worst - more) * 0.999,
                     bound.min.value_or(0.0));
}

/// Returns for each limit the smallest relaxation of this limit alone with which a trial keeps all limits; if there is
/// no such trial, the relaxations that the nearest trial needs.
std::string relaxations(const Trials& trials, const TuneTrial& nearest) {
  // For each limit, find among the trials that violate only this limit the trial with the smallest ratio to the
  // limit.
  std::map<std::string, std::pair<double, const TuneTrial*>> smallest;
  for (const auto& [key, trial] : trials.all()) {
    const TuneMetrics violated = trial.limits_alone ? trials.violated_limits(trial) : TuneMetrics();
    if (violated.size() != 1) continue;
    const auto& [name, ratio] = *violated.begin();
    const auto entry = smallest.try_emplace(name, ratio, &trial).first;
    if (ratio < entry->second.first) entry->second = {ratio, &trial};
  }
  std::vector<std::string> texts;
  for (const auto& [name, trial] : smallest)
    texts.push_back(relaxed(trials, *trial.second, name) + "; " + then_text(*trial.second));
  if (!texts.empty()) return fmt::format("{}", fmt::join(texts, "; or "));
  // No trial violates a single limit only: name all relaxations that the nearest trial needs.
  for (const auto& [name, ratio] : trials.violated_limits(nearest)) texts.push_back(relaxed(trials, nearest, name));
  return fmt::format("{}; {}", fmt::join(texts, "; "), then_text(nearest));
}

}  // namespace

void explain(Trials& trials, TunedLaw& law) {
  // Choose the trial to explain.
  const TuneTrial* nearest = trials.nearest();
  const auto lacks_margin = [](const auto& tried) { return tried.second.binding == "margin"; };
  const auto found = std::ranges::find_if(trials.all(), lacks_margin);
  const TuneTrial& other = found != trials.all().end() ? found->second : trials.all().rbegin()->second;
  const TuneTrial& trial = nearest != nullptr ? *nearest : other;
  law.binding = trial.binding;
  law.why = trial.why;
  if (nearest == nullptr) {
    law.relax = law.binding == "margin" ? "a smaller --margin may help; otherwise try" : "no bound is responsible; try";
    law.relax += " a gentler hand, a wider tool, another device, or other runs with --family";
    return;
  }
  if (!trials.requires_low_vibration()) trials.set_error(known_errors(trials, trial));
  if (const auto error = value_in(trials.error(), law.binding); error.value_or(0.0) > 0.0)
    law.why += fmt::format(" +- {:.2g}", *error);
  law.relax = relaxations(trials, trial);
  if (trials.requires_low_vibration())
    law.relax +=
        "; a bound of your own, such as --bound force_rms_above_30Hz_N=0.05, replaces the rules of low vibration";
}

}  // namespace hapbench
