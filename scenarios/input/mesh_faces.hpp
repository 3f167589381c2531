#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "sim/core/types.hpp"
#include "sim/geometry/triangle_tree.hpp"

namespace hapbench {

/// Vertices and faces of a mesh file, as its reader found them. Faces are polygons with three corners or more.
struct MeshFaces {
  std::vector<Vec3> vertices;               ///< positions in the file's unit, or in metres after scaling
  std::vector<std::uint32_t> corners = {};  ///< vertex indices of all faces, from 0
  std::vector<std::uint32_t> ends = {};     ///< for each face: index in `corners` after its last corner
  /// Lines in the file, from 1, of the vertices and of the faces. Empty for a binary file.
  std::vector<std::uint32_t> vertex_lines = {}, face_lines = {};
  std::uint32_t first_vertex = 0;          ///< number of the first vertex in this format: 1 in OBJ, else 0
  const char* face_name = "face";          ///< name of a face in messages: "triangle" in STL
  std::size_t unfinished_line = 0;         ///< line of the last face if the file has no line end after it; else 0
  std::vector<std::string> warnings = {};  ///< what the reader ignored or guessed

  /// Returns the corners of a face.
  std::span<const std::uint32_t> face(std::size_t f) const {
    const std::size_t begin = f == 0 ? 0 : ends[f - 1];
    return std::span(corners).subspan(begin, ends[f] - begin);
  }
  /// Ends a face whose corners were appended to `corners`. `line` is 0 in a binary file.
  void end_face(std::size_t line) {
    ends.push_back(static_cast<std::uint32_t>(corners.size()));
    if (line > 0) face_lines.push_back(static_cast<std::uint32_t>(line));
  }
  /// Appends a vertex. `line` is 0 in a binary file.
  void add_vertex(const Vec3& vertex, std::size_t line) {
    vertices.push_back(vertex);
    if (line > 0) vertex_lines.push_back(static_cast<std::uint32_t>(line));
  }

  /// Throws InputError that names the file, the vertex by its number in this format, and its line.
  [[noreturn]] void fail_at_vertex(std::size_t vertex, const std::string& problem,
                                   const std::filesystem::path& file) const;
  /// Throws InputError that names the file, the face by its number (from 1 in OBJ, else from 0), and its line.
  [[noreturn]] void fail_at_face(std::size_t f, const std::string& problem, const std::filesystem::path& file) const;
};

/// Throws InputError if a face refers to a vertex that the file does not have.
void check_indices(const MeshFaces& faces, const std::filesystem::path& file);

/// Divides the faces into triangles (PolygonDivider). Adds warnings to `faces` about polygons that are not planar and
/// polygons with repeated corners. Throws InputError for a face that cannot be divided. Precondition: check_indices().
std::vector<TriangleCorners> triangles_of(MeshFaces& faces, const std::filesystem::path& file);

}  // namespace hapbench
