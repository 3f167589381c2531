#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "scenarios/cases/cases.hpp"
#include "scenarios/run/run_scenario.hpp"

/// The claims of the thesis, and how each is judged. results/reference/rules.json has their texts, the file of their
/// chapter what is measured and the rule, results/reference/published.json the published numbers.
namespace hapbench {

// ---- Published numbers, and what claims are measured by

/// One number of results/reference/published.json. Parts that are not published have these values.
struct PublishedNumber {
  double mean = std::numeric_limits<double>::quiet_NaN();
  double spread = 0.0;  ///< standard deviation or standard error, whichever is published
  double at_least = -std::numeric_limits<double>::infinity();
  double at_most = std::numeric_limits<double>::infinity();
};

/// The published numbers by id.
class PublishedNumbers {
 public:
  /// None.
  PublishedNumbers() = default;
  /// Reads the file. Throws InputError.
  explicit PublishedNumbers(const std::filesystem::path& file);
  /// Throws InputError for an id that is not there.
  const PublishedNumber& operator[](const std::string& id) const;
  /// The text with the numbers that it names by id: <T2.raw> becomes "37.8 ± 17.7", <T3.reduced.bound.at_most> "15".
  /// A part (mean, spread, at_least or at_most) may have a factor and a format, as <J1.depth.mean*1000:.2f>; without a
  /// format it is written as `plain` writes it (claims.hpp); no number is "none". Throws InputError for an id that is
  /// not there.
  std::string fill(const std::string& text) const;
  /// Adds a number of ours that rules read as they read published ones: a threshold (choices.hpp).
  void set(const std::string& id, double value) { numbers_[id].mean = value; }

 private:
  std::map<std::string, PublishedNumber> numbers_;
};

/// The sources of the measurements by which claims are judged.
struct Evidence {
  PublishedNumbers published;
  std::filesystem::path directory;  ///< of results, those of a scenario in a subdirectory of its name
  /// Called with the scenario's name before results are read: runs it, if scenarios are run on demand.
  std::function<void(const std::string& scenario)> provide;
  /// Returns the overrides of a bundled scenario, as for load_scenario; empty for none.
  std::function<std::vector<std::string>(const Scenario&)> overrides = {};
  /// Called with the name of every bundled scenario that a claim loads by itself; may be empty.
  std::function<void(const std::string& scenario)> used = {};

  // Results of a scenario. Both throw InputError when the file is missing or none of ours.

  /// A number of summary.json, as in "metrics.force_max_N"; NaN for null.
  double number(const std::string& scenario, const std::string& path) const;
  /// Columns of a CSV file, by name; a cell without a number is NaN.
  std::map<std::string, std::vector<double>> table(const std::string& scenario, const std::string& file) const;

  // Claims that compute something by themselves start from these functions. Both throw InputError.

  /// A bundled scenario with `overrides`, and then with `more` overrides: a single case.
  Cases scene(const std::string& name, const std::vector<std::string>& more = {}) const;
  /// Loads it.
  LoadedScenario load(const std::string& name, const std::vector<std::string>& more = {}) const {
    return scene(name, more).load(0);
  }
  /// Runs it in memory.
  Result run(const std::string& name, const std::vector<std::string>& more = {}) const {
    return run_scenario(load(name, more), std::nullopt, false);
  }
};

/// Runs a scenario in memory and calls `row` for each row, which has the contacts as they were found. Throws
/// InputError.
void for_each_row(const LoadedScenario& loaded, const std::function<void(const StepRecord&)>& row);

// ---- Claims and verdicts

/// The outcome of testing a published statement; the last two are those of findings of ours.
enum class Verdict { reproduced, in_kind, not_reproduced, refuted, not_reproducible, holds, does_not_hold };

/// A verdict in words.
struct VerdictText {
  std::string_view name;  ///< also in the ledger
  const char* meaning;
  const char* mark;  ///< in bars
};
/// In the order of the enumeration.
inline constexpr VerdictText kVerdicts[] = {
    {"reproduced",
     "another implementation, by other authors and from the text alone, meets the claim's rule with the published "
     "numbers (ACM calls that replicated)",
     "✓"},
    {"reproduced in kind", "direction or mechanism are the published ones, the numbers are not", "≈"},
    {"not reproduced", "neither, in this model of the device and the hand", "✗"},
    {"refuted", "it contradicts an exact result", "⊘"},
    {"not reproducible", "no simulation can show it: people or the trainer are needed", "–"},
    {"holds", "a finding of ours that the measurement shows", "✓"},
    {"does not hold", "a finding of ours that the measurement does not show", "✗"}};
inline constexpr std::string_view verdict_name(Verdict verdict) {
  return kVerdicts[static_cast<std::size_t>(verdict)].name;
}

/// The verdict of a rule for "reproduced" and a weaker one for "reproduced in kind".
inline Verdict decide(bool reproduced, bool in_kind) {
  return reproduced ? Verdict::reproduced : in_kind ? Verdict::in_kind : Verdict::not_reproduced;
}
/// The verdict on a finding of ours.
inline Verdict found(bool holds) {
  return holds ? Verdict::holds : Verdict::does_not_hold;
}

/// Numbers by name, several under one name where each subject has its own.
using MeasuredValues = std::map<std::string, std::vector<double>>;

/// The measurements in one case of a claim, such as a density or an algorithm.
struct MeasuredCase {
  std::string name;  ///< empty where the claim has a single case
  MeasuredValues values;

  /// The value of a name that has one. Throws std::out_of_range for other names.
  double operator[](const std::string& value) const { return all(value).at(0); }
  const std::vector<double>& all(const std::string& value) const { return values.at(value); }
};

/// All numbers that decide a claim beside the published ones, so that it can be judged again at any time.
using Measured = std::vector<MeasuredCase>;

/// The result of judging a claim, computed from measured numbers.
struct Finding {
  Verdict verdict = Verdict::not_reproducible;
  std::string why = {};       ///< one sentence: which part of the rule decided
  std::string measured = {};  ///< the numbers, for people; empty where rules.json has their text
  std::string brief = {};     ///< the deciding number, of a main result
  Measured cases = {};        ///< what was judged
};

/// Takes the deciding numbers from the results of scenarios, or computes them.
using Measure = Measured (*)(const Evidence& evidence);
/// Depends on its arguments alone.
using Judge = Finding (*)(const Measured& measured, const PublishedNumbers& published);

/// Appends an item to an enumeration in words.
inline void append_item(std::string& list, std::string_view item, std::string_view separator = "; ") {
  if (!list.empty()) list += separator;
  list += item;
}

/// A number as the rules of claims write it, with six digits at most: "0.1", "15", "1e-9".
std::string plain(double number);

/// A row of results/reference/rules.json with its rule. Texts hold published numbers by id, which
/// PublishedNumbers::fill puts in. A threshold of ours that `measure` or `judge` compares with is a choice on record
/// without fields, such as rule.easily; the rule's text names it in the same way, which also tells that the choice
/// reaches the claim.
struct Claim {
  std::string id = {};
  std::string place = {};      ///< in the thesis
  std::string claim = {};      ///< in our words
  std::string published = {};  ///< its numbers, for people
  std::string rule = {};       ///< of the verdict, for people: with the thresholds that `judge` compares with
  std::string why = {};        ///< why no simulation can show it; empty where one can
  std::string measured = {};   ///< for people, with measured numbers, as <rows> or <40 N.depth> of a case
  std::string each = {};       ///< the same of each case, for whose name {} stands; after `measured`
  Measure measure = nullptr;   ///< null, as `judge`, for a claim that no simulation can show
  Judge judge = nullptr;
  bool timing = false;  ///< the finding holds times, so no two runs agree
  bool ours = false;    ///< found on the way: no claim of the thesis, and not counted among those
  bool costly = false;  ///< takes long to measure: judged again for a part of a sample only (robustness.hpp)
  bool drawn = false;   ///< a figure draws the numbers of its cases, which the ledger then holds

  /// A main result in a few words: claim, published and, with measured numbers, ours. Empty for other claims.
  struct Main {
    std::string claim = {}, published = {}, ours = {};
  } main = {};

  /// Measures and judges it. Throws InputError.
  Finding finding(const Evidence& evidence) const;
};

/// A claim with the verdict on it.
struct JudgedClaim {
  Claim claim;
  Finding finding;
  std::vector<std::string> scenarios = {};  ///< bundled ones that it was measured with, in the order of their names
  std::string reach = {};                   ///< of the choices, as Choices::reach has it; empty: none reaches it
  double seconds = 0.0;                     ///< to run its scenarios and to measure it

  /// Whether another reading of the choices could change the verdict: a simulation shows it, and a choice reaches it.
  bool can_be_sampled() const {
    return !claim.timing && finding.verdict != Verdict::not_reproducible && !reach.empty();
  }
};

/// All of them, in the order of the ledger. Throws InputError for a file without what a claim needs.
std::vector<Claim> all_claims();

/// A threshold of ours: the choice rule.NAME.
inline double threshold(const PublishedNumbers& numbers, const std::string& name) {
  return numbers["rule." + name].mean;
}

/// The algorithm that the thesis proposes.
inline constexpr const char* kProposedLaw = "shaped_stiffness";

/// How a claim of rules.json is measured and judged. A constant that is no choice stands in the claim's text, too.
struct ClaimRule {
  const char* id = nullptr;
  Measure measure = nullptr;
  Judge judge = nullptr;
};

/// The rule of a claim with a single case.
template <MeasuredValues (*measure)(const Evidence&), Finding (*judge)(const MeasuredCase&, const PublishedNumbers&)>
ClaimRule single_case(const char* id) {
  return {id,
          [](const Evidence& e) -> Measured {
            return {{"", measure(e)}};
          },
          [](const Measured& measured, const PublishedNumbers& p) { return judge(measured.at(0), p); }};
}

// By chapter.
std::vector<ClaimRule> chapter_1_penetration();       ///< V, S1, B1b, B5
std::vector<ClaimRule> chapter_3_tasks();             ///< T1 to T3, T2b, J, C5
std::vector<ClaimRule> chapter_3_cost();              ///< T4, T5, P2, F3
std::vector<ClaimRule> chapter_3_stiffness_ratios();  ///< R
std::vector<ClaimRule> chapter_3_force_limit();       ///< L
std::vector<ClaimRule> chapter_4();                   ///< G, B4, C1 to C3, C7, C8
std::vector<ClaimRule> appendix_a();                  ///< A
std::vector<ClaimRule> appendix_b_c_f();              ///< B1 to B3, P1, C6, F1, F2
std::vector<ClaimRule> appendix_d_experiments();      ///< D

}  // namespace hapbench
