#pragma once

#include <memory>

#include "algorithms/peers/peer_source.hpp"
#include "scenarios/description/load_scenario.hpp"

namespace hapbench {

/// The scenario's environment as triangles: those whose vertices our shell has, or those of its mesh file.
/// Precondition: it is a block_with_hole or a mesh. Throws InputError when the file cannot be used.
PeerSurface peer_surface(const Scenario& scenario, const NamedFiles& files);

/// Loads the module of rendering.contact_source. Throws InputError, which says how to have it, when it is not there.
void require_contact_source(const Scenario& scenario);

/// The contacts of rendering.contact_source. Building the library's tree over the triangles takes seconds for millions.
/// Precondition: it is not kOwnContacts. Throws InputError.
std::unique_ptr<ContactSource> make_peer_source(const Scenario& scenario, const NamedFiles& files);

}  // namespace hapbench
