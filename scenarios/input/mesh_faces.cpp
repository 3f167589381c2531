#include "scenarios/input/mesh_faces.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "scenarios/input/input_error.hpp"
#include "sim/mesh/polygon.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

/// A warning reports polygons whose unevenness is above this value. Unevenness: largest distance of a corner from the
/// plane of the polygon, divided by the diameter of the polygon.
constexpr double kReportedUnevenness = 0.05;

/// Throws InputError that names the file and, if lines are known, the line of an entry.
[[noreturn]] void fail_in_entry(const std::vector<std::uint32_t>& lines, std::size_t entry, const std::string& problem,
                                const fs::path& file) {
  if (entry < lines.size()) fail_in_line(file, lines[entry], problem);
  fail_in_file(file, problem);
}

/// Returns the text by which a warning names a face: the line of the face, or the number of the face in a binary file.
std::string place_of_face(const MeshFaces& faces, std::size_t f) {
  return f < faces.face_lines.size() ? fmt::format("in line {}", faces.face_lines[f])
                                     : fmt::format("{} {}", faces.face_name, f);
}

/// Counts the polygons with a property that a warning reports. Keeps the number of the first polygon, and the largest
/// value of the property, such as the largest unevenness.
struct Reported {
  std::size_t count = 0, first = 0;
  double largest = 0.0;

  void add(std::size_t face, double value) {
    if (count++ == 0) first = face;
    largest = std::max(largest, value);
  }
};

/// Returns 1 if two faces have the same corners in the same cyclic order, -1 if one is the reverse of the other, and 0
/// otherwise.
int winding_between(std::span<const std::uint32_t> a, std::span<const std::uint32_t> b) {
  const std::size_t n = a.size();
  if (b.size() != n) return 0;
  for (std::size_t start = 0; start < n; ++start) {
    bool is_same = true, is_reverse = true;
    for (std::size_t k = 0; k < n && (is_same || is_reverse); ++k) {
      is_same = is_same && a[k] == b[(start + k) % n];
      is_reverse = is_reverse && a[k] == b[(start + n - k) % n];
    }
    if (is_same || is_reverse) return is_same ? 1 : -1;
  }
  return 0;
}

/// Finds polygons with the same corners as an earlier polygon. Divides both polygons into the same triangles, so that
/// mesh_from_triangles() recognises the copy.
class RepeatedPolygons {
 public:
  explicit RepeatedPolygons(const MeshFaces& faces) : faces_(faces) {
    // Only faces whose hash occurs twice may be copies.
    for (std::size_t f = 0; f < faces.ends.size(); ++f)
      if (faces.face(f).size() > 3) hashes_.push_back(hash_of(f));
    std::ranges::sort(hashes_);
    std::vector<std::uint64_t> repeated;
    for (std::size_t i = 1; i < hashes_.size(); ++i)
      if (hashes_[i] == hashes_[i - 1]) repeated.push_back(hashes_[i]);
    hashes_ = std::move(repeated);
  }

  /// If an earlier polygon has the same corners as polygon `f`, appends the triangles of the earlier polygon, wound as
  /// polygon `f`, and returns true.
  bool append_copy(std::size_t f, std::vector<TriangleCorners>& triangles) {
    if (hashes_.empty()) return false;
    const std::uint64_t hash = hash_of(f);
    if (!std::ranges::binary_search(hashes_, hash)) return false;
    for (const auto& [face, begin, end] : earlier_[hash]) {
      const int winding = winding_between(faces_.face(face), faces_.face(f));
      for (std::size_t t = begin; t < end && winding != 0; ++t) {
        const auto [a, b, c] = triangles[t];
        triangles.push_back(winding > 0 ? TriangleCorners{a, b, c} : TriangleCorners{a, c, b});
      }
      if (winding != 0) return true;
    }
    return false;
  }
  /// Stores the index range [begin, end) of the triangles of polygon `f`.
  void add(std::size_t f, std::size_t begin, std::size_t end) {
    if (hashes_.empty()) return;
    const std::uint64_t hash = hash_of(f);
    if (std::ranges::binary_search(hashes_, hash)) earlier_[hash].push_back({f, begin, end});
  }

 private:
  struct Divided {
    std::size_t face, begin, end;  ///< the face, and the range of its triangles
  };
  /// Returns a hash of the corners that does not depend on their order.
  std::uint64_t hash_of(std::size_t f) const {
    std::uint64_t sum = 0;
    for (const std::uint64_t corner : faces_.face(f)) {
      const std::uint64_t mixed = (corner + 1) * 0x9E3779B97F4A7C15U;
      sum += mixed ^ (mixed >> 29U);
    }
    return sum;
  }

  const MeshFaces& faces_;
  std::vector<std::uint64_t> hashes_;  ///< hashes that two or more polygons have, sorted
  std::map<std::uint64_t, std::vector<Divided>> earlier_;
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
  // An OBJ file, whose first vertex has the number 1, does not declare its number of vertices. Therefore an OBJ file
  // that was cut short is not detected earlier.
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
  RepeatedPolygons copies(faces);
  Reported uneven, repeated;
  for (std::size_t f = 0; f < faces.ends.size(); ++f) {
    const auto corners = faces.face(f);
    if (corners.size() == 3) {
      triangles.push_back({corners[0], corners[1], corners[2]});
      continue;
    }
    if (copies.append_copy(f, triangles)) continue;
    const std::size_t begin = triangles.size();
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
    copies.add(f, begin, triangles.size());
  }
  if (uneven.count > 0) {
    faces.warnings.push_back(fmt::format(
        "polygons that are not planar: {}, the first {}; the largest is off its plane by {:.2g} % of its diameter; "
        "other divisions into triangles are possible",
        uneven.count, place_of_face(faces, uneven.first), 100.0 * uneven.largest));
  }
  if (repeated.count > 0) {
    faces.warnings.push_back(fmt::format("polygons whose repeated corners were left out: {}, the first {}",
                                         repeated.count, place_of_face(faces, repeated.first)));
  }
  return triangles;
}

}  // namespace hapbench
