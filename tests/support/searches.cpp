#include "tests/support/searches.hpp"

#include <cmath>

namespace hapbench::test {

bool same_contacts(const ContactBuffer& a, const ContactBuffer& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (a.index[i] != b.index[i] || a.point(i) != b.point(i) || a.normal(i) != b.normal(i)) return false;
  }
  return true;
}

std::vector<SurfacePoint> random_shell(Random& random, double size) {
  const std::size_t n = 1 + random.below(400);
  const std::uint64_t kind = random.below(4);
  std::vector<SurfacePoint> points(n);
  for (SurfacePoint& point : points) {
    const double x = random.uniform(-size, size), y = random.uniform(-size, size), z = random.uniform(-size, size);
    if (kind == 0) point.position = {x, y, 0.05 * z};
    if (kind == 1) point.position = {x, y, z};
    if (kind == 2)
      point.position = size / 8.0 * Vec3(std::round(8 * x / size), std::round(8 * y / size), std::round(8 * z / size));
    if (kind == 3) point.position = {x, 0.0, 0.0};
    point.normal = random.direction();
  }
  return points;
}

ToolPose next_pose(const ToolPose& pose, Random& random, double size, double step) {
  ToolPose next = pose;
  const double choice = random.uniform();
  if (choice < 0.05) return next;
  if (choice < 0.10)
    return {size * Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)), random.direction()};
  if (choice < 0.12) return {1e3 * size * random.direction(), random.direction()};
  if (choice < 0.14)
    return {size / 8.0 * Vec3(std::round(random.uniform(-8, 8)), std::round(random.uniform(-8, 8)), 0.0), {0, 0, -1}};
  if (choice < 0.70) next.position += step * random.uniform() * random.direction();
  if (choice > 0.50) next.axis = (next.axis + 0.02 * random.uniform() * random.direction()).normalized();
  return next;
}

}  // namespace hapbench::test
