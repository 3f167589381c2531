#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "sim/loop/simulation.hpp"

/// Names of outcomes in scenario files and result files.
namespace hapbench {

/// "completes", "leaves_hole", "tool_horizontal" or "diverges".
std::string_view outcome_name(Outcome outcome) noexcept;
/// Returns nothing if no outcome has that name.
std::optional<Outcome> outcome_named(std::string_view name) noexcept;
/// All names, in the order of the enumeration.
std::span<const std::string_view> outcome_names() noexcept;

}  // namespace hapbench
