#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "algorithms/module/hapbench_module.h"

/// Collision libraries that the benchmark compares with hapbench's search. The interface has no types of Eigen: the
/// libraries are compiled with their own flags, and the layout of Eigen's types depends on the flags.
namespace hapbench::bench {

struct PeerContact {
  std::uint32_t index;  ///< index of the point, if the library finds points
  double depth;         ///< depth [m], if the library computes depths
};

/// A collision library with the data structure that it has built over a surface.
class Peer {
 public:
  virtual ~Peer() = default;
  /// Writes the contacts at the pose into `room` and returns their number. Contacts beyond the size of `room` are lost.
  virtual std::size_t contacts_at(const HapbenchPose& pose, std::span<PeerContact> room) = 0;
};

/// Return a library for the surface and the tool of the run.
std::unique_ptr<Peer> bullet(const HapbenchRun& run);
std::unique_ptr<Peer> fcl(const HapbenchRun& run);
std::unique_ptr<Peer> kd_tree(const HapbenchRun& run);  ///< CGAL, over the vertices of the surface only
std::unique_ptr<Peer> ode(const HapbenchRun& run);

}  // namespace hapbench::bench
