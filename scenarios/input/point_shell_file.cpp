#include "scenarios/input/point_shell_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <iterator>
#include <numeric>
#include <tuple>
#include <utility>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/number_table.hpp"
#include "scenarios/input/read_ply.hpp"
#include "scenarios/input/size_limits.hpp"
#include "scenarios/input/text_lines.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

constexpr const char* kCsvHeader = "x_m,y_m,z_m,nx,ny,nz";

/// Columns of a point shell in the order of kCsvHeader.
const std::vector<TableQuantity> kColumns = {{.alternatives = {{"x_m", "y_m", "z_m"}}},
                                             {.alternatives = {{"nx", "ny", "nz"}}}};

/// Points of a file, with the line of each point.
struct ReadPoints {
  std::vector<SurfacePoint> points;
  std::function<std::size_t(std::size_t)> line_of = {};  ///< returns the line of a point; null if lines are unknown
};

ReadPoints parse_csv_points(std::string_view text, const fs::path& file, std::vector<std::string>* notes) {
  NumberTable table = parse_number_table(text, file, kColumns, static_cast<std::size_t>(kMaxSurfacePoints));
  if (notes != nullptr) *notes = table.notes;
  std::vector<SurfacePoint> points;
  points.reserve(table.rows());
  for (std::size_t i = 0; i < table.rows(); ++i) {
    const auto row = table.row(i);
    points.push_back({{row[0], row[1], row[2]}, {row[3], row[4], row[5]}});
  }
  return {std::move(points), [table = std::move(table)](std::size_t i) { return table.line_of(i); }};
}

/// Checks the points and normalises their normals. If a point is invalid, throws InputError that names the file and the
/// point.
void check_and_normalise(ReadPoints& read, const fs::path& file) {
  std::vector<SurfacePoint>& points = read.points;
  if (points.empty()) fail_in_file(file, "has no points; allowed: at least one");
  if (static_cast<double>(points.size()) > kMaxSurfacePoints)
    fail_in_file(file, fmt::format("has {} points; allowed: at most {:.0g}", points.size(), kMaxSurfacePoints));
  RowFaults faults;
  for (std::size_t i = 0; i < points.size(); ++i) {
    SurfacePoint& point = points[i];
    const auto refuse = [&](const std::string& problem) {
      faults.add(read.line_of ? read.line_of(i) : 0, problem, fmt::format("point {}", i));
    };
    const double largest = point.position.cwiseAbs().maxCoeff();
    if (!point.position.allFinite() || largest > kMaxCoordinate)
      refuse(fmt::format("got coordinate {}; allowed: finite, at most 1000 m", largest));
    const double length = point.normal.norm();
    if (largest <= kMaxCoordinate && !(std::abs(length - 1.0) <= 1e-3))
      refuse(fmt::format("got a normal of length {}; allowed: unit normals", length));
    // A normal whose length is 1 up to rounding is not changed, so that an exported shell is read back exactly.
    if (std::abs(length - 1.0) > 1e-12) point.normal /= length;
  }
  faults.throw_if_any(file);
}

/// Returns a warning about points with the position and the normal of an earlier point; empty if there are none.
std::string warning_of_copies(const ReadPoints& read) {
  // Sort the points, so that copies follow each other in the order of the file.
  const std::vector<SurfacePoint>& points = read.points;
  std::vector<std::uint32_t> order(points.size());
  std::iota(order.begin(), order.end(), 0U);
  const auto key = [&points](std::uint32_t i) {
    const auto& [p, n] = points[i];
    return std::tuple(p.x(), p.y(), p.z(), n.x(), n.y(), n.z());
  };
  std::ranges::stable_sort(order, {}, key);
  // Count the copies and find the first in the file.
  std::size_t copies = 0, first = points.size();
  for (std::size_t i = 1; i < order.size(); ++i) {
    if (key(order[i]) != key(order[i - 1])) continue;
    ++copies;
    first = std::min<std::size_t>(first, order[i]);
  }
  if (copies == 0) return "";
  const std::string line = read.line_of ? fmt::format(" in line {}", read.line_of(first)) : "";
  return fmt::format(
      "points that repeat the position and the normal of an earlier point: {}, the first is point {}{}; each of them "
      "counts as a point of its own, also in the force",
      copies, first, line);
}

std::string csv_text(const std::vector<SurfacePoint>& points) {
  std::string text = fmt::format("{}\n", kCsvHeader);
  for (const SurfacePoint& p : points) {
    fmt::format_to(std::back_inserter(text), "{},{}\n", fmt::join(p.position, ","), fmt::join(p.normal, ","));
  }
  return text;
}

std::string ply_text(const std::vector<SurfacePoint>& points) {
  std::string text = fmt::format(
      "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
      "property float nx\nproperty float ny\nproperty float nz\nelement face 0\n"
      "property list uchar int vertex_indices\nend_header\n",
      points.size());
  for (const SurfacePoint& p : points) {
    const Eigen::Vector3f position = p.position.cast<float>(), normal = p.normal.cast<float>();
    // Nine significant digits represent a number in single precision exactly.
    fmt::format_to(std::back_inserter(text), "{:.9g} {:.9g}\n", fmt::join(position, " "), fmt::join(normal, " "));
  }
  return text;
}

}  // namespace

std::string shell_extension(const std::filesystem::path& file) {
  const std::string extension = lower_case(file.extension().string());
  if (extension != ".csv" && extension != ".ply") fail_in_file(file, "has another extension; allowed: .csv or .ply");
  return extension;
}

std::vector<SurfacePoint> parse_point_shell(std::string_view text, const std::filesystem::path& file,
                                            std::vector<std::string>* notes) {
  ReadPoints read = shell_extension(file) == ".csv" ? parse_csv_points(text, file, notes)
                                                    : ReadPoints{parse_ply_points(text, file, notes)};
  check_and_normalise(read, file);
  if (notes != nullptr)
    if (std::string copies = warning_of_copies(read); !copies.empty()) notes->push_back(std::move(copies));
  return std::move(read.points);
}

std::string format_point_shell(const std::vector<SurfacePoint>& points, const std::filesystem::path& file) {
  return shell_extension(file) == ".csv" ? csv_text(points) : ply_text(points);
}

}  // namespace hapbench
