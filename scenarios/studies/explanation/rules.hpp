#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "scenarios/studies/explanation/run_files.hpp"

/// Rules that say what is wrong with a run and what to try, each from a number and a stated threshold.
namespace hapbench {

/// A rule: something is wrong where its number is larger than the threshold.
struct ExplainRule {
  const char* name;
  const char* number;  ///< what it is
  const char* unit;    ///< "1" for pure numbers
  double threshold;
  const char* says;     ///< what is wrong, {} for the number
  const char* attempt;  ///< what to try
  /// The number; none where the rule does not apply or the run did not record what it needs.
  std::optional<double> (*value)(const RunFiles& run);
  std::string (*more)(const RunFiles& run) = nullptr;  ///< further facts, behind what is wrong
};

/// In the order in which they are told: how the run ended, then why.
std::span<const ExplainRule> explain_rules();

struct Explanation {
  const ExplainRule* rule;
  double value;
  std::string says;
};

/// The rules that apply to the run, in their order; empty where nothing is wrong.
std::vector<Explanation> explained(const RunFiles& run);

}  // namespace hapbench
