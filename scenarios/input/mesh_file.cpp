#include "scenarios/input/mesh_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/mesh_faces.hpp"
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
  MeshFaces (*read)(std::string_view text, const fs::path& file);
};
constexpr MeshFormat kMeshFormats[] = {{".obj", read_obj}, {".ply", read_ply}, {".stl", read_stl}, {".off", read_off}};

/// Converts the vertices to metres. Throws InputError if a coordinate is not finite or too large.
void scale_and_check(MeshFaces& faces, double scale, const fs::path& file) {
  for (std::size_t i = 0; i < faces.vertices.size(); ++i) {
    Vec3& vertex = faces.vertices[i];
    vertex *= scale;
    if (!vertex.allFinite()) faces.fail_at_vertex(i, "is not finite; allowed: finite coordinates", file);
    const double largest = vertex.cwiseAbs().maxCoeff();
    if (largest > kMaxCoordinate) {
      const std::string problem = fmt::format(
          "got coordinate {} after scaling; allowed: at most {} m (is \"scale\" right?)", largest, kMaxCoordinate);
      faces.fail_at_vertex(i, problem, file);
    }
  }
}

/// Connects the triangles to a mesh. Throws InputError if that is impossible.
CheckedMesh connect(const TriangleSoup& soup, const fs::path& file, bool flip_open) {
  try {
    return mesh_from_triangles(soup, flip_open);
  } catch (const MeshError& error) {
    fail_in_file(file, error.what());
  }
}

/// Maximum number of faces after refinement. It limits the number of points to about kMaxSurfacePoints, because a
/// closed triangle mesh has about half as many vertices as faces.
constexpr double kMaxFaces = 2.0 * kMaxSurfacePoints;

/// Throws InputError for an open mesh whose file ends within the line of the last face, if this face has fewer corners
/// than every other face.
void refuse_cut_face(const MeshFaces& faces, const MeshFindings& found, const fs::path& file) {
  if (faces.unfinished_line == 0 || faces.ends.size() < 2 || found.open_edges.empty()) return;
  const std::size_t last = faces.ends.size() - 1, corners = faces.face(last).size();
  for (std::size_t f = 0; f < last; ++f)
    if (faces.face(f).size() <= corners) return;
  fail_in_line(
      file, faces.unfinished_line,
      fmt::format("the file is cut short: it ends within this line, whose face has {} corners, fewer than all "
                  "other faces, and the mesh is open; allowed: a complete file, with a line end after the last face",
                  corners));
}

/// Throws InputError if no point shell can be made from the surface.
void check_surface(const CheckedMesh& surface, const MeshSampling& sampling, const fs::path& file) {
  if (sampling.flip && surface.findings.open_component_count == 0)
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
}

/// Adds a warning about vertices that no face uses. `vertices`: the number of the file's vertices.
void warn_of_unused_vertices(MeshFaces& faces, std::size_t vertices, bool is_open) {
  std::vector<bool> is_used(vertices, false);
  for (const std::uint32_t corner : faces.corners) is_used[corner] = true;
  const auto unused = std::ranges::count(is_used, false);
  if (unused == 0) return;
  const auto first = static_cast<std::size_t>(std::ranges::find(is_used, false) - is_used.begin());
  const std::string line =
      first < faces.vertex_lines.size() ? fmt::format(" in line {}", faces.vertex_lines[first]) : "";
  // An OBJ file declares no number of faces, so that a file that was cut short is not detected earlier.
  const bool may_be_cut = is_open && faces.first_vertex == 1;
  faces.warnings.push_back(fmt::format("vertices that no face uses, which were ignored: {}, the first is vertex {}{}{}",
                                       unused, first + faces.first_vertex, line,
                                       may_be_cut ? "; the mesh is open: is the file cut short?" : ""));
}

/// Parses and checks the contents of a mesh file. Stores in `warnings` what the reader ignored or guessed. Throws
/// InputError.
CheckedMesh read_surface(std::string_view bytes, const fs::path& file, const MeshSampling& sampling,
                         std::vector<std::string>& warnings) {
  // Parse the faces.
  const auto* format = std::ranges::find(kMeshFormats, mesh_extension(file), &MeshFormat::extension);
  if (bytes.empty()) fail_in_file(file, "the file is empty; allowed: a mesh with faces");
  MeshFaces faces = format->read(bytes, file);
  // Check and scale the faces, and divide them into triangles.
  check_indices(faces, file);
  scale_and_check(faces, sampling.scale, file);
  TriangleSoup soup;
  soup.triangles = triangles_of(faces, file);
  soup.vertices = std::move(faces.vertices);
  // Connect the triangles and check the surface.
  CheckedMesh surface = connect(soup, file, sampling.flip);
  refuse_cut_face(faces, surface.findings, file);
  check_surface(surface, sampling, file);
  warn_of_unused_vertices(faces, soup.vertices.size(), !surface.findings.open_edges.empty());
  warnings = std::move(faces.warnings);
  if (faces.unfinished_line > 0 && !surface.findings.open_edges.empty()) {
    warnings.push_back(
        fmt::format("the mesh is open, and line {}, the last line, has no line end: is the file cut short?",
                    faces.unfinished_line));
  }
  return surface;
}

/// Returns the size and the position of a component, as a message shows them.
std::string component_text(const MeshComponent& component) {
  const Vec3 size = 1e3 * component.box.size(), middle = 5e2 * (component.box.min + component.box.max);
  return fmt::format("{} triangles, {:.3g} x {:.3g} x {:.3g} mm at ({:.3g}, {:.3g}, {:.3g}) mm", component.triangles,
                     size.x(), size.y(), size.z(), middle.x(), middle.y(), middle.z());
}

/// Warns about components that are much smaller than the largest component.
template <class Warn>
void warn_of_specks(const MeshFindings& found, const Warn& warn) {
  const std::size_t large = components_above_speck_size(found);
  if (large == found.component_count) return;
  warn(
      fmt::format("specks, which are components smaller than {:.0f} % of the largest: {} of {} components, the largest "
                  "of them {}; remove specks in a mesh editor",
                  100.0 * kSpeckSize, found.component_count - large, found.component_count,
                  component_text(found.components[large])));
}

/// Warns about triangles that were listed several times.
template <class Warn>
void warn_of_copies(const MeshFindings& found, const Warn& warn) {
  if (found.is_double_sided) {
    warn(fmt::format("{}: each triangle is listed with both windings, and only the first copy was kept{}: {} triangles",
                     found.open_edges.empty() ? "every face is double" : "a double-sided sheet",
                     found.open_edges.empty() ? "" : ", so that one side remains (flip_normals selects the other side)",
                     found.opposite_triangles));
  } else if (found.opposite_triangles > 0) {
    warn(fmt::format("faces left out because they repeat an earlier face with opposite winding: {}",
                     found.opposite_triangles));
  }
  if (found.repeated_triangles > 0)
    warn(fmt::format("faces left out because they repeat an earlier face: {}", found.repeated_triangles));
}

/// Warns about closed components that enclose no volume. Their two sides have no triangle in common, because the file
/// divides the sides into triangles in different ways.
template <class Warn>
void warn_of_flat_components(const MeshFindings& found, const Warn& warn) {
  const auto count = std::ranges::count(found.components, true, &MeshComponent::is_flat);
  if (count == 0) return;
  const auto first = std::ranges::find(found.components, true, &MeshComponent::is_flat);
  warn(
      fmt::format("double-sided sheets, which are closed components without volume: {}, the largest {}; both sides "
                  "remain and push against each other: remove one side in a mesh editor",
                  count, component_text(*first)));
}

/// Returns about how many boundary edges lie within a few times `distance` [m] of another boundary edge, by their
/// midpoints: those whose midpoints are in the same cell of one of two grids with cells of twice the distance.
std::size_t paired_edges(const std::vector<Vec3>& midpoints, double distance) {
  std::vector<bool> is_paired(midpoints.size(), false);
  for (const double shift : {0.0, 0.5}) {
    std::map<std::array<double, 3>, std::size_t> first_in_cell;
    for (std::size_t i = 0; i < midpoints.size(); ++i) {
      const Vec3 cell = (midpoints[i] / (2.0 * distance) + Vec3::Constant(shift)).array().floor();
      const auto [entry, is_new] = first_in_cell.try_emplace({cell.x(), cell.y(), cell.z()}, i);
      if (!is_new) is_paired[i] = is_paired[entry->second] = true;
    }
  }
  return static_cast<std::size_t>(std::ranges::count(is_paired, true));
}

/// Returns the diameter of the box around the described components [m].
double largest_diameter(const MeshFindings& found) {
  Box box = Box::nothing();
  for (const MeshComponent& component : found.components) {
    box.add(component.box.min);
    box.add(component.box.max);
  }
  return box.size().norm();
}

/// Returns a clause about boundary edges that lie on each other except for the last digits of their vertices; empty if
/// few edges do. `size`: size of the surface [m].
std::string rounding_gaps_text(const std::vector<Vec3>& open_edges, double size) {
  constexpr double kRounding = 1e-6, kFew = 0.1;  // relative to `size`; fraction of the edges
  const std::size_t paired = paired_edges(open_edges, kRounding * size);
  if (static_cast<double>(paired) <= kFew * static_cast<double>(open_edges.size())) return "";
  return fmt::format(
      "; {} of these edges lie within about {:.2g} mm of another: their vertices differ only in the last digits and "
      "are not joined: merge such vertices in a mesh editor",
      paired, 1e3 * kRounding * size);
}

}  // namespace

std::size_t components_above_speck_size(const MeshFindings& found) {
  if (!found.non_manifold_edges.empty()) return found.component_count;
  const auto is_speck = [&found](const MeshComponent& component) {
    return component.diameter() <= kSpeckSize * found.components.front().diameter();
  };
  const auto first = std::ranges::find_if(found.components, is_speck);
  return first == found.components.end() ? found.component_count
                                         : static_cast<std::size_t>(first - found.components.begin());
}

bool is_mesh_name(const fs::path& file) {
  const std::string extension = lower_case(file.extension().string());
  return std::ranges::find(kMeshFormats, extension, &MeshFormat::extension) != std::end(kMeshFormats);
}

std::string mesh_extension(const fs::path& file) {
  if (!is_mesh_name(file)) fail_in_file(file, "has another extension; allowed: .obj, .ply, .stl or .off");
  return lower_case(file.extension().string());
}

MeshFile::MeshFile(std::string_view bytes, const fs::path& file, const MeshSampling& sampling)
    : sampling_(sampling),
      surface_(std::make_shared<const CheckedMesh>(read_surface(bytes, file, sampling, file_warnings_))) {}

std::vector<std::string> MeshFile::warnings(const fs::path& file) const {
  const MeshFindings& found = surface_->findings;
  std::vector<std::string> warnings;
  const auto warn = [&](const std::string& text) {
    warnings.push_back(one_line(file.filename().string() + ": " + text));
  };
  for (const std::string& text : file_warnings_) warn(text);
  warn_of_copies(found, warn);
  // Warn about boundary edges, with their bounding box in millimetres.
  if (!found.open_edges.empty()) {
    Box box{found.open_edges[0], found.open_edges[0]};
    for (const Vec3& p : found.open_edges) box = {box.min.cwiseMin(p), box.max.cwiseMax(p)};
    const Vec3 a = 1e3 * box.min, b = 1e3 * box.max;
    warn(fmt::format(
        "the mesh is open: {} boundary edges, within x {:.3g} ... {:.3g}, y {:.3g} ... {:.3g}, z {:.3g} ... {:.3g} mm; "
        "the surface ends there{}",
        found.open_edges.size(), a.x(), b.x(), a.y(), b.y(), a.z(), b.z(),
        rounding_gaps_text(found.open_edges, largest_diameter(found))));
  }
  // Warn about edges with more than two faces.
  if (!found.non_manifold_edges.empty()) {
    const Vec3 p = 1e3 * found.non_manifold_edges[0];
    warn(fmt::format(
        "the surface is cut along edges with more than two faces: {}, the first at ({:.3g}, {:.3g}, {:.3g}) mm",
        found.non_manifold_edges.size(), p.x(), p.y(), p.z()));
  }
  // Warn about repaired faces.
  for (const auto& [count, text] :
       {std::pair{found.degenerate_triangles, "faces left out because two of their corners are equal"},
        {found.flipped_triangles, "faces reversed because they were wound against most faces of their component"},
        {found.inverted_parts, "closed components reversed because their normals pointed to the wrong side"}})
    if (count > 0) warn(fmt::format("{}: {}", text, count));
  warn_of_flat_components(found, warn);
  warn_of_specks(found, warn);
  return warnings;
}

const MeshFindings& MeshFile::findings() const {
  return surface_->findings;
}

MeshFile MeshFile::largest_component() const {
  if (surface_->findings.component_count < 2) return *this;
  const TriangleSoup largest = hapbench::largest_component(surface_->mesh);
  return MeshFile(std::make_shared<const CheckedMesh>(mesh_from_triangles(largest)), sampling_);
}

const std::vector<Vec3>& MeshFile::open_edges() const {
  return surface_->findings.open_edges;
}

bool MeshFile::is_closed() const {
  return surface_->findings.open_edges.empty() && surface_->findings.non_manifold_edges.empty();
}

bool MeshFile::knows_outside() const {
  return surface_->findings.open_component_count == 0;
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
  return subsampled(vertices_with_normals(mesh), *sampling_.spacing);
}

}  // namespace hapbench
