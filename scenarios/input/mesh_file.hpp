#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/geometry/point_shell.hpp"
#include "sim/geometry/triangle_tree.hpp"

/// Files that hold the surface of an environment or a tool: triangle meshes, and point shells.
namespace hapbench {

struct CheckedMesh;

/// How a mesh becomes a point shell.
struct MeshSampling {
  double scale = 1.0;             ///< [m] for each unit of the file
  std::optional<double> spacing;  ///< [m]; none: take the mesh's own vertices
  bool flip = false;              ///< turn all normals of an open surface round; a closed one is refused
};

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

// ---- Readers of the formats: vertices and faces in the file's unit. Numbers of a text are read in double precision,
// those of binary files as they are stored. MeshFile checks for all formats that indices are those of vertices and that
// coordinates are finite. They throw InputError that names the file, and the line of a text.

/// Wavefront OBJ: the lines "v" and "f"; other lines are ignored.
TriangleSoup read_obj(std::string_view text, const std::filesystem::path& file);
/// OFF as a text, with or without normals, colours and texture coordinates.
TriangleSoup read_off(std::string_view text, const std::filesystem::path& file);
/// STL, text or binary.
TriangleSoup read_stl(std::string_view text, const std::filesystem::path& file);
/// PLY, text or binary of either byte order. Elements and properties that are not part of the surface are ignored.
TriangleSoup read_ply(std::string_view text, const std::filesystem::path& file);
/// The vertices of a PLY file, with properties x, y, z [m], nx, ny, nz of any type.
std::vector<SurfacePoint> ply_points_in(std::string_view text, const std::filesystem::path& file);

/// The extension of a point shell's file. Throws InputError when it is neither .csv nor .ply.
std::string shell_extension(const std::filesystem::path& file);

/// The point shell in the contents of a file: CSV with header x_m,y_m,z_m,nx,ny,nz, or PLY with vertex normals.
/// Normals, normalised unless unit to rounding, must be unit to 1e-3, coordinates finite and within 1 km. Throws
/// InputError that names file and point.
std::vector<SurfacePoint> point_shell_in(std::string_view text, const std::filesystem::path& file);

/// The shell as the text of a .csv (shortest round-trip numbers) or .ply file (single precision, for viewers). Throws
/// InputError for another extension.
std::string point_shell_text(const std::vector<SurfacePoint>& points, const std::filesystem::path& file);

}  // namespace hapbench
