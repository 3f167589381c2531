#pragma once

#include <filesystem>
#include <string_view>

#include "sim/geometry/triangle_tree.hpp"

namespace hapbench {

/// Vertices and faces of an OFF file in the file's unit, from a text with or without normals, colours and texture
/// coordinates. Numbers are read in double precision. MeshFile checks that indices are those of vertices and that
/// coordinates are finite. Throws InputError that names the file and the line.
TriangleSoup read_off(std::string_view text, const std::filesystem::path& file);

}  // namespace hapbench
