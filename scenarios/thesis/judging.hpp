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

/// The outcome of testing a published statement; the last two are those of findings of ours.
enum class Verdict { reproduced, in_kind, not_reproduced, refuted, not_reproducible, holds, does_not_hold };

struct VerdictText {
  std::string_view name;
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

  /// The first value of a name. Throws std::out_of_range for one without.
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

using Measure = Measured (*)(const Evidence& evidence);
using Judge = Finding (*)(const Measured& measured, const PublishedNumbers& published);

/// Appends an item to an enumeration in words.
inline void append_item(std::string& list, std::string_view item, std::string_view separator = "; ") {
  if (!list.empty()) list += separator;
  list += item;
}

/// A row of rules.json with its rule. Texts hold published numbers by id, which PublishedNumbers::fill puts in. A
/// threshold of ours is a choice on record without fields, such as rule.easily; the rule's text names it in the same
/// way, which also tells that the choice reaches the claim.
struct Claim {
  std::string id = {};
  std::string place = {};      ///< in the thesis
  std::string claim = {};      ///< in our words
  std::string published = {};  ///< its numbers, for people
  std::string rule = {};       ///< of the verdict, for people, with its thresholds
  std::string why = {};        ///< why no simulation can show it; empty where one can
  std::string measured = {};   ///< for people, with measured numbers, as <rows> or <40 N.depth> of a case
  std::string each = {};       ///< the same of each case, for whose name {} stands; after `measured`
  Measure measure = nullptr;   ///< null, as `judge`, for a claim that no simulation can show
  Judge judge = nullptr;
  bool timing = false;  ///< the finding holds times, so no two runs agree
  bool ours = false;    ///< found on the way: no claim of the thesis, and not counted among those
  bool costly = false;  ///< takes long to measure: judged again for a part of a sample only (choices.hpp)
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

  /// Whether another reading of the choices could change the verdict.
  bool can_be_sampled() const {
    return !claim.timing && finding.verdict != Verdict::not_reproducible && !reach.empty();
  }
};

}  // namespace hapbench
