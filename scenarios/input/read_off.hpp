#pragma once

#include <filesystem>
#include <string_view>

#include "sim/geometry/triangle_tree.hpp"

namespace hapbench {

/// Parses the vertices and faces of an OFF file in text form. Ignores normals, colours and texture coordinates.
/// Returns coordinates in the file's unit, read in double precision. Does not check that every vertex index of a
/// face exists and that coordinates stay finite after scaling; MeshFile does. Throws InputError with file and
/// line.
TriangleSoup read_off(std::string_view text, const std::filesystem::path& file);

}  // namespace hapbench
