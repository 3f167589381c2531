#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "scenarios/input/json_file.hpp"
#include "scenarios/program/layout.hpp"

namespace hapbench {

/// What `describe` answers for one meaning of a name.
struct Description {
  std::string text;  ///< empty for a schema, which is JSON however it is asked for
  Json json;
};
/// The meanings of a name, of which there is one, as one: their texts one after the other, their JSON as an array.
Description joined(const std::vector<Description>& meanings);

/// The text of a thing that is described by its JSON: name, unit and kind in its first line, below it what it is, and
/// its other members by their names; an array of objects is a list of such things.
std::string thing_text(const Json& thing, const Layout& layout, std::size_t indent = 0);

/// The description of a thing by its JSON.
Description thing_description(const Json& thing, const Layout& layout);

}  // namespace hapbench
