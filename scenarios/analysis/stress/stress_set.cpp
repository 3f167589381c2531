#include "scenarios/analysis/stress/stress_set.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <optional>

#include "algorithms/depth/depth_model.hpp"
#include "sim/core/math.hpp"
#include "sim/core/random.hpp"

namespace hapbench {
namespace {

/// Returns a random number with a uniformly distributed logarithm.
double log_uniform(Random& random, double low, double high) {
  return low * math::pow(high / low, random.uniform());
}

/// Returns a vector with a random direction and a log-uniform length. The two draws are separate statements, because
/// the order of evaluation within an expression is unspecified.
Vec3 log_uniform_vector(Random& random, double low, double high) {
  const Vec3 direction = random.direction();
  return log_uniform(random, low, high) * direction;
}

/// Returns true with the given probability.
bool chance(Random& random, double probability) {
  return random.uniform() < probability;
}

/// Returns a unit vector near u: the sum of u and a random vector of length 1e-16 (rounding) to 1, normalised.
Vec3 nearly(Random& random, const Vec3& u) {
  return (u + log_uniform_vector(random, 1e-16, 1.0)).normalized();
}

/// Returns u or -u at random.
Vec3 sign_of(Random& random, const Vec3& u) {
  return chance(random, 0.5) ? u : Vec3(-u);
}

/// Returns a point at the distance `radius` [m] from the tool's axis, in a random direction around the axis. `height`:
/// distance from the tip along the axis [m]; points in the tool have a negative height.
Vec3 at(Random& random, const ContactSet& set, double radius, double height) {
  const Vec3 e = set.pose.axis.unitOrthogonal(), d = random.direction_in_plane();
  return set.pose.position + height * set.pose.axis + radius * (d.x() * e + d.y() * set.pose.axis.cross(e));
}

/// Returns a uniformly distributed point in the tool.
Vec3 in_tool(Random& random, const ContactSet& set) {
  const double radius = set.tool.radius() * std::sqrt(random.uniform());
  return at(random, set, radius, -set.tool.length() * random.uniform());
}

/// Draws a random vector.
using Draw = std::function<Vec3()>;

/// Selects one of five kinds of point positions at random, and returns a generator of such positions.
Draw positions(Random& random, const ContactSet& set) {
  const double radius = set.tool.radius(), length = set.tool.length();
  switch (random.below(5)) {
    case 0:  // coincident
      return [point = in_tool(random, set)] { return point; };
    case 1: {  // on the axis, where the radial direction is undefined, or all at the tip centre
      const double height = chance(random, 0.3) ? 0.0 : length;
      return [&, height] { return Vec3(set.pose.position - height * random.uniform() * set.pose.axis); };
    }
    case 2:  // on the side, in the tip plane or on the rim: depth 0 up to rounding; the search drops points outside
      return [&, radius, length] {
        const double away = chance(random, 0.6) ? radius : radius * std::sqrt(random.uniform());
        return at(random, set, away, chance(random, 0.6) ? 0.0 : -length * random.uniform());
      };
    case 3: {  // on both sides of the axis, where gradients of shortest_distance cancel
      const Vec3 wall = radius * log_uniform(random, 1e-16, 1.0) * set.pose.axis.unitOrthogonal();
      return
          [&, wall, length] { return Vec3(set.pose.position - 0.5 * length * set.pose.axis + sign_of(random, wall)); };
    }
    default:
      return [&] { return in_tool(random, set); };
  }
}

/// Selects one of five kinds of point normals at random, and returns a generator of such normals.
Draw normals(Random& random, const ContactSet& set) {
  const Vec3 u = chance(random, 0.2) ? set.pose.axis : random.direction();
  switch (random.below(5)) {
    case 0: {  // some or all normals are zero
      const double share = chance(random, 0.3) ? 1.0 : 0.5;
      return [&, share] { return chance(random, share) ? Vec3(Vec3::Zero()) : random.direction(); };
    }
    case 1:
      return [&, u] { return sign_of(random, u); };
    case 2:
      return [&, u] { return sign_of(random, nearly(random, u)); };
    case 3:
      return [&, u] { return nearly(random, u); };
    default:
      return [&] { return random.direction(); };
  }
}

/// Draws the tool's size, pose and velocity.
void draw_tool(Random& random, ContactSet& set) {
  // The scale of lengths is 1e-12 m for a fifth of the sets, 1e3 m for another fifth, and log-uniform between these
  // values for the other sets.
  const double which = random.uniform();
  const double scale = which < 0.2 ? 1e-12 : which < 0.4 ? 1e3 : log_uniform(random, 1e-12, 1e3);
  set.tool = {scale * random.uniform(0.05, 1.0), scale * random.uniform(0.1, 3.0),
              chance(random, 0.5) ? Tip::round : Tip::flat};
  set.pose.axis = chance(random, 0.3) ? Vec3(0.0, 0.0, -1.0) : random.direction();
  if (chance(random, 0.5)) set.pose.position = scale * random.direction();
  if (chance(random, 0.5)) set.velocity = log_uniform_vector(random, 1e-12, 1e3);
}

/// Draws the settings of the rendering.
void draw_rendering(Random& random, RenderingConfig& config) {
  config.depth_model = depth_models()[random.below(depth_models().size())].info->name;
  config.iterations = static_cast<int>(chance(random, 0.8) ? 3 : 1 + random.below(50));
  if (chance(random, 0.3)) config.stiffness = log_uniform(random, 1.0, 1e12);
  // If the limit n_ext is far below the number of contacts, the reduction becomes full and drops contacts.
  if (chance(random, 0.5)) config.reduction = ReductionConfig{0.995, chance(random, 0.5) ? 3u : 100u, std::nullopt};
}

}  // namespace

ContactSet stress_set(std::uint64_t seed, std::uint64_t i) {
  Random random(Random::derive(seed + 1, i));
  ContactSet set;
  draw_tool(random, set);
  draw_rendering(random, set.rendering);
  const Draw position = positions(random, set), normal = normals(random, set);
  // A fifth of the sets has one point. In the other sets, the number of points is log-uniform. This makes sets with few
  // points common, which is intended: they are degenerate more often than larger sets.
  const double n = chance(random, 0.2) ? 1.0 : log_uniform(random, 1.0, static_cast<double>(kMaxContacts));
  set.points.resize(static_cast<std::size_t>(n));
  for (SurfacePoint& point : set.points) {
    point.position = position();
    point.normal = normal();
  }
  return set;
}

}  // namespace hapbench
