#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "scenarios/program/describe/description.hpp"
#include "scenarios/program/layout.hpp"

/// The index of the names that users meet. `describe` lists some kinds of names and explains each name, and
/// error messages suggest the nearest name. The names of each kind are read from the table that defines them, so that
/// a new entry of the table appears here too.
namespace hapbench {

/// A name with one of its meanings.
struct IndexEntry {
  std::string kind;  ///< such as "algorithm"; for a type of a field: the field, such as "environment"
  std::string name;
  std::string summary;  ///< description in lists; may be empty for kinds without a list
  std::function<Description()> describe;
  Json more = Json::object();  ///< further members in a list's JSON: the group of a scenario, the verdict on a claim
};
/// Names with their meanings, in the order in which `describe` lists them.
using Index = std::vector<IndexEntry>;

/// Returns the names that are defined in the program itself, without the files installed beside it: from models
/// and presets to printed words and headings.
Index program_index(const Layout& layout);

}  // namespace hapbench
