#pragma once

#include <filesystem>
#include <string_view>

#include "sim/geometry/triangle_tree.hpp"

namespace hapbench {

/// Vertices and faces of an STL file, text or binary, in the file's unit. Numbers of a text are read in double
/// precision, those of a binary file as they are stored. MeshFile checks that coordinates are finite. Throws InputError
/// that names the file and, of a text, the line.
TriangleSoup read_stl(std::string_view text, const std::filesystem::path& file);

}  // namespace hapbench
