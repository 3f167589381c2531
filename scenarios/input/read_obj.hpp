#pragma once

#include <filesystem>
#include <string_view>

#include "scenarios/input/mesh_faces.hpp"

namespace hapbench {

/// Parses the vertices (lines "v") and faces (lines "f") of a Wavefront OBJ file. A backslash at the end of a line
/// continues the line. Warns about lines with other shapes (such as "l" or "curv"), with unknown statements, and with
/// weights of vertices. Returns coordinates in the file's unit, read in double precision. Does not check that every
/// vertex index of a face exists and that coordinates stay finite after scaling; MeshFile does. Throws InputError with
/// file and line.
MeshFaces read_obj(std::string_view text, const std::filesystem::path& file);

}  // namespace hapbench
