#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "scenarios/program/describe/description.hpp"
#include "scenarios/program/layout.hpp"

/// The index of names that users meet. `describe` lists those of some kinds and explains each, and refusals take the
/// nearest name from it. Every part is made of the table of its kind, so that a new entry there is known here.
namespace hapbench {

/// A name with one of its meanings.
struct Named {
  std::string kind;  ///< such as "algorithm"; of a type the field that chooses it, such as "environment"
  std::string name;
  std::string summary;  ///< what a list says of it; may be empty for kinds that no list has
  std::function<Description()> describe;
  Json more = Json::object();  ///< what a list's JSON has besides: of a scenario its group, of a claim its verdict
};
/// Names with their meanings.
using Index = std::vector<Named>;

/// Everything that `describe` can describe without the folders beside the program, in the order of its lists: from
/// models and presets to words and headings.
Index program_index(const Layout& layout);

}  // namespace hapbench
