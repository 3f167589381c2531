#pragma once

#include <memory>

#include "results/observe/force_fidelity.hpp"
#include "scenarios/scene/named_files.hpp"
#include "scenarios/scene/scenario.hpp"

namespace hapbench {

/// Returns the force k (x' - x) on a tool in frictionless contact with the rigid triangles of the scene's mesh, in
/// every step: x' is the free position nearest to x that the path has reached (RigidContact). In a prescribed motion, x
/// is the prescribed position and k is rendering.stiffness. With a free tool, x is the target of the hand's spring and
/// k its stiffness: then the force does not depend on the law's stiffness, and it is the static force, without inertia
/// and damping. The result is kept for other runs with the same path, mesh, tool and k. Cost: about 20 us a step.
/// Throws InputError if the path begins in contact with the mesh or inside it, or if the tool's flat far end touches.
std::shared_ptr<const ReferenceForce> rigid_contact_force(const Scenario& scenario, const NamedFiles& files);

}  // namespace hapbench
