#include "scenarios/analysis/tuning/explanation.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace hapbench {
namespace {

using IsFeasible = std::function<bool(const TuneLimits& limits)>;

constexpr const char* kRules = "the requirement of low vibration";

/// Relaxed limits, and a text for the user about their changes.
struct Relaxation {
  TuneLimits limits;
  std::string text;
};

/// Returns the value rounded to the three digits that are printed: upwards if `up` is true, otherwise downwards.
/// Rounding thus never makes a limit stricter.
double printed_beyond(double value, bool up) {
  constexpr double kRounding = 0.006;  // more than half a unit of the third digit
  return std::stod(fmt::format("{:.3g}", value + (up ? kRounding : -kRounding) * std::abs(value)));
}

/// Relaxes the limit `name`, which a trial violates. A maximum becomes (worst value + error) * factor, a minimum
/// becomes (worst value - error) / factor; worst value and error of the metric come from the trial. If `name` is a
/// low-vibration rule, drops all low-vibration rules instead. Returns false if the metric has no value.
bool relax(const Trials& trials, const TuneTrial& trial, const std::string& name, double factor,
           Relaxation& relaxation) {
  const auto append = [&](const std::string& text) { relaxation.text += (relaxation.text.empty() ? "" : "; ") + text; };
  if (trials.is_rule(name)) {
    if (!relaxation.limits.allow_vibration) append("--allow-vibration drops " + std::string(kRules));
    relaxation.limits.allow_vibration = true;
    return true;
  }
  const auto worst = value_in(trial.worst, name);
  if (!worst) return false;
  const double error = value_in(trial.error, name).value_or(0.0);
  MetricBound& bound = relaxation.limits.metrics.at(name);
  const MetricBound now = bound;
  if (now.max && *worst + error > *now.max) {
    bound.max = printed_beyond((*worst + error) * factor, true);
    append(fmt::format("relax {} to {:.3g} (now {:.3g})", name, *bound.max, *now.max));
  }
  if (now.min && *worst - error < *now.min) {
    bound.min = printed_beyond((*worst - error) / factor, false);
    append(fmt::format("relax {} to {:.3g} (now {:.3g})", name, *bound.min, *now.min));
  }
  return true;
}

/// Relaxes all limits that a trial violates, by relax() with the factors 1, 1.1 and 1.5 in turn, until a search finds a
/// verified choice that keeps the relaxed limits. Returns the text of this relaxation; empty if no factor leads to a
/// verified choice.
std::optional<std::string> confirmed(Trials& trials, const TuneLimits& limits, const TuneTrial& trial,
                                     const MetricValues& violated, const IsFeasible& is_feasible) {
  for (const double factor : {1.0, 1.1, 1.5}) {
    Relaxation relaxation{limits, ""};
    for (const auto& [name, ratio] : violated)
      if (!relax(trials, trial, name, factor, relaxation)) return std::nullopt;
    trials.set_aim(relaxation.text);
    if (is_feasible(relaxation.limits)) return relaxation.text;
    if (relaxation.limits.allow_vibration && violated.size() == 1) break;  // a larger factor changes nothing
  }
  return std::nullopt;
}

/// Returns the limit that a trial violates, if it violates a single limit; otherwise an empty text. All rules of low
/// vibration count as one limit.
std::string single_limit(const Trials& trials, const TuneTrial& trial) {
  std::string single;
  if (!trial.limits_alone) return single;
  for (const auto& [name, ratio] : trials.violated_limits(trial)) {
    const std::string limit = trials.is_rule(name) ? kRules : name;
    if (!single.empty() && single != limit) return "";
    single = limit;
  }
  return single;
}

/// Returns, for each limit, up to `count` trials that violate only this limit, the smallest excess first.
std::map<std::string, std::vector<const TuneTrial*>> candidates(Trials& trials, std::size_t count) {
  std::map<std::string, std::vector<const TuneTrial*>> all;
  for (const auto& [key, trial] : trials.all())
    if (const std::string limit = single_limit(trials, trial); !limit.empty()) all[limit].push_back(&trial);
  for (auto& [name, found] : all) {
    const auto is_of_limit = [&, &limit = name](const TuneTrial& trial) {
      return single_limit(trials, trial) == limit;
    };
    found = trials.smallest_excess(std::move(found), count, /*one_per_setting=*/false, is_of_limit);
  }
  return all;
}

/// Returns true if a trial violates no other limit than `name`. Precondition: the trial was evaluated as far as
/// Need::all.
bool violates_only(const Trials& trials, const TuneTrial& trial, const std::string& name) {
  return std::ranges::all_of(trials.violated_limits(trial), [&](const auto& entry) {
    return entry.first == name || (name == kRules && trials.is_rule(entry.first));
  });
}

/// Returns a text that names limits to relax. Some trials violate a single limit: for each such limit, the text has the
/// relaxation that confirmed() finds for the trial with the smallest excess(). If confirmed() finds no relaxation of a
/// single limit, the text has the relaxation of all limits that the trial `nearest` violates. If confirmed() does not
/// find this relaxation either, the text states that no relaxation was found.
std::string relaxations(Trials& trials, const TuneTrial& nearest, const IsFeasible& is_feasible) {
  constexpr std::size_t kMaxCompleted = 8;  // maximum number of trials that are evaluated further for each limit
  const TuneLimits limits = trials.limits();
  // For each limit, find the trial with the smallest excess() that violates only this limit after a complete
  // evaluation. This must precede the calls of confirmed(), whose searches change the limits of `trials`.
  std::vector<std::pair<const TuneTrial*, MetricValues>> chosen;
  for (const auto& [name, found] : candidates(trials, kMaxCompleted)) {
    for (const TuneTrial* candidate : found) {
      const TuneTrial& trial = trials.evaluated(*candidate, Need::all);
      if (!trial.limits_alone || !violates_only(trials, trial, name)) continue;
      chosen.emplace_back(&trial, trials.violated_limits(trial));
      break;
    }
  }
  const TuneTrial& all = trials.evaluated(nearest, Need::all);
  const MetricValues of_nearest = all.limits_alone ? trials.violated_limits(all) : MetricValues();
  std::vector<std::string> texts;
  for (const auto& [trial, violated] : chosen)
    if (const auto text = confirmed(trials, limits, *trial, violated, is_feasible)) texts.push_back(*text);
  if (texts.empty() && !of_nearest.empty())
    if (const auto text = confirmed(trials, limits, all, of_nearest, is_feasible)) texts.push_back(*text);
  if (texts.empty()) return "no relaxation of these limits was found that a search confirms";
  return fmt::format("{}", fmt::join(texts, "; or "));
}

// ---- Trials whose motion fails

/// Returns the failure that tune reports if relaxing limits does not help. Variants are judged in the order of their
/// indices, and a trial keeps only the failure of its first failing variant. Among all trials, finds the highest index
/// of a failing variant, and returns the most frequent failure with this index. All variants with lower indices are
/// settled with the margin in these trials. Returns a trial with this failure; null if no trial failed.
const TuneTrial* binding_trial(const Trials& trials) {
  const auto key_of = [](const TuneFailure& f) {
    return std::tuple(f.variant_index, f.binding == "margin", f.variant, f.verdict);
  };
  std::map<std::tuple<std::size_t, bool, std::string, std::string>, std::pair<std::size_t, const TuneTrial*>> counts;
  for (const auto& [key, trial] : trials.all()) {
    if (!trial.failure) continue;
    auto& [count, example] = counts[key_of(*trial.failure)];
    ++count;
    if (example == nullptr || example->failure->unstable_at_K) example = &trial;
  }
  const TuneTrial* binding = nullptr;
  std::tuple<std::size_t, std::size_t> best{0, 0};  // variant, number of trials
  for (const auto& [key, counted] : counts) {
    const std::tuple rank{std::get<0>(key), counted.first};
    if (binding == nullptr || rank > best) {
      best = rank;
      binding = counted.second;
    }
  }
  return binding;
}

/// Returns the option or field to change after a failure, as a text for the user.
std::string remedy(const TuneQuestion& question, const TuneFailure& failure) {
  std::vector<std::string> others;
  for (const char* family : kFamilies)
    if (failure.family != family && std::ranges::count(question.families, family) > 0) others.emplace_back(family);
  if (others.empty()) others.emplace_back(failure.family == "seeds" ? "hands" : "seeds");
  const bool contact_fails = failure.verdict == "no_contact" || failure.verdict == "lost_contact" ||
                             failure.verdict == "not_dragged" || failure.verdict == "stuck" ||
                             failure.verdict == "went_through" || failure.verdict == "thrown_out";
  std::string text;
  if (!failure.family.empty())
    text = fmt::format("--family {} leaves out {}", fmt::join(others, ","),
                       failure.variant.empty() ? "these hands" : failure.variant);
  const bool margin_helps = failure.binding == "margin" && !contact_fails && !failure.unstable_at_K;
  if (margin_helps) text += std::string(text.empty() ? "" : "; ") + "a smaller --margin";
  if (!text.empty()) return text;
  if (failure.binding == "friction")
    return R"(rendering.friction {"type": "dry"}, a smaller rendering.friction.mu_f_s_per_m, or a shorter time step)";
  if (failure.binding == "no_force") return "check the device: its encoder, or its force resolution, hides the contact";
  if (contact_fails)
    return "no option of tune changes this: change the hand or the start of the scene (\"hapbench run\" explains the "
           "outcome)";
  return "no option of tune changes this: another device, hand or time step";
}

}  // namespace

void explain(Trials& trials, const IsFeasible& is_feasible, TunedLaw& law) {
  // Discard trials that violate limits in the run of the scene itself but also fail in another variant: relaxing a
  // limit would not make them feasible.
  constexpr std::size_t kMaxCompleted = 8;
  std::vector<const TuneTrial*> nearest = trials.nearest(kMaxCompleted);
  std::erase_if(nearest,
                [&](const TuneTrial* trial) { return trials.evaluated(*trial, Need::all).failure.has_value(); });
  if (!nearest.empty()) {
    const TuneTrial trial = *nearest[0];
    law.binding = trial.binding;
    law.why = trial.why;
    law.relax = relaxations(trials, trial, is_feasible);
    return;
  }
  // Relaxing limits does not help. Evaluate all trials that violate only limits so far, so that a failure in another
  // variant is found.
  for (const auto& [key, trial] : trials.all())
    if (trial.limits_alone) trials.evaluated(trial, Need::excess);
  if (const TuneTrial* trial = binding_trial(trials)) {
    law.binding = trial->failure->binding;
    law.why = fmt::format("{}, for example with K = {:.4g} N/m", trial->failure->why, trial->stiffness);
    law.relax = remedy(trials.question(), *trial->failure);
    return;
  }
  const TuneTrial& last = trials.all().rbegin()->second;
  law.binding = last.binding;
  law.why = last.why;
}

}  // namespace hapbench
