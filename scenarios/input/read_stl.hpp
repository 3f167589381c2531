#pragma once

#include <filesystem>
#include <string_view>

#include "sim/geometry/triangle_tree.hpp"

namespace hapbench {

/// Parses the triangles of an STL file, which is text or binary. Each triangle has its own three vertices;
/// vertices are not merged. Returns coordinates in the file's unit. Numbers in a text are read in double
/// precision; numbers in a binary file have single precision. Throws InputError that names the file and, for a
/// text, the line.
TriangleSoup read_stl(std::string_view text, const std::filesystem::path& file);

}  // namespace hapbench
