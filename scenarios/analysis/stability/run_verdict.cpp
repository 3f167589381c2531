#include "scenarios/analysis/stability/run_verdict.hpp"

#include "scenarios/run/outcome.hpp"

namespace hapbench {
namespace {

/// Returns the text of a verdict that is an outcome.
RunVerdictText of_outcome(Outcome outcome) {
  const OutcomeInfo& info = outcome_infos()[static_cast<std::size_t>(outcome)];
  return {info.name, info.meaning};
}

}  // namespace

std::span<const RunVerdictText> run_verdict_texts() noexcept {
  // In the order of RunVerdict.
  static const RunVerdictText kTexts[] = {
      {"stable", "at rest, died out or creeping", "all else: at rest, died out, creeping"},
      {"dying_out", "still oscillates, but comes to rest if the run goes on",
       "oscillates as much, but loses a tenth of its amplitude from the second quarter to the third and again to the "
       "last"},
      {"vibrating", "oscillates and does not decay",
       "does not decay: oscillates in the last quarter with at least 1 % of the first quarter's amplitude"},
      {"diverged", "left its bounds, or oscillates with a growing amplitude",
       "left its bounds, or oscillates with an amplitude that grows by 1 % from each quarter to the next"},
      {"thrown_out",
       "the tool left the hole, or ended without contact beyond the environment's box by more than it reaches"},
      {"no_contact", "the tool touched nothing in any row"},
      of_outcome(Outcome::lost_contact),
      of_outcome(Outcome::went_through),
      of_outcome(Outcome::not_dragged),
      of_outcome(Outcome::stuck),
      {"beyond_bound", "stable but for a metric that a --bound does not allow"}};
  return kTexts;
}

std::string_view run_verdict_name(RunVerdict verdict) noexcept {
  return run_verdict_texts()[static_cast<std::size_t>(verdict)].name;
}

bool is_stable(RunVerdict verdict) noexcept {
  return verdict == RunVerdict::stable || verdict == RunVerdict::dying_out;
}

}  // namespace hapbench
