#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "sim/geometry/point_shell.hpp"

/// Files that hold the surface of an environment as points with normals.
namespace hapbench {

/// The extension of a point shell's file. Throws InputError when it is neither .csv nor .ply.
std::string shell_extension(const std::filesystem::path& file);

/// The point shell in the contents of a file: CSV with header x_m,y_m,z_m,nx,ny,nz, or PLY with vertex normals.
/// Normals, normalised unless unit to rounding, must be unit to 1e-3, coordinates finite and within 1 km. Throws
/// InputError that names file and point.
std::vector<SurfacePoint> point_shell_in(std::string_view text, const std::filesystem::path& file);

/// The shell as the text of a .csv (shortest round-trip numbers) or .ply file (single precision, for viewers). Throws
/// InputError for another extension.
std::string point_shell_text(const std::vector<SurfacePoint>& points, const std::filesystem::path& file);

}  // namespace hapbench
