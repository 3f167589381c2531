#pragma once

#include <memory>

#include "scenarios/scene/load_scenario.hpp"
#include "scenarios/scene/trials.hpp"
#include "sim/geometry/triangle_tree.hpp"
#include "sim/loop/simulation.hpp"

namespace hapbench {

/// The scenario with the files that it names read and parsed, so that faults in them are found before anything is
/// written: throws InputError. Its file_warnings tell of a mesh that is open or mended, and of a stroke at other times.
LoadedScenario checked(LoadedScenario loaded);

/// The numbers of the run: steps, start, integrator, bounds.
SimulationConfig simulation_config(const Scenario& scenario);

/// All parts of the run. Precondition: `shell` is make_shell of this scenario. Throws InputError when a named
/// file cannot be used. With skips off (RenderingConfig), every step compares every point with the tool.
SimulationParts assemble(const Scenario& scenario, const NamedFiles& files, std::shared_ptr<const PointShell> shell,
                         Trial trial);
/// The only or first run, with a shell of its own.
SimulationParts assemble(const Scenario& scenario);

/// The scenario's environment as triangles: those whose vertices our shell has, or those of its mesh file; without
/// triangles, the points of other environments. Throws InputError when the file cannot be used.
TriangleSoup environment_surface(const Scenario& scenario, const NamedFiles& files);

}  // namespace hapbench
