#pragma once

#include <filesystem>

#include "scenarios/input/mesh_text.hpp"
#include "sim/mesh/mesh_from_triangles.hpp"

namespace hapbench {

/// Vertices and faces of a mesh as OpenMesh reads them, in the file's unit and single precision; polygons are cut into
/// fans of triangles from their first corner. OpenMesh's readers crash, hang and exhaust memory on damaged files, so
/// they work in a child process with limits. All indices in the result are valid. `file` is for messages and for the
/// one reader (binary OFF) that must look at the file itself. Throws InputError that names the file.
TriangleSoup read_with_mesh_library(const MeshText& mesh, const std::filesystem::path& file);

}  // namespace hapbench
