#include "scenarios/analysis/tuning/explanation.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace hapbench {
namespace {

/// Returns the failure that tune reports if relaxing limits does not help. Variants are judged in the order of their
/// indices, and a trial keeps only the failure of its first failing variant. Among all trials, finds the highest index
/// of a failing variant; of the failures with this index, a loop that is unstable only with another hand comes after
/// the scene's own run. Returns the most frequent of the failures that come last. All variants with lower indices are
/// settled with the margin in these trials. Returns a trial with this failure; null if no trial failed.
const TuneTrial* binding_trial(const Trials& trials) {
  const auto key_of = [](const TuneFailure& f) {
    return std::tuple(f.variant_index, !f.family.empty(), f.binding == "margin", f.variant, f.verdict);
  };
  using Key = std::tuple<std::size_t, bool, bool, std::string, std::string>;
  std::map<Key, std::pair<std::size_t, const TuneTrial*>> counts;
  for (const auto& [key, trial] : trials.all()) {
    if (!trial.failure) continue;
    auto& [count, example] = counts[key_of(*trial.failure)];
    ++count;
    if (example == nullptr || example->failure->unstable_at_K) example = &trial;
  }
  const TuneTrial* binding = nullptr;
  std::tuple<std::size_t, bool, std::size_t> best{0, false, 0};  // variant, with another hand, number of trials
  for (const auto& [key, counted] : counts) {
    const std::tuple rank{std::get<0>(key), std::get<1>(key), counted.first};
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
                       failure.variant.empty()        ? "these hands"
                       : failure.variant == "no hand" ? "the loop without a hand"
                                                      : failure.variant);
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

/// Names the relaxations. Writes the limit that the choice of the first relaxation violates.
void explain_limits(Trials& trials, const TuneLimits& limits, const std::vector<Relaxation>& found, TunedLaw& law) {
  trials.begin_search(limits);
  const TuneTrial& nearest = trials.evaluated(found[0].choice, Need::all);
  law.binding = nearest.binding;
  law.why = nearest.why;
  std::vector<std::string> texts;
  for (const Relaxation& relaxation : found) texts.push_back(relaxation.text);
  law.relax = fmt::format("{}", fmt::join(texts, "; or "));
}

}  // namespace

void explain(Trials& trials, const VerifiedSearch& search, TunedLaw& law) {
  const TuneLimits limits = trials.limits();
  const std::vector<Relaxation> found = relaxations(trials, limits, search);
  if (!found.empty()) return explain_limits(trials, limits, found, law);
  if (const TuneTrial* nearest = nearest_to_limits(trials, limits)) {
    law.binding = nearest->binding;
    law.why = nearest->why;
    law.relax = "no relaxation of these limits was found that a search confirms";
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
