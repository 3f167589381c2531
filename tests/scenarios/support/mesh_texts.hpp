#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "sim/mesh/half_edge_mesh.hpp"

/// Mesh files, written apart from the readers.
namespace hapbench::test {

std::string obj_text(const TriangleSoup& soup);
std::string off_text(const TriangleSoup& soup);
std::string stl_text(const TriangleSoup& soup);
std::string ply_text(const TriangleSoup& soup);
/// As OpenMesh writes it: little endian, no colours.
std::string binary_stl_text(const TriangleSoup& soup);
/// Coordinates as float or double, indices as int.
std::string binary_ply_text(const TriangleSoup& soup, bool little_endian, bool doubles);

struct NamedText {
  std::string name;  ///< of a file, with its extension
  std::string text;
};
/// So that test listings show the name.
void PrintTo(const NamedText& text, std::ostream* out);  // NOLINT: GoogleTest's name
/// The same mesh in every format and encoding.
std::vector<NamedText> mesh_texts(const TriangleSoup& soup);

}  // namespace hapbench::test
