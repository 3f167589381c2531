#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sim/geometry/point_shell.hpp"

namespace hapbench {

/// How a mesh becomes a point shell.
struct MeshSampling {
  double scale = 1.0;             ///< [m] for each unit of the file
  std::optional<double> spacing;  ///< [m]; none: the mesh's own vertices
};

/// Reads a mesh (.obj, .ply, .stl, .off; ASCII or binary) as points with normals: its vertices, or with a spacing those
/// of the same surface refined until no edge is longer, thinned where there are more than one point in a cube of that
/// size. Throws InputError that names the file and says why it is refused.
std::vector<SurfacePoint> read_mesh_points(const std::filesystem::path& file, const MeshSampling& sampling);

/// What is odd about a mesh that can be read: it is open, or its winding had to be changed. Each names the file. Throws
/// whenever read_mesh_points would, and is cheaper, because it does not resample.
std::vector<std::string> mesh_warnings(const std::filesystem::path& file, const MeshSampling& sampling);

}  // namespace hapbench
