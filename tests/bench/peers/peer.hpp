#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

/// Collision libraries that a haptics researcher would otherwise take, asked about the scenes of our searches.
///
/// Plain numbers only, no Eigen: the libraries are compiled as Debian compiles them, and a type whose layout depends on
/// flags must not pass between both.
namespace hapbench::bench {

/// The block with a hole, for each library in the form that it wants.
struct PeerSurface {
  std::vector<double> points;            ///< of our shell: x, y, z of each [m]
  std::vector<double> vertices;          ///< of the triangles that marching cubes makes of the block, alike
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

struct PeerAnswer {
  std::size_t contacts = 0;  ///< points or triangles, as the library counts
  double depth = 0.0;        ///< the largest one that it says [m]
};

/// One library with its structure over the surface, made once.
class Peer {
 public:
  virtual ~Peer() = default;
  virtual PeerAnswer ask(const PeerPose& pose) = 0;
  /// The numbers of the shell's points in the drill at the last pose, ascending; of a library that answers with
  /// triangles empty.
  virtual const std::vector<std::uint32_t>& points() const {
    static const std::vector<std::uint32_t> none;
    return none;
  }
};

using MakePeer = std::unique_ptr<Peer>(const PeerSurface& surface, const PeerDrill& drill);
MakePeer make_fcl, make_bullet, make_ode, make_kd_tree;

}  // namespace hapbench::bench
