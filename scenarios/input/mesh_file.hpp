#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "scenarios/input/mesh_sampling.hpp"
#include "sim/geometry/point_shell.hpp"
#include "sim/geometry/triangle_tree.hpp"

/// Triangle-mesh files with the surface of an environment or of a tool.
namespace hapbench {

struct CheckedMesh;
struct MeshFindings;

/// Returns true if the file has the extension of a supported mesh format.
bool is_mesh_name(const std::filesystem::path& file);
/// Returns the extension of a mesh file in lower case, such as ".obj". Throws InputError if the format is not
/// supported.
std::string mesh_extension(const std::filesystem::path& file);

/// A component of a mesh is a speck if its diameter is at most this fraction of the diameter of the largest component.
inline constexpr double kSpeckSize = 0.05;

/// Returns the number of components that are not specks (kSpeckSize). These components come first in the list of
/// components. In a mesh that was cut along edges with more than two faces, no component counts as a speck, because
/// small components may belong to the surface.
std::size_t components_above_speck_size(const MeshFindings& found);

/// The checked surface of a mesh file (.obj, .ply, .stl or .off; PLY and STL as text or binary). Copies share the
/// surface.
class MeshFile {
 public:
  /// Parses and checks `bytes`, the contents of `file`. The extension of `file` selects the format. Throws
  /// InputError that names the file.
  MeshFile(std::string_view bytes, const std::filesystem::path& file, const MeshSampling& sampling);

  /// Returns warnings about the file and the mesh: parts of the file were ignored, the mesh is open, it has specks
  /// (components much smaller than the largest component), or it was repaired (faces were reversed, removed, or cut
  /// apart at an edge). Each warning names the file without its folder, because warnings are part of the results and
  /// results must not depend on the folder.
  std::vector<std::string> warnings(const std::filesystem::path& file) const;
  /// Returns the midpoints of the boundary edges, which have only one face [m]. Empty for a closed surface.
  const std::vector<Vec3>& open_edges() const;

  /// Returns true if every edge of the file's mesh has exactly two faces.
  bool is_closed() const;
  /// Returns true if every component is closed, so that the outside is known and the normals point outwards.
  bool knows_outside() const;

  /// Returns the repairs, irregularities and components of the mesh.
  const MeshFindings& findings() const;
  /// Returns a mesh that consists of the component with the largest diameter, with the same sampling and without
  /// warnings of the file reader. Returns the mesh itself if it has only one component.
  MeshFile largest_component() const;

  /// Returns the triangles [m], with consistent winding. Faces of closed parts are wound such that their normals
  /// point outwards.
  TriangleSoup triangles() const;

  /// Returns the points of the point shell, with normals: the vertices of the mesh. If the sampling has a spacing, the
  /// mesh is first refined until no edge is longer than the spacing, and its vertices are then subsampled: at most one
  /// point is kept in each cube with the spacing as side length.
  std::vector<SurfacePoint> points() const;

 private:
  MeshFile(std::shared_ptr<const CheckedMesh> surface, const MeshSampling& sampling)
      : sampling_(sampling), surface_(std::move(surface)) {}

  MeshSampling sampling_;
  std::vector<std::string> file_warnings_;  ///< what the reader of the format ignored or guessed
  std::shared_ptr<const CheckedMesh> surface_;
};

}  // namespace hapbench
