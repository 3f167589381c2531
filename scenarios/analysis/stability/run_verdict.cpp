#include "scenarios/analysis/stability/run_verdict.hpp"

#include "scenarios/run/outcome.hpp"

namespace hapbench {
namespace {

/// Returns the text of a verdict that has the name and meaning of an outcome.
RunVerdictText of_outcome(Outcome outcome) {
  const OutcomeInfo& info = outcome_infos()[static_cast<std::size_t>(outcome)];
  return {info.name, info.meaning};
}

}  // namespace

std::span<const RunVerdictText> run_verdict_texts() noexcept {
  // In the order of RunVerdict.
  static const RunVerdictText kTexts[] = {
      {"stable", "at rest, decayed to rest, or creeping slowly",
       "none of the other classes: at rest, decayed to rest, or creeping slowly"},
      {"decaying", "still oscillates at the end, but comes to rest if the run goes on",
       "oscillates like \"vibrating\", but the amplitude falls by more than a tenth from the second quarter to the "
       "third, and again from the third to the last"},
      {"vibrating", "oscillates without decay, or with a slow decay",
       "oscillates, and the amplitude does not fall as in \"dying_out\": the oscillation lasts, or decays by less than "
       "a tenth in a quarter of the run; a longer run may then be stable"},
      {"diverged", "left its bounds, or oscillates with growing amplitude",
       "left its bounds, or oscillates with an amplitude that grows by more than 1 % from each quarter to the next"},
      {"thrown_out",
       "the tool left the hole, or ended without contact, further outside the environment's bounding box than the "
       "tool's extent"},
      {"no_contact", "the tool never touched the environment"},
      of_outcome(Outcome::lost_contact),
      of_outcome(Outcome::went_through),
      of_outcome(Outcome::not_dragged),
      of_outcome(Outcome::stuck),
      {"beyond_bound", "stable, but a metric violates a --bound"}};
  return kTexts;
}

std::string_view run_verdict_name(RunVerdict verdict) noexcept {
  return run_verdict_texts()[static_cast<std::size_t>(verdict)].name;
}

bool is_stable(RunVerdict verdict) noexcept {
  return verdict == RunVerdict::stable || verdict == RunVerdict::dying_out;
}

}  // namespace hapbench
