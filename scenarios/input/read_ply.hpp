#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "scenarios/input/mesh_faces.hpp"
#include "sim/geometry/point_shell.hpp"

namespace hapbench {

/// Parses the vertices and faces of a PLY file, which is text or binary with either byte order. Ignores all other
/// elements and properties. Warns about data after the last declared entry. Returns coordinates in the file's unit.
/// Numbers in a text are read in double precision; numbers in a binary file have the precision of their stored type.
/// Does not check that every vertex index of a face exists and that binary coordinates are finite; MeshFile does.
/// Throws InputError that names the file and, for a text, the line.
MeshFaces read_ply(std::string_view text, const std::filesystem::path& file);

/// Parses the vertices of a PLY file as points with normals, from the properties x, y, z [m], nx, ny and nz of any
/// numeric type. Ignores all other elements and properties. `notes`: receives warnings about data after the last
/// declared vertex. Throws InputError that names the file and, for a text, the line.
std::vector<SurfacePoint> parse_ply_points(std::string_view text, const std::filesystem::path& file,
                                           std::vector<std::string>* notes = nullptr);

}  // namespace hapbench
