#pragma once

#include "algorithms/peers/peer.hpp"

/// Peers that no run takes contacts of, linked with the benchmark.
namespace hapbench::bench {

MakePeer make_kd_tree;  ///< over points: the vertices of the surface
MakePeer make_ode;

}  // namespace hapbench::bench
