#include "algorithms/proxy/edge_constraints.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace hapbench {
namespace {

constexpr std::size_t kSampled = 100;
/// Of the spacing: reaches the middle of four points of a square lattice, 0.707 away.
constexpr double kPatch = 0.75;
/// Of the spacing.
constexpr double kDeepest = 0.1;
/// Cosine to the axis below which a surface runs along the side, so that no edge comes first.
constexpr double kAlongSide = 1e-9;

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

/// The place of the tool that is foremost against `normal`; along the side, the one abreast of `point`.
Vec3 foremost(const Tool& tool, const ToolPose& pose, const Vec3& normal, const Vec3& point) noexcept {
  const double forward = -normal.dot(pose.axis);
  const Vec3 outwards = -normal - forward * pose.axis;
  const double length = outwards.norm();
  if (tool.tip == Tip::round && forward > kAlongSide) return pose.position - tool.radius * normal;
  const Vec3 on_side = length > 0.0 ? Vec3(tool.radius / length * outwards) : Vec3(Vec3::Zero());
  double s = forward > 0.0 ? 0.0 : -tool.length;
  if (std::abs(forward) < kAlongSide) s = std::clamp((point - pose.position).dot(pose.axis), -tool.length, 0.0);
  return pose.position + s * pose.axis + on_side;
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

void add_edge_constraints(const Tool& tool, const ToolPose& pose, double spacing, double margin,
                          ContactBuffer& contacts) noexcept {
  const std::size_t points = contacts.size();
  const double patch2 = kPatch * spacing * kPatch * spacing;
  for (std::size_t i = 0; i < points; ++i) {
    const Vec3 normal = contacts.normal(i);
    const Vec3 from_point = foremost(tool, pose, normal, contacts.point(i)) - contacts.point(i);
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
