#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/geometry/point_shell.hpp"
#include "sim/mesh/triangle_soup.hpp"

namespace hapbench {

struct CheckedMesh;

/// How a mesh becomes a point shell.
struct MeshSampling {
  double scale = 1.0;             ///< [m] for each unit of the file
  std::optional<double> spacing;  ///< [m]; none: the mesh's own vertices
};

/// Returns true for a file name with the extension of a mesh format that is read.
bool is_mesh_name(const std::filesystem::path& file);
/// The extension of a mesh file, in lower case. Throws InputError when it is that of no format that is read.
std::string mesh_extension(const std::filesystem::path& file);

/// The surface in a mesh file (.obj, .ply, .stl, .off; text or binary). Copies share it.
class MeshFile {
 public:
  /// `bytes` are the contents of the file; its name tells the format. Does all checks. Throws InputError that names the
  /// file and says why it is refused.
  MeshFile(std::string_view bytes, const std::filesystem::path& file, const MeshSampling& sampling);

  /// What is odd about the mesh: it is open, or its winding had to be changed. Each names the file, without
  /// its directory.
  const std::vector<std::string>& warnings() const { return warnings_; }
  /// Middles of the edges where the surface ends [m]; none when it is closed.
  const std::vector<Vec3>& open_edges() const;

  /// Its triangles, all wound alike and outwards where the surface is closed [m].
  TriangleSoup triangles() const;

  /// Points with normals: the mesh's vertices, or with a spacing those of the same surface refined until no edge is
  /// longer, thinned where there are more than one point in a cube of that size.
  std::vector<SurfacePoint> points() const;

 private:
  MeshSampling sampling_;
  std::shared_ptr<const CheckedMesh> surface_;
  std::vector<std::string> warnings_;
};

}  // namespace hapbench
