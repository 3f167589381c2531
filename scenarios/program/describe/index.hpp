#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "scenarios/input/writer.hpp"

/// The index of names that users meet. `describe` lists those of some kinds and explains each, and refusals take the
/// nearest name from it. Every part is made of the table of its kind, so that a new entry there is known here.
namespace hapbench {

struct DescribedTable;

struct Description {
  std::string text;  ///< empty for a schema, which is JSON however it is asked for
  Json json;
};
/// The meanings of a name, of which there is one, as one: their texts one after the other, their JSON as an array.
inline Description joined(const std::vector<Description>& meanings) {
  if (meanings.size() == 1) return meanings.front();
  Description all{"", Json::array()};
  for (const Description& meaning : meanings) {
    all.text += (all.text.empty() ? "" : "\n") + meaning.text;
    // A meaning that has several itself adds each.
    const Json list = meaning.json.is_array() ? meaning.json : Json::array({meaning.json});
    all.json.insert(all.json.end(), list.begin(), list.end());
  }
  return all;
}

/// The text of a thing that is described by its JSON: name, unit and kind in its first line, below it what it is, and
/// its other members by their names; an array of objects is a list of such things.
std::string thing_text(const Json& thing, std::size_t indent = 0);

/// A name with one of its meanings.
struct Named {
  std::string kind;  ///< such as "algorithm"; of a type the field that chooses it, such as "environment"
  std::string name;
  std::string summary;  ///< what a list says of it; may be empty for kinds that no list has
  std::function<Description()> describe;
  Json more = Json::object();  ///< what a list's JSON has besides: of a scenario its group, of a claim its verdict
};
using Index = std::vector<Named>;

/// Everything that `describe` can describe, in the order of its lists: from models and presets to words and headings.
Index program_index();
/// Every table among the results of this program, and those that are only printed, without a file.
std::vector<DescribedTable> result_tables();

}  // namespace hapbench
