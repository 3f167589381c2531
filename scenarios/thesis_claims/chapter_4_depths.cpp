#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "algorithms/registry.hpp"
#include "scenarios/thesis_claims/claims.hpp"
#include "scenarios/thesis_claims/contacts_by_hand.hpp"
#include "scenarios/thesis_claims/wording.hpp"

/// Claims of 4.2: the depths and gradients of the thesis's two depth models.
namespace hapbench {
namespace {

// ---- G1: the median line.

constexpr double kSameDirection = 0.999;
constexpr double kUnderestimated = 0.05;

Measured measure_median_line(const Evidence& e) {
  const auto product = [](const char* model) {
    return wall_point(-0.0001, model).gradient(0).dot(wall_point(0.0001, model).gradient(0));
  };
  // A point as deep as the thesis allows, whose normal is 20 degrees off the shortest way out.
  const double depth = e.published["G1.negligible"].at_most, angle = 20.0 * std::numbers::pi / 180.0;
  ContactBuffer contacts(1);
  contacts.push(0, {kDrill.radius() - depth, 0.0, 0.005}, {-std::cos(angle), -std::sin(angle), 0.0});
  find_depth_model("normal_projection")->make()->evaluate(kDrill, kUpright, contacts);
  return {{"",
           {{"shortest_product", {product("shortest_distance")}},
            {"normal_product", {product("surface_normal")}},
            {"underestimated_by", {1.0 - depth / contacts.depth[0]}}}}};
}

Finding judge_median_line(const Measured& measured, const PublishedNumbers& published) {
  const MeasuredCase& m = measured.at(0);
  const bool flips = m["shortest_product"] < 0.0;
  const bool steady = m["normal_product"] > kSameDirection;
  const bool shallow = m["underestimated_by"] < kUnderestimated;
  return {decide(flips && steady && shallow, flips && steady),
          fmt::format("gradients across the median line: inner product {:.2g} (shortest distance), {:.2g} (surface "
                      "normal); depth at {} mm underestimated by {:.2g} %",
                      m["shortest_product"], m["normal_product"], plain(1e3 * published["G1.negligible"].at_most),
                      100.0 * m["underestimated_by"]),
          fmt::format("the shortest distance {}, the surface normal {}", flips ? "flips" : "does not flip",
                      steady ? "does not" : "turns, too")};
}

constexpr Claim kClaims[] = {
    {.id = "G1",
     .place = "4.2, Fig. 8, C.1",
     .claim = "the gradient of the shortest distance flips across the median line, the surface normal's cannot; depths "
              "are underestimated a little",
     .published = "negligible below 0.25 mm",
     .rule =
         [](const PublishedNumbers&) {
           return fmt::format("reproduced: one turns round, the other does not, less than {} underestimated",
                              percent(kUnderestimated));
         },
     .measure = measure_median_line,
     .judge = judge_median_line},
};

}  // namespace

std::span<const Claim> chapter_4_depths() {
  return kClaims;
}

}  // namespace hapbench
