#pragma once

#include <memory>
#include <string>
#include <vector>

#include "scenarios/input/fields.hpp"
#include "scenarios/scene/named_files.hpp"
#include "scenarios/scene/scenario.hpp"
#include "sim/tool/cylinder.hpp"
#include "sim/tool/tool_shape.hpp"

/// Tools: description of their fields, and construction of their shape.
namespace hapbench {

/// Describes the fields of `tool` with meaning, unit, range and default.
void describe(Fields& f, ToolFields& tool);

/// Returns the names of the tool types, in the order of the variant ToolFields.
std::vector<std::string> tool_names();

/// Returns the shape of the tool. `files` are the scenario's files. Computing the signed-distance grid of a mesh
/// tool takes seconds; tools with equal grids share it (SharedCache). Throws InputError if the tool's file cannot
/// be used.
std::shared_ptr<const ToolShape> make_tool(const Scenario& scenario, const NamedFiles& files);
/// Returns the tool as a cylinder. Throws InputError if the tool has another type.
Cylinder make_cylinder(const ToolFields& fields);

}  // namespace hapbench
