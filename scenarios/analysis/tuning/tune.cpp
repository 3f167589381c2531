#include "scenarios/analysis/tuning/tune.hpp"

#include <fmt/format.h>

#include <optional>
#include <utility>
#include <vector>

#include "scenarios/analysis/stability/interval_search.hpp"
#include "scenarios/analysis/tuning/explanation.hpp"
#include "scenarios/analysis/tuning/trials.hpp"
#include "scenarios/analysis/tuning/tune_search.hpp"
#include "scenarios/analysis/tuning/verification.hpp"

namespace hapbench {
namespace {

/// Evaluates the choice's setting at up to 17 stiffnesses from 1/30 to 30 times the choice's K, so that
/// TunedLaw::trials has these points for plots. Stiffnesses outside of the searched range are left out.
void evaluate_along_stiffness(Trials& trials, const TuneTrial& choice) {
  const Range around{choice.stiffness / 30.0, choice.stiffness * 30.0, true}, whole = trials.ranges().stiffness;
  std::vector<double> stiffnesses = scan_values({.range = around}, kScanIntervals);
  std::erase_if(stiffnesses, [&](double K) { return !(K > whole.from && K < whole.to / trials.question().margin); });
  trials.run_ahead(choice.setting, stiffnesses);
  for (const double K : stiffnesses) trials.evaluate_and_measure(choice.setting, K);
}

/// Searches with the current limits until a choice passes its verification. The choice is the stiffest feasible trial;
/// with `strictest`, it is the trial of TuneSearch::strictest(). Returns an empty choice if no feasible trial passes.
std::optional<TuneTrial> verified_choice(Trials& trials, const std::optional<LimitEnd>& strictest, TunedLaw& law) {
  constexpr int kMaxVerifications = 60;
  TuneSearch search(trials);
  for (int i = 0; i < kMaxVerifications; ++i) {
    trials.begin_purpose("search");
    const std::optional<TuneTrial> choice = strictest ? search.strictest(*strictest) : search.best();
    // A choice that fails its verification refutes trials of similar settings. If no choice is left, restrict every
    // refutation to the setting that failed, and repeat the search.
    if (!choice && trials.restrict_refutations()) continue;
    // The search may skip the run with the depth evaluated at every step (Refinement::depth). Check that the choice
    // also keeps its limits with all errors.
    if (choice && !trials.evaluated(*choice, Need::excess).feasible()) continue;
    trials.begin_purpose("verification");
    if (choice && !is_verified(trials, *choice, law)) {
      law.binding = trials.last_refuted()->binding;
      law.why = trials.last_refuted()->why;
      continue;
    }
    if (choice && !strictest) {
      law.binding = search.beyond().binding;
      law.why = search.beyond().why;
    }
    return choice;
  }
  return std::nullopt;
}

/// Explains why nothing is feasible. If the searches with other limits find a trial that keeps all original limits,
/// this trial becomes the choice.
void explain_or_find(Trials& trials, TunedLaw& law) {
  const TuneLimits limits = trials.limits();
  const auto search = [&](const TuneLimits& other, const std::optional<LimitEnd>& strictest) {
    TunedLaw unused;
    trials.begin_search(other);
    return verified_choice(trials, strictest, unused);
  };
  const bool was_exhausted = trials.is_exhausted();
  explain(trials, search, law);
  trials.set_aim("");
  trials.begin_search(limits);
  trials.recall_all();
  if (trials.stiffest_feasible() != nullptr) {
    TunedLaw found = law;
    found.choice = verified_choice(trials, {}, found);
    found.relax.clear();
    if (found.choice) {
      law = std::move(found);
      return;
    }
  }
  if (law.why.empty()) {
    law.binding = "settled";
    law.why = "every feasible setting that was found failed its verification";
  }
  law.verified = 0;
  law.limits = {};
  law.findings.clear();
  if (was_exhausted) {
    law.why =
        fmt::format("none was found in {} runs, the largest number of a search; nearest: {}", kMaxTuneRuns, law.why);
  }
}

}  // namespace

TunedLaw tuned_law(const TuneQuestion& question, const std::string& algorithm) {
  TunedLaw law;
  law.algorithm = algorithm;
  Trials trials(question, algorithm);
  law.choice = verified_choice(trials, {}, law);
  if (!law.choice) explain_or_find(trials, law);
  if (law.choice) {
    law.overrides = trials.trial_runs().overrides(law.choice->setting, law.choice->stiffness);
    trials.begin_purpose("margins");
    law.margins = margins_of(trials, *law.choice);
    evaluate_along_stiffness(trials, *law.choice);
    law.error = trials.with_errors(*law.choice).error;
  }
  for (const auto& [key, trial] : trials.all()) law.trials.push_back(trial);
  law.runs = trials.runs();
  return law;
}

}  // namespace hapbench
