#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "algorithms/laws/exact_shaping.hpp"
#include "scenarios/studies/precision/measure.hpp"
#include "scenarios/thesis_claims/claims.hpp"
#include "scenarios/thesis_claims/wording.hpp"

/// Claims of chapter 3: the stiffness ratios after some iterations and in the limit.
namespace hapbench {
namespace {

// ---- R1, R1b: extreme stiffness ratios over all rows of the tasks.

constexpr double kConverged = 0.01;

MeasuredCase measure_ratios(const Evidence& e) {
  double first_min = 1.0, first_max = 1.0, any_max = 1.0, last_max = 1.0;
  for (const char* task : {"task1_flat", "task2_rotate", "task3_spin"}) {
    for (const char* density : {"_signed_distance", "_binary"}) {
      const auto table = e.results.table(std::string(task) + density, "ratios.csv");
      const auto &iteration = table.at("iteration"), &low = table.at("ratio_min"), &high = table.at("ratio_max");
      for (std::size_t i = 0; i < iteration.size(); ++i) {
        if (iteration[i] < 1.0) continue;
        any_max = std::max(any_max, high[i]);
        if (iteration[i] == 1.0) {
          first_min = std::min(first_min, low[i]);
          first_max = std::max(first_max, high[i]);
        }
        if (iteration[i] == 160.0) last_max = std::max(last_max, high[i]);
      }
    }
  }
  return {"",
          {{"first_min", {first_min}}, {"first_max", {first_max}}, {"any_max", {any_max}}, {"last_max", {last_max}}}};
}

Finding judge_first_ratios(const Measured& measured, const PublishedNumbers& published) {
  const MeasuredCase& m = measured.at(0);
  const PublishedNumber& once = published["R1.once"];
  const double never_above = published["R1.bound"].at_most;
  const bool in_range = m["first_min"] >= once.at_least && m["first_max"] <= once.at_most;
  const bool bounded = m["any_max"] <= never_above;
  return {decide(in_range && bounded, bounded),
          fmt::format("after one iteration {:.3f} to {:.3f}; never above {:.3f}", m["first_min"], m["first_max"],
                      m["any_max"]),
          in_range && bounded ? "within the published range"
          : bounded ? fmt::format("below {} throughout, but outside {} to {} after one iteration", never_above,
                                  once.at_least, once.at_most)
                    : fmt::format("a ratio exceeds {}", never_above)};
}

/// With that at the exact limit of the iteration: the projection of the identity on the cone of contact tensors.
Measured measure_convergence(const Evidence& e) {
  MeasuredCase ratios = measure_ratios(e);
  double limit_max = 1.0;
  PrecisionOptions options;
  options.cache = e.cache;
  for (const char* task : {"task2_rotate_signed_distance", "task3_spin_signed_distance"}) {
    const Scenario scenario = drill_in_hole(e.scenario(task));
    for (ContactBuffer& set : rendered_contact_sets(scenario, options, 64)) {
      solve_exact_shaping(set);
      limit_max = std::max(limit_max, ratio_range(set, stiffness_tensor(set)).max);
    }
  }
  ratios.values["limit_max"] = {limit_max};
  return {ratios};
}

Finding judge_convergence(const Measured& measured, const PublishedNumbers&) {
  const MeasuredCase& m = measured.at(0);
  const bool one = std::abs(m["limit_max"] - 1.0) <= kConverged;
  return {one ? Verdict::reproduced : Verdict::refuted,
          fmt::format("largest ratio after 160 iterations {:.3f}, at the exact limit {:.3f}", m["last_max"],
                      m["limit_max"]),
          one ? "the exact limit is 1 at every contact of these runs"
              : "the iteration converges to the projection of the identity on the cone of contact tensors, where the "
                "ratio of a contact without weight stays above 1"};
}

constexpr Claim kClaims[] = {
    {.id = "R1",
     .place = "3.4, Fig. 5, C.4, E.3, E.4",
     .claim = "after one iteration the ratios are near 1 and never above 1.5",
     .published = "0.8 to 1.3 after one iteration, never above 1.5",
     .rule =
         [](const PublishedNumbers& published) {
           return fmt::format("reproduced: within both; in kind: never above {}", plain(published["R1.bound"].at_most));
         },
     .measure = [](const Evidence& e) { return Measured{measure_ratios(e)}; },
     .judge = judge_first_ratios},
    {.id = "R1b",
     .place = "2.4, 3.4, C.4.2",
     .claim = "the ratios converge to 1",
     .published = "1",
     .rule =
         [](const PublishedNumbers&) {
           return fmt::format("reproduced: within {} of 1 at the exact limit; else refuted", percent(kConverged));
         },
     .measure = measure_convergence,
     .judge = judge_convergence},
};

}  // namespace

std::span<const Claim> chapter_3_stiffness_ratios() {
  return kClaims;
}

}  // namespace hapbench
