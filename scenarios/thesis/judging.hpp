#pragma once

#include <cstddef>
#include <limits>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "scenarios/thesis/evidence.hpp"
#include "scenarios/thesis/published_numbers.hpp"

/// A claim of the thesis, the numbers measured for it, and the verdict on it.
namespace hapbench {

/// The outcome of testing a claim. `consistent` and `not_consistent` are for experiments with people, which simulated
/// subjects cannot replicate. `holds` and `does_not_hold` are for findings of this project. The other values are for
/// all other claims.
enum class Verdict {
  replicated,
  qualitatively,
  not_replicated,
  contradicted,
  not_testable,
  consistent,
  not_consistent,
  not_judged,
  holds,
  does_not_hold
};

/// Name and description of a verdict.
struct VerdictText {
  std::string_view name;
  const char* meaning;
};
/// The texts of all verdicts, in the order of Verdict.
inline constexpr VerdictText kVerdicts[] = {
    {"replicated",
     "the claim's rule holds with the published numbers, in a program that was written from the text of the thesis "
     "alone and not by the author of the thesis (as in the ACM badge \"Results Replicated\", version 1.1)"},
    {"qualitatively replicated",
     "the direction or the mechanism is as published, but a published number is not reached, the effect is weaker, or "
     "it shows only under other conditions; the claim page has the details"},
    {"not replicated", "neither the numbers nor the direction are as published, in this model of device and hand"},
    {"contradicted", "a closed form or a counterexample contradicts the claim"},
    {"not testable",
     "no simulation can test the claim, because it is about people or about the hardware of the haptic device"},
    {"consistent in simulation",
     "with simulated subjects, the experiment gives the published result; this replicates no experiment with people"},
    {"not consistent in simulation", "with simulated subjects, the experiment does not give the published result"},
    {"not judged",
     "the run has nothing to measure (it has no contact, or it diverges), or the simulated hand does not reach the "
     "published number that it is fitted to"},
    {"holds", "a statement of this project that the measurement supports"},
    {"does not hold", "a statement of this project that the measurement does not support"}};
inline constexpr std::string_view verdict_name(Verdict verdict) {
  return kVerdicts[static_cast<std::size_t>(verdict)].name;
}

/// Returns `replicated` if its condition is true, otherwise `qualitatively` if the weaker condition is true, otherwise
/// `not_replicated`.
inline Verdict decide(bool replicated, bool qualitatively) {
  return replicated ? Verdict::replicated : qualitatively ? Verdict::qualitatively : Verdict::not_replicated;
}
/// Returns the verdict on an experiment with people.
inline Verdict in_simulation(bool consistent) {
  return consistent ? Verdict::consistent : Verdict::not_consistent;
}
/// Returns the verdict on a finding of this project.
inline Verdict found(bool holds) {
  return holds ? Verdict::holds : Verdict::does_not_hold;
}

/// Measured numbers by name. A name has several numbers if, for example, each subject has its own number.
using MeasuredValues = std::map<std::string, std::vector<double>>;

/// The measurements in one case of a claim, such as a density or an algorithm.
struct MeasuredCase {
  std::string name;  ///< empty if the claim has a single case
  MeasuredValues values;

  /// Returns the first of the numbers that are stored under the name `value`. Throws std::out_of_range if there is no
  /// such number.
  double operator[](const std::string& value) const { return all(value).at(0); }
  const std::vector<double>& all(const std::string& value) const { return values.at(value); }

  /// Sets the number `value` of a run that diverged: NaN, so that every comparison with it is false. Without NaN, a run
  /// that diverges at once would count as smooth and shallow. `until`: the number up to the divergence.
  void set_diverged(const std::string& value, double until) {
    values[value] = {std::numeric_limits<double>::quiet_NaN()};
    values[value + kUntilDivergence] = {until};
  }
  /// Returns the number `value`; of a run that diverged, the number up to the divergence. Earlier rules use it.
  double until_divergence(const std::string& value) const {
    return (*this)[values.contains(value + kUntilDivergence) ? value + kUntilDivergence : value];
  }

 private:
  static constexpr const char* kUntilDivergence = "_until_divergence";
};

/// All measured numbers that decide a claim. With the published numbers they suffice to judge the claim again.
using Measured = std::vector<MeasuredCase>;

/// The result of judging a claim, computed from measured numbers.
struct Finding {
  Verdict verdict = Verdict::not_testable;
  std::string why = {};                 ///< one sentence: the condition in the rule that led to the verdict
  std::string measured = {};            ///< the numbers as text; a judge leaves it empty if rules.json has the text
  std::string number = {};              ///< the number that decides, as a short text
  Measured cases = {};                  ///< the measured numbers
  std::optional<Verdict> earlier = {};  ///< verdict of the claim's earlier rule (Claim::earlier), if it has one
};

/// Thrown by a measurement whose run has nothing to measure, such as no contact. The claim is not judged then; what()
/// is the reason.
struct NothingToMeasure : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Measures a claim. Throws NothingToMeasure if the run has nothing to measure, InputError if a scenario cannot run.
using Measure = Measured (*)(const Evidence& evidence);
/// Decides the verdict on a claim from measured and published numbers.
using Judge = Finding (*)(const Measured& measured, const PublishedNumbers& published);

/// A rule that was changed after its verdict was known. Its verdict is computed like the verdict of the present rule,
/// so that the ledger has both, with the recorded assumptions and with other values of them.
struct EarlierRule {
  /// Decides the verdict; null if the claim has no earlier rule.
  Verdict (*judge)(const Measured& measured, const PublishedNumbers& published) = nullptr;
  Measure measure = nullptr;  ///< null if the earlier rule judges the numbers that Claim::measure measures
  std::string rule = {};      ///< text of the rule
  std::string reason = {};    ///< why the rule was changed
};

/// Appends an item to a list in text form.
inline void append_item(std::string& list, std::string_view item, std::string_view separator = "; ") {
  if (!list.empty()) list += separator;
  list += item;
}

/// An entry of rules.json, with the functions of its rule. Texts contain ids of published numbers, such as <T2.raw>,
/// which PublishedNumbers::fill replaces by the numbers. A threshold that this project chose is an
/// assumption that sets no scenario fields, such as rule.easily. The text of a rule names the threshold as
/// <rule.easily>. Assumptions::reach reads from this text that the threshold influences the claim.
struct Claim {
  std::string id = {};
  std::string location = {};   ///< section of the thesis
  std::string claim = {};      ///< statement of the claim, in our words
  std::string published = {};  ///< published numbers, as text
  std::string rule = {};       ///< rule of the verdict with its thresholds, as text
  std::string why = {};        ///< why no simulation can test the claim; empty if a simulation can test it
  /// Text about the measured numbers. In it, <rows> stands for the measured number "rows", and <40 N.depth> for the
  /// measured number "depth" of the case "40 N".
  std::string measured = {};
  std::string each = {};      ///< text that is appended to `measured` for each case; {} stands for the case's name
  Measure measure = nullptr;  ///< `measure` and `judge` are null if no simulation can test the claim
  Judge judge = nullptr;
  bool timing = false;  ///< true: the finding contains run times, which differ between runs
  bool ours = false;    ///< true: a finding of this project, not counted as a claim of the thesis
  bool costly = false;  ///< true: slow to measure, so sensitivity.hpp tries only the ends of the ranges of assumptions
  bool drawn = false;   ///< true: a figure plots the numbers of its cases, so the ledger stores them

  std::string number = {};           ///< short text with the measured number that decides; names as in `measured`
  std::string published_short = {};  ///< published number that is compared with `number`; empty: `published`

  EarlierRule earlier = {};
  bool added = false;  ///< true: the rule was committed before the claim was measured for the first time

  /// Returns the texts of the present and of the earlier rule. Assumptions::reach reads from them the thresholds that
  /// influence the claim.
  std::string rule_texts() const { return rule + "\n" + earlier.rule; }

  /// Judges the measured numbers and inserts them into the texts.
  Finding judged(const Measured& cases, const PublishedNumbers& numbers_of_thesis) const;
};

/// A claim, the verdict on it, and the inputs of the verdict.
struct JudgedClaim {
  Claim claim;
  Finding finding;
  std::vector<std::string> scenarios = {};  ///< names of the bundled scenarios used, sorted
  std::string reach = {};                   ///< Assumptions::reach(); empty if no assumption influences the claim
  double seconds = 0.0;                     ///< time to run its scenarios and to measure it [s]
};

/// Caches the measurements of claims, so that claims with the same function Claim::measure share one measurement. An
/// instance is valid for one assumption set.
class Measurements {
 public:
  /// Measures a claim and returns the verdict on it, and the verdict of its earlier rule. Calls evidence.used with the
  /// name of each scenario that the measurements need, also if a measurement was made for another claim before. If the
  /// run has nothing to measure, the verdict is `not_judged`. If the claim has no judge, the verdict is `not_testable`
  /// without a measurement. Throws InputError if a scenario cannot run.
  Finding finding(const Claim& claim, const Evidence& evidence);

 private:
  struct Made {
    Measured cases = {};
    std::string nothing = {};  ///< why the run has nothing to measure; empty if `cases` holds the numbers
    std::vector<std::string> scenarios = {};  ///< names of the scenarios that the measurement needs
  };
  /// Returns a measurement, and makes it if it is the first with this function.
  const Made& made(Measure measure, const Evidence& evidence);
  std::map<Measure, Made> made_;
};

}  // namespace hapbench
