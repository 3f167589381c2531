#pragma once

#include <memory>

#include "scenarios/description/load_scenario.hpp"
#include "sim/tool/cylinder.hpp"

namespace hapbench {

/// The tool of the scenario whose files these are. The grid of a mesh takes seconds to make: those made last are kept
/// for later runs and other threads. Throws InputError when the mesh cannot be used.
std::shared_ptr<const ToolShape> make_tool(const Scenario& scenario, const NamedFiles& files);
/// The same, reading the scenario's files.
std::shared_ptr<const ToolShape> make_tool(const Scenario& scenario);

/// The tool, for those who need to know that it is a cylinder. Throws InputError when it is none.
Cylinder make_cylinder(const ToolFields& fields);

}  // namespace hapbench
