#pragma once

#include <memory>

#include "scenarios/scene/named_files.hpp"
#include "scenarios/scene/scenario.hpp"
#include "scenarios/scene/trials.hpp"
#include "sim/geometry/triangle_tree.hpp"
#include "sim/loop/simulation.hpp"

namespace hapbench {

/// Returns the numeric settings of the run: step, number of steps, initial state, integrator, and the bounds at
/// which a run counts as diverged.
SimulationConfig simulation_config(const Scenario& scenario);

/// Builds the tool, contact source, force law, hand, motion and device of one trial. Preconditions: the
/// scenario is checked, and `shell` is make_shell() of this scenario. Throws InputError if a named file cannot
/// be used. With Skips::off (RenderingConfig), every step compares every point with the tool.
SimulationParts assemble(const Scenario& scenario, const NamedFiles& files, std::shared_ptr<const PointShell> shell,
                         Trial trial);
/// Builds only the parts that compute a force from a pose: tool, contact source and force law. Hand, motion and device
/// stay null. Otherwise like assemble().
SimulationParts assemble_rendering(const Scenario& scenario, const NamedFiles& files,
                                   std::shared_ptr<const PointShell> shell, Trial trial = {});
/// Builds the parts of the first trial and its point shell. For scenarios that are built in code: this overload
/// reads the scenario's files itself, and so needs no CheckedScenario.
SimulationParts assemble(const Scenario& scenario);

/// Returns the surface of the environment. For a mesh, returns the triangles of the mesh file. For a block, returns the
/// triangles whose vertices are the points of the point shell. For every other environment, returns only the points of
/// the point shell, as vertices. Throws InputError if the environment has a file that cannot be used.
TriangleSoup environment_surface(const Scenario& scenario, const NamedFiles& files);

}  // namespace hapbench
