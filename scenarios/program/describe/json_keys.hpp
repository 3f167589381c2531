#pragma once

#include "scenarios/program/describe/index.hpp"
#include "scenarios/program/layout.hpp"

/// The keys of the JSON files of a run that have no meaning as a metric, a column of a table or a printed word.
namespace hapbench {

/// Adds these keys, each with its file and its unit.
void add_json_keys(Index& index, const Layout& layout);

}  // namespace hapbench
