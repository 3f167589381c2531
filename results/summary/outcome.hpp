#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "sim/loop/simulation.hpp"

namespace hapbench {

/// Outcomes of a run, ordered from best to worst. Several trials have the outcome of the worst trial. The engine
/// reports why stepping ended early; after all steps, scenarios/run/outcome.hpp judges the outcome from the rows.
enum class Outcome {
  completes,        ///< all steps done, or the hand has finished its task
  leaves_hole,      ///< by a StopRule
  tool_horizontal,  ///< by a StopRule
  not_dragged,      ///< all steps done, but a dragging hand did not move the tool
  stuck,            ///< all steps done, but a dragged tool came to stand
  no_contact,       ///< all steps done, but the tool never touched the environment
  lost_contact,     ///< all steps done, but the tool left the environment
  went_through,     ///< all steps done, but the tool passed the surface
  diverges          ///< a value was not finite or left its bound
};

/// The outcome of a run that nothing else is known of than how its stepping ended.
Outcome outcome_of(Ending ending) noexcept;

/// An outcome in words.
struct OutcomeInfo {
  std::string_view name;    ///< in files, as "completes"
  const char* meaning;      ///< in a sentence without its full stop
  bool is_failure = false;  ///< the numbers of such a run say nothing about the algorithm
};

/// All outcomes, in the order of the enumeration.
std::span<const OutcomeInfo> outcome_infos() noexcept;
std::string_view outcome_name(Outcome outcome) noexcept;
/// Returns nothing if no outcome has that name.
std::optional<Outcome> outcome_named(std::string_view name) noexcept;

}  // namespace hapbench
