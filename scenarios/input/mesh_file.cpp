#include "scenarios/input/mesh_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/mesh_sampling.hpp"
#include "scenarios/input/read_obj.hpp"
#include "scenarios/input/read_off.hpp"
#include "scenarios/input/read_ply.hpp"
#include "scenarios/input/read_stl.hpp"
#include "scenarios/input/size_limits.hpp"
#include "scenarios/input/text_lines.hpp"
#include "sim/mesh/half_edge_mesh.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

/// A mesh format: file extension in lower case, and parser.
struct MeshFormat {
  std::string_view extension;
  TriangleSoup (*read)(std::string_view text, const fs::path& file);
};
constexpr MeshFormat kMeshFormats[] = {{".obj", read_obj}, {".ply", read_ply}, {".stl", read_stl}, {".off", read_off}};

/// Throws InputError if a triangle refers to a vertex that the file does not have.
void check_indices(const TriangleSoup& soup, const fs::path& file) {
  for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
    for (const std::uint32_t vertex : soup.triangles[t]) {
      if (vertex < soup.vertices.size()) continue;
      fail_in_file(file,
                   fmt::format("triangle {}: got vertex {}; allowed: 0 ... {}, the vertices of the file", t,
                               static_cast<std::int32_t>(vertex), static_cast<std::int64_t>(soup.vertices.size()) - 1));
    }
  }
}

/// Converts the vertices to metres. Throws InputError if a coordinate is not finite or too large.
void scale_and_check(TriangleSoup& soup, double scale, const fs::path& file) {
  for (std::size_t i = 0; i < soup.vertices.size(); ++i) {
    Vec3& vertex = soup.vertices[i];
    vertex *= scale;
    if (!vertex.allFinite())
      fail_in_file(file, fmt::format("vertex {}: is not finite; allowed: finite coordinates", i));
    const double largest = vertex.cwiseAbs().maxCoeff();
    if (largest > kMaxCoordinate) {
      fail_in_file(
          file, fmt::format("vertex {}: got coordinate {} after scaling; allowed: at most {} m (is \"scale\" right?)",
                            i, largest, kMaxCoordinate));
    }
  }
}

/// Connects the triangles to a mesh. Throws InputError if that is impossible.
CheckedMesh connect(const TriangleSoup& soup, const fs::path& file) {
  try {
    return mesh_from_triangles(soup);
  } catch (const MeshError& error) {
    fail_in_file(file, error.what());
  }
}

/// Maximum number of faces after refinement. A closed triangle mesh has about half as many vertices as faces, so
/// that this bounds the number of points.
constexpr double kMaxFaces = 2.0 * kMaxSurfacePoints;

/// Parses the contents of a mesh file and makes all checks.
CheckedMesh read_surface(std::string_view bytes, const fs::path& file, const MeshSampling& sampling) {
  // Parse the triangles.
  const auto* format = std::ranges::find(kMeshFormats, mesh_extension(file), &MeshFormat::extension);
  if (bytes.empty()) fail_in_file(file, "the file is empty; allowed: a mesh with faces");
  TriangleSoup soup = format->read(bytes, file);
  // Check the triangles and scale their vertices.
  check_indices(soup, file);
  scale_and_check(soup, sampling.scale, file);
  // Reverse the winding, and with it the normals.
  if (sampling.flip) {
    for (auto& corners : soup.triangles) std::swap(corners[1], corners[2]);
  }
  // Connect the triangles and check the surface.
  CheckedMesh surface = connect(soup, file);
  if (sampling.flip && surface.findings.open_edges.empty())
    fail_in_file(file, "is closed, so that its outside is known; allowed: flip_normals of an open surface only");
  const std::size_t vertices = surface.mesh.n_vertices();
  if (static_cast<double>(vertices) > kMaxSurfacePoints)
    fail_in_file(file, fmt::format("has {} vertices; allowed: at most {:.0g}", vertices, kMaxSurfacePoints));
  if (vertices_with_normals(surface.mesh).empty())
    fail_in_file(file, "has no faces with an area; allowed: at least one");
  if (sampling.spacing && refined_face_count(surface.mesh, *sampling.spacing, kMaxFaces) > kMaxFaces) {
    fail_in_file(file, fmt::format("spacing_m {} would need more than {:.0g} points; allowed: a wider spacing",
                                   *sampling.spacing, kMaxSurfacePoints));
  }
  return surface;
}

}  // namespace

bool is_mesh_name(const fs::path& file) {
  const std::string extension = lower_case(file.extension().string());
  return std::ranges::find(kMeshFormats, extension, &MeshFormat::extension) != std::end(kMeshFormats);
}

std::string mesh_extension(const fs::path& file) {
  if (!is_mesh_name(file)) fail_in_file(file, "has another extension; allowed: .obj, .ply, .stl or .off");
  return lower_case(file.extension().string());
}

MeshFile::MeshFile(std::string_view bytes, const fs::path& file, const MeshSampling& sampling)
    : sampling_(sampling), surface_(std::make_shared<const CheckedMesh>(read_surface(bytes, file, sampling))) {}

std::vector<std::string> MeshFile::warnings(const fs::path& file) const {
  const MeshFindings& found = surface_->findings;
  std::vector<std::string> warnings;
  const auto warn = [&](const std::string& text) {
    warnings.push_back(one_line(file.filename().string() + ": " + text));
  };
  // Boundary edges, with their bounding box in millimetres.
  if (!found.open_edges.empty()) {
    Box box{found.open_edges[0], found.open_edges[0]};
    for (const Vec3& p : found.open_edges) box = {box.min.cwiseMin(p), box.max.cwiseMax(p)};
    const Vec3 a = 1e3 * box.min, b = 1e3 * box.max;
    warn(fmt::format(
        "the mesh is open: {} boundary edges, within x {:.3g} ... {:.3g}, y {:.3g} ... {:.3g}, z {:.3g} ... {:.3g} mm; "
        "beyond them there is nothing to touch",
        found.open_edges.size(), a.x(), b.x(), a.y(), b.y(), a.z(), b.z()));
  }
  // Edges with more than two faces.
  if (!found.non_manifold_edges.empty()) {
    const Vec3 p = 1e3 * found.non_manifold_edges[0];
    warn(fmt::format(
        "the surface is cut along edges with more than two faces: {}, the first at ({:.3g}, {:.3g}, {:.3g}) mm",
        found.non_manifold_edges.size(), p.x(), p.y(), p.z()));
  }
  // Repairs of faces.
  for (const auto& [count, text] :
       {std::pair{found.degenerate_triangles, "faces left out, two of their corners being the same"},
        {found.flipped_triangles, "faces turned, which were wound against their neighbours"},
        {found.inverted_parts, "closed parts turned, which were inside out"}})
    if (count > 0) warn(fmt::format("{}: {}", text, count));
  return warnings;
}

const std::vector<Vec3>& MeshFile::open_edges() const {
  return surface_->findings.open_edges;
}

bool MeshFile::is_closed() const {
  return surface_->findings.open_edges.empty() && surface_->findings.non_manifold_edges.empty();
}

TriangleSoup MeshFile::triangles() const {
  const HalfEdgeMesh& mesh = surface_->mesh;
  TriangleSoup soup;
  soup.vertices.reserve(mesh.n_vertices());
  soup.triangles.reserve(mesh.n_faces());
  for (const auto vertex : mesh.vertices()) {
    const auto& p = mesh.point(vertex);
    soup.vertices.emplace_back(p[0], p[1], p[2]);
  }
  for (const auto face : mesh.faces()) {
    auto& corners = soup.triangles.emplace_back();
    auto corner = corners.begin();
    for (const auto vertex : face.vertices()) *corner++ = static_cast<std::uint32_t>(vertex.idx());
  }
  return soup;
}

std::vector<SurfacePoint> MeshFile::points() const {
  if (!sampling_.spacing) return vertices_with_normals(surface_->mesh);
  HalfEdgeMesh mesh = surface_->mesh;
  refine(mesh, *sampling_.spacing);
  return thinned(vertices_with_normals(mesh), *sampling_.spacing);
}

}  // namespace hapbench
