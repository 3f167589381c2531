#include <fmt/format.h>

#include <algorithm>

#include "scenarios/thesis_claims/claims.hpp"
#include "scenarios/thesis_claims/wording.hpp"

/// Claims of chapter 4: what the thesis discusses as limits.
namespace hapbench {
namespace {

// ---- C1: over-reduction.

constexpr double kPointsLeft = 1.0;
constexpr double kFewestPoints = 10.0;
constexpr double kForceChange = 0.1;

Measured measure_over_reduction(const Evidence& e) {
  const char *reduced = "over_reduction_reduced", *unreduced = "over_reduction_unreduced";
  const auto a = e.results.table(reduced, "trajectory.csv"), b = e.results.table(unreduced, "trajectory.csv");
  double difference = 0.0, largest = 0.0;
  for (std::size_t i = 0; i < b.at("fx_N").size(); ++i) {
    const Vec3 with{a.at("fx_N")[i], a.at("fy_N")[i], a.at("fz_N")[i]};
    const Vec3 without{b.at("fx_N")[i], b.at("fy_N")[i], b.at("fz_N")[i]};
    difference = std::max(difference, (with - without).norm());
    largest = std::max(largest, without.norm());
  }
  return {{"",
           {{"reduced_max", {e.results.number(reduced, "metrics.rendered_max")}},
            {"unreduced_max", {e.results.number(unreduced, "metrics.rendered_max")}},
            {"force_difference", {difference / largest}}}}};
}

Finding judge_over_reduction(const Measured& measured, const PublishedNumbers&) {
  const MeasuredCase& m = measured.at(0);
  const bool collapsed = m["reduced_max"] == kPointsLeft && m["unreduced_max"] >= kFewestPoints;
  const bool matters = m["force_difference"] >= kForceChange;
  return {decide(collapsed && matters, collapsed),
          fmt::format("{} of {} points left; the force differs by up to {:.0f} %", m["reduced_max"], m["unreduced_max"],
                      100.0 * m["force_difference"]),
          collapsed ? "each point replaces its similar, shallower predecessor until one is left"
                    : "more than one point is left"};
}

// ---- C2: a tool that only turns.

Measured measure_pure_rotation(const Evidence& e) {
  const auto table = e.results.table("pure_rotation", "energy.csv");
  const auto& rotation = table.at("rotation_J");
  return {{"",
           {{"rotation_work", {*std::max_element(rotation.begin(), rotation.end())}},
            {"damping_work", {table.at("damping_J").back()}}}}};
}

Finding judge_pure_rotation(const Measured& measured, const PublishedNumbers&) {
  const MeasuredCase& m = measured.at(0);
  const bool loads = m["rotation_work"] > 0.0, undamped = m["damping_work"] == 0.0;
  return {decide(loads && undamped, loads),
          fmt::format("rotation puts {:.3g} mJ into the springs, damping takes {:.3g} mJ out", 1e3 * m["rotation_work"],
                      -1e3 * m["damping_work"]),
          undamped ? "a tool that only turns has no velocity to damp" : "the damping takes energy out"};
}

// ---- C3: a drill between two parallel faces.

constexpr double kSinksIn = 0.8;
constexpr double kWeightless = 0.01;

Measured measure_parallel_faces(const Evidence& e) {
  const Scenario scenario = e.scenario("parallel_faces");
  const double depth = e.results.number("parallel_faces", "metrics.depth_max_m");
  return {{"",
           {{"depth", {depth}},
            {"radius", {scenario.tool.diameter / 2.0}},
            {"force", {e.results.number("parallel_faces", "metrics.force_max_N")}},
            {"one_wall_force", {scenario.rendering.stiffness * depth}}}}};
}

Finding judge_parallel_faces(const Measured& measured, const PublishedNumbers&) {
  const MeasuredCase& m = measured.at(0);
  const bool sinks = m["depth"] >= kSinksIn * m["radius"];
  const bool weightless = m["force"] < kWeightless * m["one_wall_force"];
  return {decide(sinks && weightless, weightless),
          fmt::format("sinks in by {:.2f} mm, net force at most {:.2g} N where one wall alone would push with {:.3g} N",
                      1e3 * m["depth"], m["force"], m["one_wall_force"]),
          weightless ? "the forces of the two walls cancel" : "the walls push back"};
}

constexpr Claim kClaims[] = {
    {.id = "C1",
     .place = "4.1",
     .claim = "dense points with gradually changing normals collapse to one",
     .published = "one point left",
     .rule =
         [](const PublishedNumbers&) {
           return fmt::format("reproduced: {} of at least {} is left and the force changes by at least {}",
                              in_words(kPointsLeft), in_words(kFewestPoints), percent(kForceChange));
         },
     .measure = measure_over_reduction,
     .judge = judge_over_reduction},
    {.id = "C2",
     .place = "4.4",
     .claim = "a tool that only turns is not damped",
     .published = "",
     .rule =
         [](const PublishedNumbers&) {
           return std::string("reproduced: rotation loads the springs, damping takes nothing out");
         },
     .measure = measure_pure_rotation,
     .judge = judge_pure_rotation},
    {.id = "C3",
     .place = "4.6",
     .claim = "between two parallel faces rotation meets no force",
     .published = "",
     .rule =
         [](const PublishedNumbers&) {
           return fmt::format("reproduced: sinks in by {} of the radius, net force below {} of one wall's",
                              percent(kSinksIn), percent(kWeightless));
         },
     .measure = measure_parallel_faces,
     .judge = judge_parallel_faces},
    {.id = "C4",
     .place = "4.3, C.4.2",
     .claim = "stiffness beyond some value saturates the actuators",
     .published = "about 80 000 or 60 000 N/m",
     .rule = [](const PublishedNumbers&) { return std::string("needs the trainer"); },
     .measure = [](const Evidence&) { return Measured(); },
     .judge = [](const Measured&, const PublishedNumbers&) -> Finding {
       return {Verdict::not_reproducible, "",
               "which stiffness saturates the actuators depends on the trainer's mechanics, which are not published"};
     }},
};

}  // namespace

std::span<const Claim> chapter_4_discussion() {
  return kClaims;
}

}  // namespace hapbench
