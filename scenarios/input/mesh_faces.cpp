#include "scenarios/input/mesh_faces.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "scenarios/input/input_error.hpp"
#include "sim/mesh/polygon.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

/// Unevenness above which a warning reports that a polygon is not planar.
constexpr double kReportedUnevenness = 0.05;

/// Throws InputError that names the file and, if lines are known, the line of an entry.
[[noreturn]] void fail_in_entry(const std::vector<std::uint32_t>& lines, std::size_t entry, const std::string& problem,
                                const fs::path& file) {
  if (entry < lines.size()) fail_in_line(file, lines[entry], problem);
  fail_in_file(file, problem);
}

/// Returns the text by which a warning names a face: its line, or its number in a binary file.
std::string place_of_face(const MeshFaces& faces, std::size_t f) {
  return f < faces.face_lines.size() ? fmt::format("in line {}", faces.face_lines[f])
                                     : fmt::format("{} {}", faces.face_name, f);
}

/// Polygons with a property that a warning reports.
struct Reported {
  std::size_t count = 0, first = 0;
  double largest = 0.0;

  void add(std::size_t face, double value) {
    if (count++ == 0) first = face;
    largest = std::max(largest, value);
  }
};

}  // namespace

void MeshFaces::fail_at_vertex(std::size_t vertex, const std::string& problem, const fs::path& file) const {
  fail_in_entry(vertex_lines, vertex, fmt::format("vertex {}: {}", vertex + first_vertex, problem), file);
}

void MeshFaces::fail_at_face(std::size_t f, const std::string& problem, const fs::path& file) const {
  fail_in_entry(face_lines, f, fmt::format("{} {}: {}", face_name, f + first_vertex, problem), file);
}

void check_indices(const MeshFaces& faces, const fs::path& file) {
  const std::size_t vertices = faces.vertices.size();
  const auto wrong = std::ranges::find_if(faces.corners, [vertices](std::uint32_t v) { return v >= vertices; });
  if (wrong == faces.corners.end()) return;
  const auto corner = static_cast<std::uint32_t>(wrong - faces.corners.begin());
  const auto face = static_cast<std::size_t>(std::ranges::upper_bound(faces.ends, corner) - faces.ends.begin());
  const std::int64_t first = faces.first_vertex, last = first + static_cast<std::int64_t>(vertices) - 1;
  // A negative number of a binary file was converted to a large index.
  const auto number = first + static_cast<std::int32_t>(*wrong);
  const std::string allowed = vertices == 0 ? "vertices of the file, which has none"
                                            : fmt::format("{} ... {}, the vertices of the file", first, last);
  // Only OBJ does not declare its number of vertices.
  const bool may_be_cut = first == 1 && number > last;
  faces.fail_at_face(
      face, fmt::format("got vertex {}; allowed: {}{}", number, allowed, may_be_cut ? " (is the file cut short?)" : ""),
      file);
}

std::vector<TriangleCorners> triangles_of(MeshFaces& faces, const fs::path& file) {
  std::vector<TriangleCorners> triangles;
  triangles.reserve(faces.corners.size() - 2 * faces.ends.size());
  PolygonDivider divider;
  std::vector<Vec3> polygon;
  Reported uneven, repeated;
  for (std::size_t f = 0; f < faces.ends.size(); ++f) {
    const auto corners = faces.face(f);
    if (corners.size() == 3) {
      triangles.push_back({corners[0], corners[1], corners[2]});
      continue;
    }
    polygon.clear();
    for (const std::uint32_t corner : corners) polygon.push_back(faces.vertices[corner]);
    try {
      const DividedPolygon& divided = divider.divide(polygon);
      for (const auto& [a, b, c] : divided.triangles) triangles.push_back({corners[a], corners[b], corners[c]});
      if (divided.unevenness > kReportedUnevenness) uneven.add(f, divided.unevenness);
      if (divided.repeated_corners > 0) repeated.add(f, static_cast<double>(divided.repeated_corners));
    } catch (const PolygonError& error) {
      faces.fail_at_face(f, error.what(), file);
    }
  }
  if (uneven.count > 0) {
    faces.warnings.push_back(fmt::format(
        "polygons that are not planar: {}, the first {}; the largest is off its plane by {:.2g} % of its diameter; "
        "their triangles are one of several choices",
        uneven.count, place_of_face(faces, uneven.first), 100.0 * uneven.largest));
  }
  if (repeated.count > 0) {
    faces.warnings.push_back(fmt::format("polygons with repeated corners, which were left out: {}, the first {}",
                                         repeated.count, place_of_face(faces, repeated.first)));
  }
  return triangles;
}

}  // namespace hapbench
