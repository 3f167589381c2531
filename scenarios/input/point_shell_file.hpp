#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "sim/geometry/point_shell.hpp"

/// Files that contain the surface of an environment as points with normals (a point shell).
namespace hapbench {

/// Returns the extension of a point-shell file. Throws InputError unless it is .csv or .ply.
std::string shell_extension(const std::filesystem::path& file);

/// Parses the contents of a point-shell file: CSV with the columns x_m,y_m,z_m,nx,ny,nz (parse_number_table), or PLY
/// with vertex normals. Coordinates must be finite, with a magnitude of at most 1 km. Normals must have length 1 within
/// 1e-3. They are normalised, unless their length is 1 within 1e-12. `notes`: receives what the reader ignored or
/// assumed (NumberTable::notes, parse_ply_points). Throws InputError that names the file, the line or point, and how
/// many further points have faults.
std::vector<SurfacePoint> parse_point_shell(std::string_view text, const std::filesystem::path& file,
                                            std::vector<std::string>* notes = nullptr);

/// Returns the contents of a file with these points. The extension of `file` selects the format, .csv or .ply. CSV has
/// the shortest numbers that read back exactly. PLY has single precision, for viewers. Throws InputError for every
/// other extension.
std::string format_point_shell(const std::vector<SurfacePoint>& points, const std::filesystem::path& file);

}  // namespace hapbench
