#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "sim/geometry/point_shell.hpp"
#include "sim/geometry/triangle_tree.hpp"

namespace hapbench {

/// Vertices and faces of a PLY file, text or binary of either byte order, in the file's unit. Elements and properties
/// that are not part of the surface are ignored. Numbers of a text are read in double precision, those of a binary file
/// as they are stored. MeshFile checks that indices are those of vertices and that coordinates are finite. Throws
/// InputError that names the file and, of a text, the line.
TriangleSoup read_ply(std::string_view text, const std::filesystem::path& file);

/// The vertices of a PLY file, with properties x, y, z [m], nx, ny, nz of any type. Throws as read_ply does.
std::vector<SurfacePoint> ply_points_in(std::string_view text, const std::filesystem::path& file);

}  // namespace hapbench
