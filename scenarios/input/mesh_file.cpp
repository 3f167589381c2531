#include "scenarios/input/mesh_file.hpp"

#include <fmt/format.h>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/mesh_library.hpp"
#include "scenarios/input/mesh_text.hpp"
#include "scenarios/input/size_limits.hpp"
#include "sim/mesh/mesh_from_triangles.hpp"
#include "sim/mesh/resample.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

constexpr double kFarthest = 1000.0;  // [m]

[[noreturn]] void fail(const fs::path& file, const std::string& problem) {
  throw InputError(InputError::Kind::relation, file.string(), problem);
}

void scale_and_check(TriangleSoup& soup, double scale, const fs::path& file) {
  for (std::size_t i = 0; i < soup.vertices.size(); ++i) {
    Vec3& vertex = soup.vertices[i];
    vertex *= scale;
    if (!vertex.allFinite()) fail(file, fmt::format("vertex {}: is not finite; allowed: finite coordinates", i));
    const double largest = vertex.cwiseAbs().maxCoeff();
    if (largest > kFarthest) {
      fail(file, fmt::format("vertex {}: got coordinate {} after scaling; allowed: at most {} m (is \"scale\" right?)",
                             i, largest, kFarthest));
    }
  }
}

CheckedMesh connect(const TriangleSoup& soup, const fs::path& file) {
  try {
    return mesh_from_triangles(soup);
  } catch (const MeshError& error) {
    fail(file, error.what());
  }
}

std::vector<std::string> warnings_about(const MeshFindings& found, const fs::path& file) {
  std::vector<std::string> warnings;
  const auto warn = [&](std::size_t count, const char* text) {
    if (count > 0) warnings.push_back(one_line(file.string() + ": " + fmt::format(fmt::runtime(text), count)));
  };
  warn(found.boundary_edges, "the mesh is open: {} boundary edges");
  warn(found.degenerate_triangles, "faces left out, two of their corners being the same: {}");
  warn(found.rewound_triangles, "faces turned, which were wound against their neighbours: {}");
  warn(found.inside_out_parts, "closed parts turned, which were inside out: {}");
  return warnings;
}

/// Precondition of resampling.
void check_spacing(const HalfEdgeMesh& mesh, double spacing, const fs::path& file) {
  // A triangle mesh has half as many vertices as faces, more only in so far as it is open.
  constexpr double kMostFaces = 2.0 * kMostPoints;
  if (refined_face_count(mesh, spacing, kMostFaces) <= kMostFaces) return;
  fail(file,
       fmt::format("spacing_m {} would need more than {:.0g} points; allowed: a wider spacing", spacing, kMostPoints));
}

/// The surface in the file, all checks done.
CheckedMesh read_surface(const fs::path& file, const MeshSampling& sampling) {
  TriangleSoup soup = read_with_mesh_library(read_mesh_text(file), file);
  scale_and_check(soup, sampling.scale, file);
  CheckedMesh surface = connect(soup, file);
  if (vertices_with_normals(surface.mesh).empty()) fail(file, "has no faces with an area; allowed: at least one");
  if (sampling.spacing) check_spacing(surface.mesh, *sampling.spacing, file);
  return surface;
}

}  // namespace

std::vector<SurfacePoint> read_mesh_points(const fs::path& file, const MeshSampling& sampling) {
  HalfEdgeMesh mesh = read_surface(file, sampling).mesh;
  if (!sampling.spacing) return vertices_with_normals(mesh);
  refine(mesh, *sampling.spacing);
  return thinned(vertices_with_normals(mesh), *sampling.spacing);
}

std::vector<std::string> mesh_warnings(const fs::path& file, const MeshSampling& sampling) {
  return warnings_about(read_surface(file, sampling).findings, file);
}

}  // namespace hapbench
