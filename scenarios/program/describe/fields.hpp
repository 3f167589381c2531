#pragma once

#include <string>

#include "scenarios/program/describe/index.hpp"
#include "scenarios/program/layout.hpp"
#include "scenarios/scene/scenario_schema.hpp"

/// The descriptions of the fields of scenario files.
namespace hapbench {

/// The field at that path, of the first type that has it where types choose the fields; null when there is none.
const FieldGuide* find_field(const std::string& path);

/// The field at that path, once for each group of types that share it.
Description describe_field(const std::string& path, const Layout& layout);
/// The field rendering.algorithm.
Description describe_algorithms(const Layout& layout);
/// A function of time.
Description describe_profile(const Layout& layout);
/// All fields of a scenario file.
Description describe_scenario_fields(const Layout& layout);
/// The types among which fields choose, those that are the same in several fields once.
void add_types(Index& index, const Layout& layout);

}  // namespace hapbench
