#pragma once

#include <string>

#include "algorithms/peers/peer.hpp"

namespace hapbench {

/// The maker of a peer (kPeers), whose module is loaded at the first use and stays; null when it has not been built.
/// For several threads. Throws InputError when a module cannot be loaded.
MakePeer* find_peer(const std::string& name);

/// The Debian package that a peer needs, for messages. Precondition: the name is one of kPeers.
std::string peer_package(const std::string& name);

}  // namespace hapbench
