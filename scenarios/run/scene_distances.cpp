#include "scenarios/run/scene_distances.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <variant>

#include "sim/contact/contact_buffer.hpp"
#include "sim/geometry/triangle_tree.hpp"
#include "sim/tool/mesh_tool.hpp"

namespace hapbench {
namespace {

/// Returns an estimate of the mean distance between neighbouring vertices of a mesh [m]: the square root of the mean
/// surface area per vertex.
double vertex_distance(const TriangleSoup& soup) {
  double area = 0.0;
  for (const auto& [a, b, c] : soup.triangles) {
    const Vec3& corner = soup.vertices[a];
    area += 0.5 * (soup.vertices[b] - corner).cross(soup.vertices[c] - corner).norm();
  }
  return std::sqrt(area / static_cast<double>(soup.vertices.size()));
}

/// Returns the distance of a point from the box of a mesh tool [m]; 0 in the box, and for a tool without a grid.
double distance_from_box(const MeshTool* mesh, const ToolPose& pose, const Vec3& point) {
  if (mesh == nullptr) return 0.0;
  return distance_to(mesh->grid().box(), pose.rotation().transpose() * (point - pose.position));
}

}  // namespace

Gap gap_between(const ToolShape& tool, const ToolPose& pose, const PointShell& shell) {
  constexpr std::size_t kAtOnce = 4096;  // keeps the buffer small, however large the shell
  ContactBuffer points(std::min(kAtOnce, shell.size()));
  Gap gap{std::numeric_limits<double>::infinity()};
  const auto* mesh = dynamic_cast<const MeshTool*>(&tool);
  // Smallest distance of a point outside of the tool's box from this box: no such point is nearer to the tool.
  double outside = std::numeric_limits<double>::infinity();
  bool is_nearest_outside = false;
  for (std::size_t first = 0; first < shell.size(); first += kAtOnce) {
    // Copy a block of points, and compute their depths in the tool.
    points.clear();
    for (std::size_t i = first; i < std::min(first + kAtOnce, shell.size()); ++i) {
      const SurfacePoint point = shell.point(i);
      points.push(static_cast<std::uint32_t>(i), point.position, point.normal);
    }
    tool.surface_constraints(pose, Vec3::Zero(), 0.0, points);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double from_box = distance_from_box(mesh, pose, shell.point(first + i).position);
      if (from_box > 0.0) outside = std::min(outside, from_box);
      if (-points.depth[i] < gap.distance) {
        gap.distance = -points.depth[i];
        is_nearest_outside = from_box > 0.0;
      }
      if (points.depth[i] >= 0.0) ++gap.touching;
    }
  }
  gap.is_estimate = is_nearest_outside || outside < gap.distance;
  return gap;
}

std::optional<PointDistance> point_distance(const LoadedScenario& loaded) {
  const Environment& environment = loaded.scenario.environment;
  constexpr const char* kSpacing = "environment.spacing_m";
  if (const auto* block = std::get_if<BlockEnvironment>(&environment))
    return PointDistance{"environment.grid_m", block->grid};
  const auto* mesh = std::get_if<MeshEnvironment>(&environment);
  if (mesh != nullptr && !mesh->spacing) {
    const double distance = vertex_distance(loaded.files.at(kEnvironmentFile).mesh().triangles());
    return PointDistance{kSpacing, distance, false};
  }
  return std::visit(
      [](const auto& shape) -> std::optional<PointDistance> {
        if constexpr (requires { shape.spacing; })
          return PointDistance{kSpacing, std::optional<double>(shape.spacing).value()};
        return std::nullopt;
      },
      environment);
}

}  // namespace hapbench
