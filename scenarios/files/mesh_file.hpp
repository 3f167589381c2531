#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sim/environment/point_shell.hpp"

namespace hapbench {

/// How a mesh becomes a point shell.
struct MeshSampling {
  double scale = 1.0;             ///< [m] for each unit of the file
  std::optional<double> spacing;  ///< [m]; none: the mesh's own vertices
};

struct MeshPoints {
  std::vector<SurfacePoint> points;
  std::vector<std::string> warnings;  ///< oddities of the file, with its name
};

/// Reads a mesh (.obj, .ply, .stl, .off; ASCII or binary) as points with normals: its vertices, or with a spacing those
/// of the same surface refined until no edge is longer, thinned where there are more than one point in a cube of that
/// size. Warns about open meshes and winding that had to be changed. Throws InputError that names the file and says why
/// it is refused.
MeshPoints read_mesh_points(const std::filesystem::path& file, const MeshSampling& sampling);

}  // namespace hapbench
