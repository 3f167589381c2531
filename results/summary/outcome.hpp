#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "sim/loop/simulation.hpp"

namespace hapbench {

/// Outcomes of a run, ordered from best to worst. A run of several trials has the outcome of its worst trial. If
/// stepping ends early, the simulation reports the reason. If all steps were executed, scenarios/run/outcome.hpp
/// decides the outcome from the observed steps.
enum class Outcome {
  completes,        ///< all steps were executed, or the hand has finished its task
  leaves_hole,      ///< stopped by a StopRule: the tip centre left the hole
  tool_horizontal,  ///< stopped by a StopRule: the tool's axis became horizontal
  not_dragged,      ///< all steps were executed, but a dragging hand did not move the tool
  stuck,            ///< all steps were executed, but a dragged tool stopped moving
  no_contact,       ///< all steps were executed, but the tool never touched the environment
  lost_contact,     ///< all steps were executed, but the tool left the environment
  went_through,     ///< all steps were executed, but the tool passed through the surface
  diverges          ///< a value was not finite or exceeded its bound
};

/// Returns the outcome that follows from the reason why stepping ended. Does not evaluate the observed steps.
Outcome outcome_of(Ending ending) noexcept;

/// Name and description of an outcome.
struct OutcomeInfo {
  std::string_view name;    ///< name in files, such as "completes"
  const char* meaning;      ///< one or more sentences, without the last full stop
  bool is_failure = false;  ///< true if the metrics of a run with this outcome do not characterise the algorithm
  /// Condition under which the commands `compare` and `sweep` end a run with this outcome before its last step; null if
  /// these commands never end a run with this outcome early.
  const char* ends_early = nullptr;
};

/// Returns all outcomes, in the order of the enumeration.
std::span<const OutcomeInfo> outcome_infos() noexcept;
std::string_view outcome_name(Outcome outcome) noexcept;
/// Returns the outcome with this name; nothing if no outcome has this name.
std::optional<Outcome> outcome_named(std::string_view name) noexcept;

}  // namespace hapbench
