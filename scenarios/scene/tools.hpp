#pragma once

#include <memory>
#include <string>
#include <vector>

#include "scenarios/input/fields.hpp"
#include "scenarios/scene/named_files.hpp"
#include "scenarios/scene/scenario.hpp"
#include "sim/tool/cylinder.hpp"
#include "sim/tool/tool_shape.hpp"

/// Tools: their fields, and the shape that these say.
namespace hapbench {

/// The fields of `tool` with meaning, unit, range and default.
void describe(Fields& f, ToolFields& tool);

/// The types of tools, in the variant's order.
std::vector<std::string> tool_names();

/// The tool. `files` are those of the scenario. The grid of a mesh takes seconds to make; equal ones are shared
/// (SharedCache). Throws InputError when the named file cannot be used.
std::shared_ptr<const ToolShape> make_tool(const Scenario& scenario, const NamedFiles& files);
/// The tool, for callers that need a cylinder. Throws InputError when it is none.
Cylinder make_cylinder(const ToolFields& fields);

}  // namespace hapbench
