#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "scenarios/input/json_file.hpp"
#include "scenarios/program/layout.hpp"

namespace hapbench {

/// The output of `describe` for one meaning of a name.
struct Description {
  std::string text;  ///< printed text; empty for a schema, which is always printed as JSON
  Json json;
};
/// Joins the meanings of a name: their texts in sequence, their JSON as an array. Returns a single meaning
/// unchanged. Precondition: there is at least one meaning.
Description joined(const std::vector<Description>& meanings);

/// Returns the text of an entry that is described by its JSON. The first line has the name, unit and kind. Then follow
/// the members that describe the entry in a sentence, without their keys, and the other members, each with its key. If
/// a member is an array of objects, each object is printed as an entry in the same form. `indent`: spaces in front of
/// each line.
std::string entry_text(const Json& item, const Layout& layout, std::size_t indent = 0);

/// Returns the entry's text and JSON as a description.
Description entry_description(const Json& item, const Layout& layout);

}  // namespace hapbench
