#pragma once

#include <filesystem>
#include <functional>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "scenarios/format/json_file.hpp"

/// The index of names that users meet: `list` shows those of some kinds, `describe` explains each, and refusals take
/// the nearest name from it. Every part is made of the table of its kind, so that a new entry there is known here.
namespace hapbench {

struct DescribedTable;

struct Description {
  std::string text;  ///< empty for a schema, which is JSON however it is asked for
  Json json;
};
/// Several meanings of a name as one: their texts one after the other, their JSON as an array. Precondition: there is
/// one.
Description joined(const std::vector<Description>& meanings);

/// A name with one of its meanings.
struct Named {
  std::string kind;  ///< such as "algorithm"; of a type the field that chooses it, such as "environment"
  std::string name;
  std::string summary;  ///< what a list says of it; empty for kinds that no list has
  std::function<Description()> describe;
  Json more = Json::object();  ///< what a list's JSON has besides: of a scenario its group, of a claim its verdict
};
using Index = std::vector<Named>;

/// What the program knows by itself, the meanings of a name in the order in which they are told: models, presets,
/// results, fields, sections, types, words, headings.
Index program_index();
/// Every table among the results of this program, and those that are only printed, without a file.
std::vector<DescribedTable> result_tables();
// Those of single commands, from the columns that these write and print.
std::vector<DescribedTable> claim_tables();
std::vector<DescribedTable> converge_tables();
std::vector<DescribedTable> league_tables();
std::vector<DescribedTable> limit_tables();
std::vector<DescribedTable> stress_tables();
std::vector<DescribedTable> sweep_tables();
std::vector<DescribedTable> tune_tables();

/// Lines of a title and a text, which begins in `column`; those without a text are left out.
std::string facts_text(std::initializer_list<std::pair<const char*, std::string>> facts, std::size_t column);

}  // namespace hapbench
