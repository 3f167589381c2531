#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "scenarios/thesis/evidence.hpp"
#include "scenarios/thesis/published_numbers.hpp"

/// A claim of the thesis, the numbers measured for it, and the verdict on it.
namespace hapbench {

/// The outcome of testing a claim. `holds` and `does_not_hold` are for findings of this project; the other verdicts are
/// for claims of the thesis.
enum class Verdict { reproduced, in_kind, not_reproduced, refuted, not_reproducible, holds, does_not_hold };

/// Name and description of a verdict.
struct VerdictText {
  std::string_view name;
  const char* meaning;
  const char* mark;  ///< symbol in the bars of claims.md
};
/// The texts of all verdicts, in the order of Verdict.
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

/// Returns `reproduced` if its condition is true, otherwise `in_kind` if the weaker condition is true, otherwise
/// `not_reproduced`.
inline Verdict decide(bool reproduced, bool in_kind) {
  return reproduced ? Verdict::reproduced : in_kind ? Verdict::in_kind : Verdict::not_reproduced;
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

  /// Returns the first number of a name. Throws std::out_of_range if there is none.
  double operator[](const std::string& value) const { return all(value).at(0); }
  const std::vector<double>& all(const std::string& value) const { return values.at(value); }
};

/// All measured numbers that decide a claim. With the published numbers they suffice to judge the claim again.
using Measured = std::vector<MeasuredCase>;

/// The result of judging a claim, computed from measured numbers.
struct Finding {
  Verdict verdict = Verdict::not_reproducible;
  std::string why = {};       ///< one sentence that names the condition of the rule that decided
  std::string measured = {};  ///< the numbers as text; a judge leaves it empty if rules.json has the text
  std::string brief = {};     ///< the number that decides, as text; only for main results
  Measured cases = {};        ///< the measured numbers
};

/// Measures a claim.
using Measure = Measured (*)(const Evidence& evidence);
/// Decides the verdict on a claim from measured and published numbers.
using Judge = Finding (*)(const Measured& measured, const PublishedNumbers& published);

/// Appends an item to a list in text form.
inline void append_item(std::string& list, std::string_view item, std::string_view separator = "; ") {
  if (!list.empty()) list += separator;
  list += item;
}

/// An entry of rules.json, with the functions of its rule. Texts contain ids of published numbers, such as <T2.raw>,
/// which PublishedNumbers::fill replaces by the numbers. A threshold of this project is a choice without fields, such
/// as rule.easily. The rule's text names it as <rule.easily>, from which Choices::reach finds that it influences the
/// claim.
struct Claim {
  std::string id = {};
  std::string place = {};      ///< section of the thesis
  std::string claim = {};      ///< statement of the claim, in our words
  std::string published = {};  ///< published numbers, as text
  std::string rule = {};       ///< rule of the verdict with its thresholds, as text
  std::string why = {};        ///< why no simulation can test the claim; empty if a simulation can
  std::string measured = {};   ///< text with names of measured numbers, such as <rows>, or <40 N.depth> for the number
                               ///< "depth" of the case "40 N"
  std::string each = {};       ///< text that is appended to `measured` for each case; {} stands for the case's name
  Measure measure = nullptr;   ///< `measure` and `judge` are null if no simulation can test the claim
  Judge judge = nullptr;
  bool timing = false;  ///< true: the finding contains run times, which differ between runs
  bool ours = false;    ///< true: a finding of this project, not counted as a claim of the thesis
  bool costly = false;  ///< true: slow to measure, so it is judged for a quarter of the readings only (robustness.hpp)
  bool drawn = false;   ///< true: a figure plots the numbers of its cases, so the ledger stores them

  /// Short texts of a main result: the claim, the published numbers and the measured numbers. Empty for other claims.
  struct Main {
    std::string claim = {}, published = {}, ours = {};
  } main = {};

  /// Measures the claim and returns the verdict on it. Throws InputError.
  Finding finding(const Evidence& evidence) const;
};

/// A claim, the verdict on it, and the inputs of the verdict.
struct JudgedClaim {
  Claim claim;
  Finding finding;
  std::vector<std::string> scenarios = {};  ///< names of the bundled scenarios used, sorted
  std::string reach = {};                   ///< Choices::reach(); empty if no choice influences the claim
  double seconds = 0.0;                     ///< time to run its scenarios and to measure it [s]

  /// Returns true if other values of the choices can change the verdict.
  bool can_be_sampled() const {
    return !claim.timing && finding.verdict != Verdict::not_reproducible && !reach.empty();
  }
};

}  // namespace hapbench
