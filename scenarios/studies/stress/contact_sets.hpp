#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "algorithms/rendering_config.hpp"
#include "sim/core/random.hpp"
#include "sim/geometry/point_shell.hpp"
#include "sim/tool/cylinder.hpp"

/// Random contact situations, most of them degenerate: where a force may stop being finite. All are about cylinders,
/// whose axis, side and edges are where directions are lost.
namespace hapbench {

/// A tool among points that it touches, and how they are rendered.
struct ContactSet {
  const char* family = "";
  Cylinder tool;
  ToolPose pose;
  Vec3 velocity = Vec3::Zero();      ///< [m/s]
  std::vector<SurfacePoint> points;  ///< in the tool but for rounding; normals are unit vectors or zero
  RenderingConfig rendering;         ///< all but the algorithm
};

/// Most points of a set; the reduction of some keeps fewer (n_ext).
inline constexpr std::size_t kMostContacts = 200;

/// Names of the families: points on the axis, on the surface, coincident; normals that are zero, equal, opposite,
/// nearly so, or more different ones than n_ext; scenes of 1e-12 m and of 1e3 m.
std::span<const char* const> contact_set_families();

/// One set of a family drawn at random. The same random numbers give the same set.
ContactSet draw_contact_set(Random& random);

}  // namespace hapbench
