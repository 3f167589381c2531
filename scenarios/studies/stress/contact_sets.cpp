#include "scenarios/studies/stress/contact_sets.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "algorithms/registry.hpp"

namespace hapbench {
namespace {

/// A number whose logarithm is uniform.
double log_uniform(Random& random, double low, double high) {
  return low * std::pow(high / low, random.uniform());
}

bool chance(Random& random, double probability) {
  return random.uniform() < probability;
}

/// A unit vector that differs from u by 1e-16 (rounding) … 1.
Vec3 nearly(Random& random, const Vec3& u) {
  return (u + log_uniform(random, 1e-16, 1.0) * random.direction()).normalized();
}

Vec3 sign_of(Random& random, const Vec3& u) {
  return chance(random, 0.5) ? u : Vec3(-u);
}

/// Two unit vectors that make a right-handed frame with the axis.
std::array<Vec3, 2> across(const Vec3& axis) {
  const Vec3 first = axis.unitOrthogonal();
  return {first, axis.cross(first)};
}

/// A point at radius and height along the axis, in a random direction.
Vec3 at(Random& random, const ContactSet& set, double radius, double height) {
  const auto [e, f] = across(set.pose.axis);
  const Vec3 d = random.direction_in_plane();
  return set.pose.position + height * set.pose.axis + radius * (d.x() * e + d.y() * f);
}

Vec3 in_tool(Random& random, const ContactSet& set) {
  const double radius = set.tool.radius() * std::sqrt(random.uniform());
  return at(random, set, radius, -set.tool.length() * random.uniform());
}

using Points = std::vector<SurfacePoint>;

/// n points from a position and a normal each.
template <class Position, class Normal>
Points fill(std::size_t n, Position position, Normal normal) {
  Points points(n);
  for (SurfacePoint& point : points) point = {position(), normal()};
  return points;
}

Points random_points(Random& random, const ContactSet& set, std::size_t n) {
  return fill(
      n, [&] { return in_tool(random, set); }, [&] { return random.direction(); });
}

Points zero_normals(Random& random, const ContactSet& set, std::size_t n) {
  const double share = random.uniform() < 0.3 ? 1.0 : 0.5;
  return fill(
      n, [&] { return in_tool(random, set); },
      [&]() -> Vec3 { return chance(random, share) ? Vec3::Zero() : random.direction(); });
}

Points coincident(Random& random, const ContactSet& set, std::size_t n) {
  const Vec3 place = in_tool(random, set);
  return fill(
      n, [&] { return place; }, [&] { return random.direction(); });
}

/// Where no radial direction exists, the tip centre among them; normals along the axis or not.
Points on_the_axis(Random& random, const ContactSet& set, std::size_t n) {
  const double height = chance(random, 0.3) ? 0.0 : set.tool.length();
  return fill(
      n, [&]() -> Vec3 { return set.pose.position - height * random.uniform() * set.pose.axis; },
      [&] { return chance(random, 0.5) ? random.direction() : sign_of(random, set.pose.axis); });
}

Points opposite(Random& random, const ContactSet& set, std::size_t n) {
  const Vec3 u = random.direction();
  std::size_t i = 0;
  return fill(
      n, [&] { return in_tool(random, set); }, [&] { return i++ % 2 == 0 ? u : Vec3(-u); });
}

Points nearly_opposite(Random& random, const ContactSet& set, std::size_t n) {
  const Vec3 u = random.direction();
  return fill(
      n, [&] { return in_tool(random, set); }, [&] { return sign_of(random, nearly(random, u)); });
}

Points nearly_parallel(Random& random, const ContactSet& set, std::size_t n) {
  const Vec3 u = random.direction();
  return fill(
      n, [&] { return in_tool(random, set); }, [&] { return nearly(random, u); });
}

/// Points on the side, in the tip plane, on its rim. Their depth is 0 up to rounding; the search drops those outside.
Points on_the_surface(Random& random, const ContactSet& set, std::size_t n) {
  const auto position = [&] {
    const double radius = chance(random, 0.6) ? set.tool.radius() : set.tool.radius() * std::sqrt(random.uniform());
    return at(random, set, radius, chance(random, 0.6) ? 0.0 : -set.tool.length() * random.uniform());
  };
  return fill(n, position, [&] { return random.direction(); });
}

/// Walls on both sides of the axis: gradients of shortest_distance that cancel.
Points across_the_axis(Random& random, const ContactSet& set, std::size_t n) {
  const Vec3 e = across(set.pose.axis)[0];
  const Vec3 wall = set.tool.radius() * log_uniform(random, 1e-16, 1.0) * e;
  return fill(
      n, [&]() -> Vec3 { return set.pose.position - 0.5 * set.tool.length() * set.pose.axis + sign_of(random, wall); },
      [&] { return sign_of(random, e); });
}

struct Family {
  const char* name;
  Points (*draw)(Random& random, const ContactSet& set, std::size_t n);
};

constexpr Family kFamilies[] = {
    {"random", random_points},
    {"zero_normals", zero_normals},
    {"coincident", coincident},
    {"on_the_axis", on_the_axis},
    {"opposite", opposite},
    {"nearly_opposite", nearly_opposite},
    {"nearly_parallel", nearly_parallel},
    {"on_the_surface", on_the_surface},
    {"across_the_axis", across_the_axis},
};

constexpr auto kFamilyNames = [] {
  std::array<const char*, std::size(kFamilies)> names{};
  for (std::size_t i = 0; i < names.size(); ++i) names[i] = kFamilies[i].name;
  return names;
}();

void draw_tool(Random& random, ContactSet& set) {
  // A fifth of the scenes at each end of the scale, the others in between.
  const double which = random.uniform();
  const double scale = which < 0.2 ? 1e-12 : which < 0.4 ? 1e3 : log_uniform(random, 1e-12, 1e3);
  set.tool = {scale * random.uniform(0.05, 1.0), scale * random.uniform(0.1, 3.0),
              chance(random, 0.5) ? Tip::round : Tip::flat};
  set.pose.axis = chance(random, 0.3) ? Vec3(0.0, 0.0, -1.0) : random.direction();
  if (chance(random, 0.5)) set.pose.position = scale * random.direction();
  if (chance(random, 0.5)) set.velocity = log_uniform(random, 1e-12, 1e3) * random.direction();
}

void draw_rendering(Random& random, RenderingConfig& config) {
  config.depth_model = depth_models()[random.below(depth_models().size())].info->name;
  config.iterations = static_cast<int>(chance(random, 0.8) ? 3 : 1 + random.below(50));
  if (chance(random, 0.3)) config.stiffness = log_uniform(random, 1.0, 1e12);
  // n_ext far below the number of contacts overflows.
  if (chance(random, 0.5)) config.reduction = ReductionConfig{0.995, chance(random, 0.5) ? 3u : 100u, std::nullopt};
}

}  // namespace

std::span<const char* const> contact_set_families() {
  return kFamilyNames;
}

ContactSet draw_contact_set(Random& random) {
  ContactSet set;
  draw_tool(random, set);
  draw_rendering(random, set.rendering);
  const Family& family = kFamilies[random.below(std::size(kFamilies))];
  set.family = family.name;
  // Every fifth set has one point. The other sizes are log-uniform, so that small sets, which are degenerate most
  // often, are common.
  const double n = chance(random, 0.2) ? 1.0 : log_uniform(random, 1.0, static_cast<double>(kMostContacts));
  set.points = family.draw(random, set, static_cast<std::size_t>(n));
  return set;
}

}  // namespace hapbench
