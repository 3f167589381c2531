#pragma once

#include <string>
#include <string_view>

namespace hapbench {

/// What a run says of a published statement.
enum class Verdict {
  reproduced,       ///< the rule of the claim holds with its published numbers
  in_kind,          ///< the direction or the mechanism is the published one, the numbers are not
  not_reproduced,   ///< neither, in this model of the device and the hand
  refuted,          ///< it contradicts an exact result
  not_reproducible  ///< no simulation can show it
};

std::string_view verdict_name(Verdict verdict);

/// The verdict of a rule for what is reproduced and a weaker one for what is so in kind.
Verdict decide(bool reproduced, bool in_kind);

/// A rule's answer: computed from measured numbers, never written by hand.
struct Finding {
  Verdict verdict = Verdict::not_reproducible;
  std::string measured;  ///< the numbers, for people
  std::string why;       ///< one sentence: which part of the rule decided
};

/// A published mean with its spread.
struct Published {
  double mean = 0.0;
  double spread = 0.0;  ///< standard deviation or standard error, as published
};

}  // namespace hapbench
