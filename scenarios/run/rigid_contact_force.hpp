#pragma once

#include <memory>

#include "results/observe/force_fidelity.hpp"
#include "scenarios/scene/named_files.hpp"
#include "scenarios/scene/scenario.hpp"

namespace hapbench {

/// Returns, for every step, the force k (x' - x) on a tool in frictionless contact with the rigid triangles of the
/// scene's mesh. x' is the collision-free position nearest to x that can be reached along the path (RigidContact). In a
/// prescribed motion, x is the prescribed position and k is rendering.stiffness. If the tool is free, x is the target
/// of the hand's spring and k is the stiffness of this spring. The force of a free tool is static (without inertia and
/// damping) and does not depend on the law's stiffness. The result is cached for other runs with the same path, mesh,
/// tool and k. Cost: about 20 us a step. Throws InputError if the path begins in contact with the mesh or inside it, or
/// if the tool's flat end opposite to the tip touches the mesh.
std::shared_ptr<const ReferenceForce> rigid_contact_force(const Scenario& scenario, const NamedFiles& files);

}  // namespace hapbench
