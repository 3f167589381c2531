#pragma once

#include <filesystem>
#include <string_view>

#include "sim/geometry/triangle_tree.hpp"

namespace hapbench {

/// Vertices and faces of a Wavefront OBJ file in the file's unit: the lines "v" and "f"; other lines are ignored.
/// Numbers are read in double precision. MeshFile checks that indices are those of vertices and that coordinates are
/// finite. Throws InputError that names the file and the line.
TriangleSoup read_obj(std::string_view text, const std::filesystem::path& file);

}  // namespace hapbench
