#pragma once

#include "algorithms/rendering_config.hpp"
#include "scenarios/batch/jobs.hpp"
#include "sim/geometry/point_shell.hpp"
#include "sim/tool/cylinder.hpp"

/// Random contact situations, most of them degenerate: where a force may stop being finite. All are about cylinders,
/// whose axis, side and edges are where directions are lost.
namespace hapbench {

/// A tool among points that it touches, and how they are rendered.
struct ContactSet {
  Cylinder tool;
  ToolPose pose;
  Vec3 velocity = Vec3::Zero();      ///< [m/s]
  std::vector<SurfacePoint> points;  ///< in the tool but for rounding; normals are unit vectors or zero
  RenderingConfig rendering;         ///< all but the algorithm
};

/// Most points of a set; the reduction of some keeps fewer (n_ext).
inline constexpr std::size_t kMostContacts = 200;

/// Set number `i` of the seed, by the numbers that the counts name: points on the axis, on the surface, coincident;
/// normals that are zero, equal, opposite, nearly so, or more different ones than n_ext; scenes of 1e-12 and 1e3 m.
ContactSet stress_set(std::uint64_t seed, std::uint64_t i);

/// The counts of one algorithm over all sets.
struct StressCounts {
  std::string algorithm;
  std::uint64_t sets = 0;            ///< drawn
  std::uint64_t in_contact = 0;      ///< whose tool touches a point
  std::uint64_t non_finite = 0;      ///< force, tensor or depth not finite
  std::uint64_t out_of_bound = 0;    ///< finite, but beyond a bound
  std::uint64_t points_dropped = 0;  ///< by a full reduction
  double largest_force = 0.0;        ///< largest |f_spring| in units of K d, d the deepest point of the set
  /// Largest |f_spring| in units of its bound (AlgorithmEntry::force_bound); none for algorithms without one.
  std::optional<double> largest_share;
  std::optional<std::uint64_t> first_bad;  ///< number of the first set that is not finite or out of bound
};

/// Sends sets 0 … count - 1 of the seed through every algorithm of the registry; one entry each, in its order. The same
/// counts whatever the number of threads. About 2.5 us a set and algorithm.
std::vector<StressCounts> stress_laws(std::uint64_t count, std::uint64_t seed, const JobOptions& options);

}  // namespace hapbench
