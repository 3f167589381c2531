#include "algorithms/proxy/edge_constraints.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace hapbench {
namespace {

constexpr std::size_t kSampled = 100;
/// Radius of a patch as a share of the spacing: reaches the centre of four points of a square lattice, 0.707 away.
constexpr double kPatch = 0.75;
/// Largest depth at which an edge constraint applies, as a share of the spacing.
constexpr double kDeepest = 0.1;

double distance_to_second(const PointShell& shell, std::size_t from) {
  double first = std::numeric_limits<double>::infinity(), second = first;
  const Vec3 here = shell.point(from).position;
  for (std::size_t i = 0; i < shell.size(); ++i) {
    if (i == from) continue;
    const double dx = shell.x()[i] - here.x(), dy = shell.y()[i] - here.y(), dz = shell.z()[i] - here.z();
    const double distance2 = dx * dx + dy * dy + dz * dz;
    if (distance2 >= second) continue;
    second = std::max(first, distance2);
    first = std::min(first, distance2);
  }
  return std::sqrt(second);
}

}  // namespace

double typical_spacing(const PointShell& shell) {
  if (shell.size() < 3) return 0.0;
  const std::size_t samples = std::min(kSampled, shell.size());
  std::vector<double> distances;
  for (std::size_t k = 0; k < samples; ++k) distances.push_back(distance_to_second(shell, k * shell.size() / samples));
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(samples / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  return *middle;
}

void add_edge_constraints(const ToolShape& tool, const ToolPose& pose, double spacing, double margin,
                          std::vector<Vec3>& places, ContactBuffer& contacts) noexcept {
  const std::size_t points = contacts.size();
  const double patch2 = kPatch * spacing * kPatch * spacing;
  tool.foremost_places(pose, contacts, places.data());
  for (std::size_t i = 0; i < points; ++i) {
    const Vec3 normal = contacts.normal(i);
    const Vec3 from_point = places[i] - contacts.point(i);
    const double height = normal.dot(from_point);
    if (height > margin || height < -kDeepest * spacing) continue;
    if (from_point.squaredNorm() - height * height > patch2) continue;
    contacts.push_copy_of(contacts, i);
    contacts.depth[contacts.size() - 1] = -height;
    contacts.set_gradient(contacts.size() - 1, -normal);
  }
  contacts.pad();
}

}  // namespace hapbench
