#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "algorithms/laws/laws.hpp"
#include "scenarios/thesis_claims/claims.hpp"
#include "scenarios/thesis_claims/contacts_by_hand.hpp"
#include "scenarios/thesis_claims/wording.hpp"

/// Claims of appendix B: what is wrong with the original algorithm, on contacts made for it.
namespace hapbench {
namespace {

// ---- B1: <f, n>, the force on the tool along the surface normal of a point beyond the tool's median line.

Measured measure_flipped_gradient(const Evidence&) {
  const auto force_along_normal = [](const char* depth_model) {
    ContactBuffer contacts = wall_point(0.0001, depth_model);
    return make_original_averaging({})->evaluate(contacts).spring.x();
  };
  return {{"",
           {{"with_shortest_distance", {force_along_normal("shortest_distance")}},
            {"with_surface_normal", {force_along_normal("surface_normal")}}}}};
}

Finding judge_flipped_gradient(const Measured& measured, const PublishedNumbers&) {
  const MeasuredCase& m = measured.at(0);
  const bool pulled = m["with_shortest_distance"] < 0.0;
  const bool pushed = m["with_surface_normal"] > 0.0;
  return {decide(pulled && pushed, pulled),
          fmt::format("force along the normal {:.3g} N with the shortest distance, {:.3g} N with the surface normal",
                      m["with_shortest_distance"], m["with_surface_normal"]),
          pulled ? "beyond the median line the original algorithm pulls the tool in"
                 : "the original algorithm pushes the tool out here"};
}

// ---- B2: two contacts either side of the merged direction; how much of B damps along each, and across.

constexpr double kDampedAlongContacts = 0.5;

Measured measure_damping(const Evidence&) {
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
  return {{"", {{"along", {u.dot(S * u)}}, {"across", {S(1, 1)}}, {"angle_degrees", {kDegrees}}}}};
}

Finding judge_damping(const Measured& measured, const PublishedNumbers&) {
  const MeasuredCase& m = measured.at(0);
  return {decide(m["along"] < kDampedAlongContacts, m["along"] < 1.0),
          fmt::format("two contacts {:.0f} degrees either side of the merged direction: {:.3f} of B along each, {:.3f} "
                      "across",
                      m["angle_degrees"], m["along"], m["across"]),
          "the original algorithm damps along the merged direction only"};
}

// ---- B3: the merged depth before and after two more points, in units of the common depth.

constexpr std::size_t kPoints = 10;
constexpr double kExact = 1e-9;

Measured measure_added_points(const Evidence&) {
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
  return {{"",
           {{"depth_before", {before.norm()}},
            {"depth_after", {after.norm()}},
            {"direction_product", {before.normalized().dot(after.normalized())}}}}};
}

Finding judge_added_points(const Measured& measured, const PublishedNumbers&) {
  const MeasuredCase& m = measured.at(0);
  const auto n = static_cast<double>(kPoints);
  const bool depths =
      std::abs(m["depth_before"] - (2.0 * n + 1.0)) <= kExact && std::abs(m["depth_after"] - (2.0 * n + 3.0)) <= kExact;
  const bool turned = m["direction_product"] <= -1.0 + kExact;
  return {decide(depths && turned, turned),
          fmt::format("n = {}: merged depth {:.9g}, then {:.9g}; directions' inner product {:.3g}", kPoints,
                      m["depth_before"], m["depth_after"], m["direction_product"]),
          depths && turned ? "exact, as the formula says" : "another depth or direction than the formula's"};
}

constexpr Claim kClaims[] = {
    {.id = "B1",
     .place = "B.3.1",
     .claim = "flipped gradients pull the tool into the object",
     .published = "",
     .rule =
         [](const PublishedNumbers&) {
           return std::string(
               "reproduced: force into the wall beyond the median line, out of it with the surface normal");
         },
     .measure = measure_flipped_gradient,
     .judge = judge_flipped_gradient},
    {.id = "B2",
     .place = "B.3.2",
     .claim = "with distributed contact the original algorithm is under-damped",
     .published = "",
     .rule =
         [](const PublishedNumbers&) {
           return fmt::format("reproduced: less than {} of B along the contacts", in_words(kDampedAlongContacts));
         },
     .measure = measure_damping,
     .judge = judge_damping},
    {.id = "B3",
     .place = "B.3.3",
     .claim = "two more points change the merged depth from 2n+1 to 2n+3 and turn the direction round",
     .published = "21, 23, 180 degrees for n = 10",
     .rule =
         [](const PublishedNumbers&) {
           return fmt::format("reproduced: the integers to {}, opposite directions", plain(kExact));
         },
     .measure = measure_added_points,
     .judge = judge_added_points},
};

}  // namespace

std::span<const Claim> appendix_b_original_algorithm() {
  return kClaims;
}

}  // namespace hapbench
