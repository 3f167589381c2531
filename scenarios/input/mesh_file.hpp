#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "scenarios/input/mesh_sampling.hpp"
#include "sim/geometry/point_shell.hpp"
#include "sim/geometry/triangle_tree.hpp"

/// Files that hold the surface of an environment or a tool as a triangle mesh.
namespace hapbench {

struct CheckedMesh;

/// True when the file's extension is that of a supported mesh format.
bool is_mesh_name(const std::filesystem::path& file);
/// The extension of a mesh file, in lower case. Throws InputError if the format is not supported.
std::string mesh_extension(const std::filesystem::path& file);

/// The surface in a mesh file (.obj, .ply, .stl, .off; PLY and STL also binary). Copies share it.
class MeshFile {
 public:
  /// `bytes` are the contents of the file, whose name tells the format. Checks all. Throws InputError that names it.
  MeshFile(std::string_view bytes, const std::filesystem::path& file, const MeshSampling& sampling);

  /// Peculiarities of the mesh of this file: it is open, or its winding was changed. Each names the file without its
  /// directory, because results, into which they go, must not depend on where it lies.
  std::vector<std::string> warnings(const std::filesystem::path& file) const;
  /// Midpoints of the edges where the surface ends [m]; empty when it is closed.
  const std::vector<Vec3>& open_edges() const;

  /// True when it has no such edges and none with more than two faces.
  bool is_closed() const;

  /// Its triangles, all wound alike and outwards where the surface is closed [m].
  TriangleSoup triangles() const;

  /// Points with normals: the vertices of the mesh. With a spacing, the mesh is first refined until no edge is longer
  /// than it, and then at most one point is kept in each cube of that size.
  std::vector<SurfacePoint> points() const;

 private:
  MeshSampling sampling_;
  std::shared_ptr<const CheckedMesh> surface_;
};

}  // namespace hapbench
