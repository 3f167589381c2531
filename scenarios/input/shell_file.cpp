#include "scenarios/input/shell_file.hpp"

#include <fmt/format.h>

#include <OpenMesh/Core/IO/MeshIO.hh>
#include <OpenMesh/Core/Mesh/PolyMesh_ArrayKernelT.hh>
#include <cmath>
#include <sstream>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/number_table.hpp"
#include "scenarios/input/ply_points.hpp"
#include "scenarios/input/size_limits.hpp"

namespace hapbench {
namespace {

constexpr const char* kHeader = "x_m,y_m,z_m,nx,ny,nz";

struct DoubleTraits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
  using Normal = OpenMesh::Vec3d;
};
using Mesh = OpenMesh::PolyMesh_ArrayKernelT<DoubleTraits>;

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& problem) {
  throw InputError(InputError::Kind::relation, file.string(), problem);
}

std::vector<SurfacePoint> read_csv(const std::filesystem::path& file) {
  const NumberTable table = read_number_table(file, kHeader, static_cast<std::size_t>(kMostPoints));
  std::vector<SurfacePoint> points;
  points.reserve(table.rows());
  for (std::size_t i = 0; i < table.rows(); ++i) {
    const auto row = table.row(i);
    points.push_back({{row[0], row[1], row[2]}, {row[3], row[4], row[5]}});
  }
  return points;
}

void check_and_normalise(std::vector<SurfacePoint>& points, const std::filesystem::path& file) {
  if (points.empty()) fail(file, "has no points; allowed: at least one");
  for (std::size_t i = 0; i < points.size(); ++i) {
    SurfacePoint& point = points[i];
    const double largest = point.position.cwiseAbs().maxCoeff();
    if (!(largest <= 1000.0)) {
      fail(file, fmt::format("point {}: got coordinate {}; allowed: finite, at most 1000 m", i, largest));
    }
    const double length = point.normal.norm();
    if (!(std::abs(length - 1.0) <= 1e-3)) {
      fail(file, fmt::format("point {}: got a normal of length {}; allowed: unit normals", i, length));
    }
    // Unit to rounding is left alone, so that an exported shell reads back bit for bit.
    if (std::abs(length - 1.0) > 1e-12) point.normal /= length;
  }
}

std::string csv_text(const std::vector<SurfacePoint>& points) {
  std::string text = std::string(kHeader) + "\n";
  for (const SurfacePoint& p : points) {
    fmt::format_to(std::back_inserter(text), "{},{},{},{},{},{}\n", p.position.x(), p.position.y(), p.position.z(),
                   p.normal.x(), p.normal.y(), p.normal.z());
  }
  return text;
}

std::string ply_text(const std::vector<SurfacePoint>& points) {
  Mesh mesh;
  mesh.request_vertex_normals();
  for (const SurfacePoint& p : points) {
    const auto vertex = mesh.add_vertex({p.position.x(), p.position.y(), p.position.z()});
    mesh.set_normal(vertex, {p.normal.x(), p.normal.y(), p.normal.z()});
  }
  std::ostringstream stream;
  constexpr std::streamsize kFloatDigits = 9;  // all that single precision holds
  OpenMesh::IO::Options options(OpenMesh::IO::Options::VertexNormal);
  if (!OpenMesh::IO::write_mesh(mesh, stream, ".PLY", options, kFloatDigits)) {
    throw std::runtime_error("the mesh library could not write PLY");
  }
  return stream.str();
}

}  // namespace

std::vector<SurfacePoint> read_point_shell(const std::filesystem::path& file) {
  std::vector<SurfacePoint> points;
  if (file.extension() == ".csv") {
    points = read_csv(file);
  } else if (file.extension() == ".ply") {
    points = read_ply_points(file);
  } else {
    fail(file, "has another extension; allowed: .csv or .ply");
  }
  check_and_normalise(points, file);
  return points;
}

std::string point_shell_text(const std::vector<SurfacePoint>& points, const std::filesystem::path& file) {
  if (file.extension() == ".csv") return csv_text(points);
  if (file.extension() == ".ply") return ply_text(points);
  fail(file, "has another extension; allowed: .csv or .ply");
}

}  // namespace hapbench
