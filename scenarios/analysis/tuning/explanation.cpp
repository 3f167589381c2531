#include "scenarios/analysis/tuning/explanation.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <map>
#include <string>
#include <string_view>
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

/// Returns whether the handle did not come to the contact, or did not stay in it.
bool contact_fails(const TuneFailure& failure) {
  static constexpr std::array<std::string_view, 6> kVerdicts{"no_contact", "lost_contact", "not_dragged",
                                                             "stuck",      "went_through", "thrown_out"};
  return std::ranges::find(kVerdicts, failure.verdict) != kVerdicts.end();
}

/// Returns the families that `--family` can still name when it leaves out `family`.
std::vector<std::string> other_families(const TuneQuestion& question, const std::string& family) {
  std::vector<std::string> others;
  for (const char* other : kFamilies)
    if (family != other && std::ranges::count(question.families, other) > 0) others.emplace_back(other);
  if (others.empty()) others.emplace_back(family == "seeds" ? "hands" : "seeds");
  return others;
}

/// Returns what the option `--family` of the remedy leaves out, as a text for the user.
std::string left_out(const TuneFailure& failure) {
  if (failure.variant.empty()) return "these hands";
  return failure.variant == "no hand" ? "the loop without a hand" : failure.variant;
}

/// Returns the options of `tune` to change after a failure, as a text for the user. Empty if none helps.
std::string options_to_change(const TuneQuestion& question, const TuneFailure& failure) {
  std::vector<std::string> options;
  if (!failure.family.empty())
    options.push_back(fmt::format("--family {} leaves out {}", fmt::join(other_families(question, failure.family), ","),
                                  left_out(failure)));
  if (failure.binding == "margin" && !contact_fails(failure) && !failure.unstable_at_K)
    options.emplace_back("a smaller --margin");
  return fmt::format("{}", fmt::join(options, "; "));
}

/// Returns the option or field to change after a failure, as a text for the user.
std::string remedy(const TuneQuestion& question, const TuneFailure& failure) {
  if (std::string options = options_to_change(question, failure); !options.empty()) return options;
  if (failure.binding == "friction")
    return R"(rendering.friction {"type": "dry"}, a smaller rendering.friction.mu_f_s_per_m, or a shorter time step)";
  if (failure.binding == "no_force") return "check the device: its encoder, or its force resolution, hides the contact";
  if (contact_fails(failure))
    return "no option of tune changes this: change the hand or the start of the scene (\"hapbench run\" explains the "
           "outcome)";
  return "no option of tune changes this: another device, hand or time step";
}

/// Names the relaxations. Writes the limit that the choice of the first relaxation violates.
void explain_limits(Trials& trials, const TuneLimits& limits, const std::vector<Relaxation>& found, TunedLaw& law) {
  trials.begin_search(limits);
  const TuneTrial& nearest = trials.evaluated(found[0].choice, Need::all);
  // A choice that keeps all limits failed its verification: law.why has the reason of the last failure.
  if (!nearest.feasible()) {
    law.binding = nearest.binding;
    law.why = nearest.why;
  }
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
