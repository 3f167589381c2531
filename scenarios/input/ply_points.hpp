#pragma once

#include <filesystem>
#include <vector>

#include "sim/geometry/point_shell.hpp"

namespace hapbench {

/// Reads the vertices of a PLY file, ASCII or binary of either byte order: `vertex` must be the first element and have
/// the properties x, y, z [m], nx, ny, nz among its scalar ones; everything after the vertices (faces, say) is ignored.
/// Read here and not with the mesh library, which believes counts, hangs on cut headers and takes words for zeros:
/// point files come from outside. Throws InputError that names file and line or vertex.
std::vector<SurfacePoint> read_ply_points(const std::filesystem::path& file);

}  // namespace hapbench
