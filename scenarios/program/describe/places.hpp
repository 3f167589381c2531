#pragma once

#include <optional>
#include <string>

#include "scenarios/program/describe/description.hpp"
#include "scenarios/program/layout.hpp"

/// The places of the thesis: figures, tables and sections.
namespace hapbench {

/// The bundled scenarios and claims that name a place, as "A.2", "Fig. A.2", "Table A.1" or "section 3.4", or a part of
/// it, as 3.4.1 or Fig. 2c. None when the name is no place's. Throws InputError for a place that nothing names.
std::optional<Description> describe_place(const std::string& name, const Layout& layout);

}  // namespace hapbench
