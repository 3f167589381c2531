#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

/// Collision libraries that a haptics researcher would otherwise take, as sources of contacts and beside our search.
///
/// Plain numbers only, no Eigen: the libraries are compiled as Debian compiles them, and a type whose layout depends on
/// flags must not pass between both.
namespace hapbench {

/// The environment as triangles; for a library that wants points, these alone.
struct PeerSurface {
  std::vector<double> vertices;          ///< x, y, z of each [m]
  std::vector<std::uint32_t> triangles;  ///< three vertices of each, counter-clockwise from outside
};

/// The drill: a cylinder with a flat tip.
struct PeerDrill {
  double radius = 0.0;  ///< [m]
  double length = 0.0;  ///< [m]
};

/// The middle of the drill's axis, and the drill's frame, whose z points from the tip to the shank.
struct PeerPose {
  std::array<double, 3> centre = {};    ///< [m]
  std::array<double, 9> rotation = {};  ///< drill to world, row by row
};

/// A contact as the library says it is.
struct PeerContact {
  std::uint32_t number = 0;             ///< of the triangle, or of the point
  std::array<double, 3> point = {};     ///< [m]
  std::array<double, 3> gradient = {};  ///< unit vector; the drill gets deeper along it
  double depth = 0.0;                   ///< [m]
};

/// One library with its structure over the surface, made once.
class Peer {
 public:
  virtual ~Peer() = default;
  /// Fills `room` with the contacts at the pose, at most as many as fit, and returns how many. The same at the same
  /// pose, whatever was asked before. Allocates as the library does; throws what it throws.
  virtual std::size_t contacts_at(const PeerPose& pose, std::span<PeerContact> room) = 0;
};

using MakePeer = std::unique_ptr<Peer>(const PeerSurface& surface, const PeerDrill& drill);

/// The one function of a module that holds a peer (load_peer.hpp).
inline constexpr const char* kPeerEntryPoint = "hapbench_make_peer";

}  // namespace hapbench
