#pragma once

#include <optional>
#include <string_view>

#include "scenarios/program/describe/index.hpp"
#include "scenarios/program/layout.hpp"

namespace hapbench {

/// Returns the terms of scenarios/GLOSSARY.md, one entry of kind "term" for each, in the order of the file. Throws
/// InputError if the file is missing.
Index glossary_index(const Layout& layout);

/// Returns the glossary's entry for a name, or none. Case is ignored, "_" equals a blank, and each name of an entry
/// with several names is found: "6-dof" finds the entry "3-DOF, 6-DOF".
std::optional<Description> find_term(std::string_view name, const Layout& layout);

}  // namespace hapbench
