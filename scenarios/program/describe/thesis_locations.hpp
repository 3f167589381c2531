#pragma once

#include <optional>
#include <string>

#include "scenarios/program/describe/description.hpp"
#include "scenarios/program/layout.hpp"

/// Lookup of the thesis by figure, table and section.
namespace hapbench {

/// Returns a description of a location of the thesis: its contents, its pictures, and the bundled scenarios and claims
/// whose source names the location or a part of it. `name` is, for example, "A.2", "Fig. A.2", "Table A.1" or
/// "section 3.4"; 3.4.1 is a part of section 3.4, and Fig. 2c a part of Fig. 2. Returns empty if `name` has no such
/// form. Throws InputError if nothing is known about the location.
std::optional<Description> describe_thesis_location(const std::string& name, const Layout& layout);

}  // namespace hapbench
