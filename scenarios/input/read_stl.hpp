#pragma once

#include <filesystem>
#include <string_view>

#include "scenarios/input/mesh_faces.hpp"

namespace hapbench {

/// Parses the triangles of an STL file, which is text or binary. Each triangle has its own three vertices; vertices are
/// not merged. Returns coordinates in the file's unit. Numbers in a text are read in double precision; numbers in a
/// binary file have single precision. Throws InputError that names the file and, for a text, the line. A text that does
/// not end with "endsolid" is an error, and so is a binary file that is shorter than its header declares. Warns about
/// bytes after the last triangle of a binary file.
MeshFaces read_stl(std::string_view text, const std::filesystem::path& file);

}  // namespace hapbench
