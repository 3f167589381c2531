#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "sim/loop/simulation.hpp"

/// Outcomes in scenario files, result files and `describe`.
namespace hapbench {

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
