#pragma once

#include <filesystem>
#include <span>
#include <string_view>

#include "sim/mesh/triangle_soup.hpp"

/// The mesh formats. Each reader takes the contents of a file, whose name is for messages, and returns vertices and
/// faces in the file's unit: numbers of text in double precision, those of binary files as they are stored. Vertex
/// indices are not compared with the number of vertices, and coordinates of binary files may be no finite numbers:
/// MeshFile checks both for all formats. Files come from outside: each word is checked, and memory grows with
/// what a file holds, never with what it declares. Throws InputError that names the file, and the line of a text.
namespace hapbench {

/// Wavefront OBJ: the lines "v" and "f"; other lines are passed over.
TriangleSoup read_obj(std::string_view text, const std::filesystem::path& file);

/// OFF with or without normals, colours and texture coordinates; the binary form that OpenMesh writes, too: "OFF
/// BINARY", 32-bit numbers, little endian.
TriangleSoup read_off(std::string_view text, const std::filesystem::path& file);

/// STL, text or binary.
TriangleSoup read_stl(std::string_view text, const std::filesystem::path& file);

/// PLY, text or binary of either byte order. Elements and properties that are no part of the surface are passed over.
TriangleSoup read_ply(std::string_view text, const std::filesystem::path& file);

/// Cuts a polygon into a fan of triangles from its first corner.
void add_polygon(std::span<const std::uint32_t> corners, TriangleSoup& soup);

}  // namespace hapbench
