#pragma once

#include <memory>

#include "scenarios/scene/named_files.hpp"
#include "scenarios/scene/scenario.hpp"
#include "scenarios/scene/trials.hpp"
#include "sim/geometry/triangle_tree.hpp"
#include "sim/loop/simulation.hpp"

namespace hapbench {

/// The numbers of the run: steps, start, integrator, bounds.
SimulationConfig simulation_config(const Scenario& scenario);

/// All parts of the run. Precondition: `shell` is make_shell of this scenario. Throws InputError when a named
/// file cannot be used. With skips off (RenderingConfig), every step compares every point with the tool.
SimulationParts assemble(const Scenario& scenario, const NamedFiles& files, std::shared_ptr<const PointShell> shell,
                         Trial trial);
/// The only or first run, with a shell of its own. For a scenario that is built in code: it needs no CheckedScenario,
/// because its files are read here.
SimulationParts assemble(const Scenario& scenario);

/// The scenario's environment as triangles: those whose vertices our shell has, or those of its mesh file; without
/// triangles, the points of other environments. Throws InputError when the file cannot be used.
TriangleSoup environment_surface(const Scenario& scenario, const NamedFiles& files);

}  // namespace hapbench
