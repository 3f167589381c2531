#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "algorithms/laws/original_averaging.hpp"
#include "algorithms/registry.hpp"
#include "scenarios/thesis_claims/claims.hpp"
#include "scenarios/thesis_claims/rules.hpp"
#include "sim/contact/shell_query.hpp"
#include "sim/tool/cylinder.hpp"

/// Claims of appendix B and of 4.2: what is wrong with the original algorithm, on contacts made for it.
namespace hapbench {
namespace {

const Cylinder kDrill;
const ToolPose kUpright{Vec3::Zero(), {0.0, 0.0, -1.0}};

/// A wall point with normal +x, `beyond` the median line of an upright tool (so beyond > 0: the tool's axis is inside).
ContactBuffer wall_point(double beyond, const char* depth_model) {
  ContactBuffer contacts(1);
  contacts.push(0, {beyond, 0.0, 0.001}, Vec3::UnitX());
  find_depth_model(depth_model)->make()->evaluate(kDrill, kUpright, contacts);
  contacts.pad();
  return contacts;
}

/// Force on the tool along the wall's normal for one such point [N].
double force_along_normal(double beyond, const char* depth_model) {
  ContactBuffer contacts = wall_point(beyond, depth_model);
  return make_original_averaging({})->evaluate(contacts).spring.x();
}

Finding judge_flip(const Evidence&) {
  return judge_flipped_gradient(force_along_normal(0.0001, "shortest_distance"),
                                force_along_normal(0.0001, "surface_normal"));
}

Finding judge_median(const Evidence& e) {
  const auto product = [](const char* model) {
    return wall_point(-0.0001, model).gradient(0).dot(wall_point(0.0001, model).gradient(0));
  };
  // A point as deep as the thesis allows, whose normal is 20 degrees off the shortest way out.
  const double depth = e.published["G1.negligible"].at_most, angle = 20.0 * std::numbers::pi / 180.0;
  ContactBuffer contacts(1);
  contacts.push(0, {kDrill.radius() - depth, 0.0, 0.005}, {-std::cos(angle), -std::sin(angle), 0.0});
  find_depth_model("normal_projection")->make()->evaluate(kDrill, kUpright, contacts);
  return judge_median_line(product("shortest_distance"), product("surface_normal"), 1.0 - depth / contacts.depth[0]);
}

Finding judge_damping(const Evidence&) {
  constexpr double kDegrees = 60.0;
  const double angle = kDegrees * std::numbers::pi / 180.0;
  ContactBuffer contacts(2);
  for (const double side : {-1.0, 1.0}) {
    contacts.push(0, Vec3::Zero(), Vec3::UnitX());
    contacts.set_gradient(contacts.size() - 1, {std::cos(angle), side * std::sin(angle), 0.0});
    contacts.depth[contacts.size() - 1] = 1e-4;
  }
  contacts.pad();
  const Mat3 S = make_original_averaging({})->evaluate(contacts).S;
  const Vec3 u = contacts.gradient(0);
  return judge_original_damping(u.dot(S * u), S(1, 1), kDegrees);
}

Finding judge_added(const Evidence&) {
  constexpr std::size_t kPoints = 10;
  const auto merged = [](std::size_t one_way) {
    ContactBuffer contacts(2 * kPoints + 3);
    for (std::size_t i = 0; i < kPoints + 1 + one_way; ++i) {
      contacts.push(static_cast<std::uint32_t>(i), Vec3::Zero(), Vec3::UnitX());
      contacts.set_gradient(i, i <= kPoints ? Vec3(-Vec3::UnitX()) : Vec3(Vec3::UnitX()));
      contacts.depth[i] = 1.0;
    }
    contacts.pad();
    RenderingConfig config;
    config.stiffness = 1.0;
    return make_original_averaging(config)->evaluate(contacts).spring;
  };
  const Vec3 before = merged(kPoints), after = merged(kPoints + 2);
  return judge_added_points(before.norm(), after.norm(), before.normalized().dot(after.normalized()), kPoints);
}

constexpr Claim kClaims[] = {
    {"G1", "4.2, Fig. 8, C.1",
     "the gradient of the shortest distance flips across the median line, the surface normal's cannot; depths are "
     "underestimated a little",
     "negligible below 0.25 mm", "reproduced: one turns round, the other does not, less than 5 % underestimated",
     judge_median},
    {"B1", "B.3.1", "flipped gradients pull the tool into the object", "",
     "reproduced: force into the wall beyond the median line, out of it with the surface normal", judge_flip},
    {"B2", "B.3.2", "with distributed contact the original algorithm is under-damped", "",
     "reproduced: less than half of B along the contacts", judge_damping},
    {"B3", "B.3.3", "two more points change the merged depth from 2n+1 to 2n+3 and turn the direction round",
     "21, 23, 180 degrees for n = 10", "reproduced: the integers to 1e-9, opposite directions", judge_added},
};

}  // namespace

std::span<const Claim> algorithm_claims() {
  return kClaims;
}

}  // namespace hapbench
