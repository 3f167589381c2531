#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "sim/mesh/half_edge_mesh.hpp"

/// Mesh files in all formats, written independently of the program's readers.
namespace hapbench::test {

std::string obj_text(const TriangleSoup& soup);
std::string off_text(const TriangleSoup& soup);
std::string stl_text(const TriangleSoup& soup);
std::string ply_text(const TriangleSoup& soup);
/// Binary STL as OpenMesh writes it: little endian, without colours.
std::string binary_stl_text(const TriangleSoup& soup);
/// Binary PLY with coordinates as float or double and indices as int.
std::string binary_ply_text(const TriangleSoup& soup, bool little_endian, bool doubles);

struct NamedText {
  std::string name;  ///< file name with extension
  std::string text;
};
/// Prints the name in test listings.
void PrintTo(const NamedText& text, std::ostream* out);  // NOLINT: GoogleTest's name
/// Returns `soup` in every file format and encoding.
std::vector<NamedText> mesh_texts(const TriangleSoup& soup);

}  // namespace hapbench::test
