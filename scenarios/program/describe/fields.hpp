#pragma once

#include <string>

#include "scenarios/program/describe/index.hpp"
#include "scenarios/program/layout.hpp"
#include "scenarios/scene/scenario_schema.hpp"

/// The descriptions of the fields of scenario files.
namespace hapbench {

/// Returns the field at a dotted path; null if no field has this path. If several types of an object have the field,
/// returns the field of the first type.
const FieldGuide* find_field(const std::string& path);

/// Returns the unit of the numbers of a field, such as "N/m"; "1" for numbers without a unit and for other fields.
std::string field_unit(const std::string& path);

/// Describes the field at a dotted path, with one description for each group of types that share the field's
/// schema.
Description describe_field(const std::string& path, const Layout& layout);
/// Describes the field rendering.algorithm.
Description describe_algorithms(const Layout& layout);
/// Describes values that are functions of time (profiles).
Description describe_profile(const Layout& layout);
/// Describes all fields of a scenario file.
Description describe_scenario_fields(const Layout& layout);
/// Adds the types that fields choose from, such as the types of an environment. A type that several fields share with
/// the same schema is added once.
void add_types(Index& index, const Layout& layout);

}  // namespace hapbench
