#pragma once

#include <memory>

#include "results/observe/force_fidelity.hpp"
#include "scenarios/scene/named_files.hpp"
#include "scenarios/scene/scenario.hpp"

namespace hapbench {

/// Returns the force K (x' - x) on a tool in frictionless contact with the rigid triangles of the scene's mesh, in
/// every step: x is the prescribed position, x' the free position nearest to it that the path has reached
/// (RigidContact), and K is rendering.stiffness. The result is kept for other runs with the same path, mesh, tool and
/// K. Cost: about 20 us a step. Throws InputError if the path begins in contact with the mesh or inside it, or if the
/// tool's flat far end touches.
std::shared_ptr<const ReferenceForce> rigid_contact_force(const Scenario& scenario, const NamedFiles& files);

}  // namespace hapbench
