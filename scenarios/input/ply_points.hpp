#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

#include "sim/geometry/point_shell.hpp"

namespace hapbench {

/// The vertices in the contents of a PLY file, ASCII or binary of either byte order: `vertex` must be the first element
/// and have the properties x, y, z [m], nx, ny, nz among its scalar ones; everything after the vertices (faces, say) is
/// ignored. Throws InputError that names file and line or vertex.
std::vector<SurfacePoint> ply_points_in(std::string_view text, const std::filesystem::path& file);

}  // namespace hapbench
