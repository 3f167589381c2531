#include "scenarios/analysis/tuning/tune.hpp"

#include "scenarios/analysis/stability/interval_search.hpp"
#include "scenarios/analysis/tuning/explanation.hpp"
#include "scenarios/analysis/tuning/trials.hpp"
#include "scenarios/analysis/tuning/tune_search.hpp"
#include "scenarios/analysis/tuning/verification.hpp"

namespace hapbench {
namespace {

/// Evaluates the choice's setting at stiffnesses from 1/30 to 30 times the choice's K, for plots.
void evaluate_along_stiffness(Trials& trials, const TuneTrial& choice) {
  const Range around{choice.stiffness / 30.0, choice.stiffness * 30.0, true}, whole = trials.ranges().stiffness;
  for (int i = 0; i <= kScanIntervals; ++i) {
    const double K = around.value_at(static_cast<double>(i) / kScanIntervals);
    if (K > whole.from && K < whole.to / trials.question().margin) trials.evaluate_and_measure(choice.setting, K);
  }
}

}  // namespace

TunedLaw tuned_law(const TuneQuestion& question, const std::string& algorithm) {
  TunedLaw law;
  law.algorithm = algorithm;
  Trials trials(question, algorithm);
  TuneSearch search(trials);
  // Search and verify. A choice that fails its verification lowers cap() or a limit for the next search.
  do {
    law.choice = search.best();
  } while (law.choice && !is_verified(trials, *law.choice, law));
  if (law.choice) {
    law.binding = search.beyond().binding;
    law.why = search.beyond().why;
    law.margins = margins_of(trials, *law.choice);
    law.overrides = trials.overrides(law.choice->setting, law.choice->stiffness);
    evaluate_along_stiffness(trials, *law.choice);
  } else {
    explain(trials, law);
  }
  for (const auto& [key, trial] : trials.all()) law.trials.push_back(trial);
  law.runs = trials.runs();
  return law;
}

}  // namespace hapbench
