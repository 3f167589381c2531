#include "scenarios/analysis/tuning/relaxation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "scenarios/analysis/tuning/tune_search.hpp"

namespace hapbench {
namespace {

constexpr const char* kDropRules = "--allow-vibration drops the requirement of low vibration";

/// Returns the value rounded to the three digits that are printed: upwards for a maximum, downwards for a minimum.
/// Rounding thus never makes a limit stricter.
double printed_beyond(double value, const LimitEnd& end) {
  constexpr double kRounding = 0.006;  // more than half a unit of the third digit
  return std::stod(fmt::format("{:.3g}", value + (end.is_max ? kRounding : -kRounding) * std::abs(value)));
}

/// Returns a limit in the form of --bound: MAX, or MIN:MAX.
std::string bound_text(const MetricBound& bound) {
  return bound.min ? fmt::format("{}:{}", *bound.min, bound.max.value_or(INFINITY)) : fmt::format("{}", *bound.max);
}

/// Returns the text for the user about the limits that differ in `relaxed`.
std::string relaxed_text(const TuneLimits& limits, const TuneLimits& relaxed) {
  std::string text;
  const auto append = [&](const std::string& change) { text += (text.empty() ? "" : "; ") + change; };
  for (const auto& [name, bound] : relaxed.metrics) {
    const std::string now = bound_text(limits.metrics.at(name)), then = bound_text(bound);
    if (then != now) append(fmt::format("relax {} to {} (now {})", name, then, now));
  }
  if (relaxed.allow_vibration && !limits.allow_vibration) append(kDropRules);
  return text;
}

/// Returns the ends of all limits on metrics.
std::vector<LimitEnd> ends_of(TuneLimits limits) {
  std::vector<LimitEnd> ends;
  for (const auto& [name, bound] : limits.metrics)
    for (const bool is_max : {true, false})
      if (const LimitEnd end{name, is_max}; limits.at(end)) ends.push_back(end);
  return ends;
}

/// Returns the smallest relaxation of one end of a limit. The first search ignores this end. Each further search
/// requires a value that is stricter by 4 % than the value of the previous choice. Stops if a search finds no choice,
/// or if a choice keeps the limit of the question.
std::optional<Relaxation> smallest_relaxation(Trials& trials, TuneLimits limits, const LimitEnd& end,
                                              const VerifiedSearch& search) {
  constexpr int kMaxSearches = 10;
  constexpr double kStep = 1.04;
  const double now = *limits.at(end);
  std::optional<Relaxation> smallest;
  TuneLimits relaxed = limits, next = limits;
  next.at(end).reset();
  for (int i = 0; i < kMaxSearches; ++i) {
    trials.set_aim(smallest ? smallest->text : "a relaxation of " + end.metric);
    const auto choice = search(next, end);
    if (!choice) break;
    const double kept = *choice->kept(end);
    relaxed.at(end) = printed_beyond(kept, end);
    smallest = Relaxation{relaxed_text(limits, relaxed), *choice};
    if (end.is_max ? kept <= now : kept >= now) break;
    next.at(end) = stricter(kept, end, kStep);
  }
  return smallest;
}

/// Returns the relaxation that drops the rules of low vibration; empty if it does not suffice.
std::optional<Relaxation> without_rules(Trials& trials, TuneLimits limits, const VerifiedSearch& search) {
  limits.allow_vibration = true;
  trials.set_aim(kDropRules);
  const auto choice = search(limits, std::nullopt);
  return choice ? std::optional(Relaxation{kDropRules, *choice}) : std::nullopt;
}

/// Returns true if a trial violates no limit except rules of low vibration.
bool violates_only_rules(const Trials& trials, const TuneTrial& trial) {
  return trial.limits_alone && std::ranges::all_of(trials.violated_limits(trial),
                                                   [&](const auto& entry) { return trials.is_rule(entry.first); });
}

/// Relaxes all limits that a trial violates to the values of the trial, times a factor for a maximum or divided by the
/// factor for a minimum.
TuneLimits relaxed_to(const Trials& trials, const TuneTrial& trial, TuneLimits limits, double factor) {
  for (const LimitEnd& end : ends_of(limits)) {
    const auto kept = trial.kept(end);
    std::optional<double>& allowed = limits.at(end);
    if (!kept || (end.is_max ? *kept <= *allowed : *kept >= *allowed)) continue;
    allowed = printed_beyond(factor > 1.0 ? stricter(*kept, end, 1.0 / factor) : *kept, end);
  }
  const auto violated = trials.violated_limits(trial);
  limits.allow_vibration |= std::ranges::any_of(violated, [&](const auto& e) { return trials.is_rule(e.first); });
  return limits;
}

/// Returns the trial of nearest_to_limits(), or the choice of a search without any limits. Empty if there is no such
/// trial.
std::optional<TuneTrial> nearest_trial(Trials& trials, const TuneLimits& limits, const VerifiedSearch& search) {
  if (const TuneTrial* nearest = nearest_to_limits(trials, limits)) return *nearest;
  TuneLimits none = limits;
  none.allow_vibration = true;
  for (const LimitEnd& end : ends_of(limits)) none.at(end).reset();
  return search(none, std::nullopt);
}

/// Returns a relaxation of all limits that the nearest_trial() violates. Its search keeps the relaxed limits.
std::optional<Relaxation> joint_relaxation(Trials& trials, const TuneLimits& limits, const VerifiedSearch& search) {
  const auto nearest = nearest_trial(trials, limits, search);
  if (!nearest) return std::nullopt;
  trials.begin_search(limits);
  const TuneTrial trial = trials.evaluated(*nearest, Need::all);
  // The trial may keep the rules of low vibration although stiffnesses slightly below it violate them. The last attempt
  // therefore drops the rules.
  for (const auto& [factor, drops_rules] : {std::pair(1.0, false), {1.1, false}, {1.5, false}, {1.1, true}}) {
    trials.change_limits(limits);
    TuneLimits relaxed = relaxed_to(trials, trial, limits, factor);
    if (drops_rules && std::exchange(relaxed.allow_vibration, true)) continue;  // was tried before
    const std::string text = relaxed_text(limits, relaxed);
    if (text.empty()) continue;  // relaxes nothing
    trials.set_aim(text);
    if (const auto choice = search(relaxed, std::nullopt)) return Relaxation{text, *choice};
  }
  return std::nullopt;
}

}  // namespace

const TuneTrial* nearest_to_limits(Trials& trials, const TuneLimits& limits) {
  constexpr std::size_t kMaxCompleted = 8;
  trials.begin_search(limits);
  trials.recall_all();
  for (const TuneTrial* trial : trials.nearest(kMaxCompleted))
    if (!trials.evaluated(*trial, Need::all).failure) return trial;
  return nullptr;
}

std::vector<Relaxation> relaxations(Trials& trials, const TuneLimits& limits, const VerifiedSearch& search) {
  std::vector<Relaxation> found;
  // Decide before the searches below, which change the limits of `trials`.
  const TuneFailure* refuted = trials.last_refuted();
  const bool vibrates_nearby = refuted != nullptr && trials.is_rule(refuted->binding);
  const bool rules_alone =
      !limits.allow_vibration && (vibrates_nearby || std::ranges::any_of(trials.all(), [&](const auto& entry) {
                                    return violates_only_rules(trials, entry.second);
                                  }));
  for (const LimitEnd& end : ends_of(limits))
    if (auto relaxation = smallest_relaxation(trials, limits, end, search)) found.push_back(std::move(*relaxation));
  if (rules_alone)
    if (auto relaxation = without_rules(trials, limits, search)) found.push_back(std::move(*relaxation));
  if (found.empty())
    if (auto relaxation = joint_relaxation(trials, limits, search)) found.push_back(std::move(*relaxation));
  return found;
}

}  // namespace hapbench
