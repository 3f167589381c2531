#pragma once

#include <optional>
#include <string_view>

#include "scenarios/program/describe/index.hpp"
#include "scenarios/program/layout.hpp"

namespace hapbench {

/// Returns the terms of scenarios/GLOSSARY.md as entries of kind "term", in the order of the file. Throws
/// InputError if the file is missing.
Index glossary_index(const Layout& layout);

/// Returns the description of the term with this name in an index that contains glossary_index(); nullopt if no term
/// has this name. Ignores case, and treats "_" as a space. If an entry has several names, each of them is found:
/// "dry_friction" finds the entry "Coulomb friction, dry friction".
std::optional<Description> find_term(const Index& index, std::string_view name);

}  // namespace hapbench
