#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sim/geometry/point_shell.hpp"

namespace hapbench {

/// Reads a point shell: CSV with header x_m,y_m,z_m,nx,ny,nz or PLY with vertex normals (ply_points.hpp). Normals must
/// be unit to 1e-3 and are normalised unless they are unit to rounding; coordinates must be finite and within 1 km.
/// Throws InputError that names file and point.
std::vector<SurfacePoint> read_point_shell(const std::filesystem::path& file);

/// The shell as the text of a .csv (shortest round-trip numbers) or .ply file (single precision, for viewers), by the
/// file's extension. Throws InputError for another extension.
std::string point_shell_text(const std::vector<SurfacePoint>& points, const std::filesystem::path& file);

}  // namespace hapbench
