#pragma once

#include <filesystem>
#include <string_view>

#include "scenarios/input/mesh_faces.hpp"

namespace hapbench {

/// Parses the vertices and faces of an OFF file in text form. Ignores normals, colours and texture coordinates. Warns
/// about lines after the last face. The count of vertices may follow the keyword without a blank ("OFF8 6 12").
/// Returns coordinates in the file's unit, read in double precision. Does not check that every vertex index of a
/// face exists and that coordinates stay finite after scaling; MeshFile does. Throws InputError with file and
/// line.
MeshFaces read_off(std::string_view text, const std::filesystem::path& file);

}  // namespace hapbench
