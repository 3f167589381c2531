#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "algorithms/module/hapbench_module.h"

/// Collision libraries that the benchmark compares with hapbench's search. Eigen is not used: the libraries are
/// compiled with their own flags, and a type whose layout depends on flags must not pass between them and the
/// benchmark.
namespace hapbench::bench {

struct PeerContact {
  std::uint32_t index;  ///< index of the point, if the library finds points
  double depth;         ///< depth [m], if the library computes depths
};

/// A library with its data structure over a surface.
class Peer {
 public:
  virtual ~Peer() = default;
  /// Fills `room` with the contacts at the pose and returns their number.
  virtual std::size_t contacts_at(const HapbenchPose& pose, std::span<PeerContact> room) = 0;
};

/// Return a library for the surface and the tool of the run.
std::unique_ptr<Peer> bullet(const HapbenchRun& run);
std::unique_ptr<Peer> fcl(const HapbenchRun& run);
std::unique_ptr<Peer> kd_tree(const HapbenchRun& run);  ///< CGAL, over the vertices of the surface
std::unique_ptr<Peer> ode(const HapbenchRun& run);

}  // namespace hapbench::bench
