#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "algorithms/module/hapbench_module.h"

/// Collision libraries that the benchmark asks the questions of our search. No Eigen: they are compiled with the flags
/// of their libraries, and a type whose layout depends on flags must not pass between them and the benchmark.
namespace hapbench::bench {

struct PeerContact {
  std::uint32_t index;  ///< of the point, where points are asked for
  double depth;         ///< [m], of libraries that have one
};

/// A library with its structure over a surface.
class Peer {
 public:
  virtual ~Peer() = default;
  /// Fills `room` with the contacts at the pose and returns their number.
  virtual std::size_t contacts_at(const HapbenchPose& pose, std::span<PeerContact> room) = 0;
};

/// Surface and tool are those of the run.
std::unique_ptr<Peer> bullet(const HapbenchRun& run);
std::unique_ptr<Peer> fcl(const HapbenchRun& run);
std::unique_ptr<Peer> kd_tree(const HapbenchRun& run);  ///< CGAL, over the vertices of the surface
std::unique_ptr<Peer> ode(const HapbenchRun& run);

}  // namespace hapbench::bench
