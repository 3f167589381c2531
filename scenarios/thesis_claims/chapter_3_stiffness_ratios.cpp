#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "algorithms/laws/exact_shaping.hpp"
#include "scenarios/studies/precision/measure.hpp"
#include "scenarios/thesis_claims/claims.hpp"
#include "scenarios/thesis_claims/stiffest_contacts.hpp"

/// Claims of chapter 3: the stiffness ratios after some iterations and in the limit.
namespace hapbench {
namespace {

// ---- R1: least and greatest ratio of each recorded row of tasks 1 to 3. A case for each density.

constexpr const char* kTasks[] = {"task1_flat", "task2_rotate", "task3_spin"};
constexpr double kNearlyAll = 0.95;
constexpr double kMost = 0.5;

/// Ratios of the rows of one task after one iteration and after any number of iterations.
struct RatioRows {
  double rows = 0.0, inside = 0.0;
  double first_min = 1.0, first_max = 1.0, any_max = 1.0, last_max = 1.0;
};

void add_ratios(const Evidence& e, const std::string& scenario, RatioRows& ratios) {
  const PublishedNumber& once = e.published["R1.once"];
  const auto table = e.results.table(scenario, "ratios.csv");
  const auto &iteration = table.at("iteration"), &low = table.at("ratio_min"), &high = table.at("ratio_max");
  for (std::size_t i = 0; i < iteration.size(); ++i) {
    if (iteration[i] < 1.0 || std::isnan(low[i])) continue;
    ratios.any_max = std::max(ratios.any_max, high[i]);
    if (iteration[i] == 160.0) ratios.last_max = std::max(ratios.last_max, high[i]);
    if (iteration[i] != 1.0) continue;
    ratios.first_min = std::min(ratios.first_min, low[i]);
    ratios.first_max = std::max(ratios.first_max, high[i]);
    ratios.rows += 1.0;
    if (low[i] >= once.at_least && high[i] <= once.at_most) ratios.inside += 1.0;
  }
}

Measured measure_first_ratios(const Evidence& e) {
  Measured measured;
  for (const std::string density : {"signed_distance", "binary"}) {
    MeasuredCase& m = measured.emplace_back(MeasuredCase{density, {}});
    RatioRows all;
    for (const std::string task : kTasks) {
      RatioRows rows;
      add_ratios(e, task + "_" + density, rows);
      m.values["inside_" + task] = {rows.inside / rows.rows};
      all.rows += rows.rows;
      all.inside += rows.inside;
      all.first_min = std::min(all.first_min, rows.first_min);
      all.first_max = std::max(all.first_max, rows.first_max);
      all.any_max = std::max(all.any_max, rows.any_max);
    }
    m.values["inside"] = {all.inside / all.rows};
    m.values["first_min"] = {all.first_min};
    m.values["first_max"] = {all.first_max};
    m.values["any_max"] = {all.any_max};
  }
  return measured;
}

Finding judge_first_ratios(const Measured& measured, const PublishedNumbers& published) {
  const PublishedNumber& once = published["R1.once"];
  const double never_above = published["R1.bound"].at_most;
  double inside = 1.0, any_max = 0.0;
  std::string text;
  for (const MeasuredCase& m : measured) {
    inside = std::min(inside, m["inside"]);
    any_max = std::max(any_max, m["any_max"]);
    append_item(
        text,
        fmt::format(
            "{}: {:.0f} % of the rows within {} to {} after one iteration (tasks 1, 2, 3: {:.0f}, {:.0f}, {:.0f} %), all "
            "within {:.2f} to {:.2f}, never above {:.3f}",
            m.name, 100.0 * m["inside"], once.at_least, once.at_most, 100.0 * m["inside_task1_flat"],
            100.0 * m["inside_task2_rotate"], 100.0 * m["inside_task3_spin"], m["first_min"], m["first_max"],
            m["any_max"]));
  }
  const bool bounded = any_max <= never_above;
  return {decide(inside >= kNearlyAll && bounded, inside >= kMost && bounded), text,
          !bounded ? fmt::format("a ratio exceeds {}", never_above)
                   : fmt::format("below {} throughout; at least {:.0f} % of the rows lie within the published range",
                                 never_above, 100.0 * inside)};
}

// ---- R1b: the largest ratio after 160 iterations and at the exact limit, the projection of the identity on the cone
// of contact tensors.

constexpr double kConverged = 0.01;

Measured measure_convergence(const Evidence& e) {
  RatioRows ratios;
  double limit_max = 1.0;
  for (const char* task : {"task2_rotate_signed_distance", "task3_spin_signed_distance"}) {
    add_ratios(e, task, ratios);
    for (ContactBuffer& set : rendered_contact_sets(drill_in_hole(e.load(task).scenario), 64)) {
      solve_exact_shaping(set);
      limit_max = std::max(limit_max, ratio_range(set, stiffness_tensor(set)).max);
    }
  }
  return {{"", {{"last_max", {ratios.last_max}}, {"limit_max", {limit_max}}}}};
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

// ---- R2: the stiffest direction of the stiffest contacts found. A case for each number of iterations.

Measured measure_guarantee(const Evidence&) {
  // The search has no inputs: one result serves all samples.
  static const Measured found = [] {
    Measured measured;
    for (const int iterations : {1, 2, 3, 10, kExactLimit}) {
      const StiffestContacts stiffest = stiffest_contacts(iterations);
      measured.push_back({iterations == kExactLimit ? "limit" : std::to_string(iterations),
                          {{"lambda_max", {stiffest.lambda_max}}, {"sets", {static_cast<double>(stiffest.sets)}}}});
    }
    return measured;
  }();
  return found;
}

Finding judge_guarantee(const Measured& measured, const PublishedNumbers& published) {
  const double guaranteed = published["R2.bound"].at_most, proved = (1.0 + std::sqrt(3.0)) / 2.0;
  double largest = 0.0, sets = 0.0;
  std::string text;
  for (const MeasuredCase& m : measured) {
    largest = std::max(largest, m["lambda_max"]);
    sets += m["sets"];
    append_item(text,
                fmt::format("{} after {}", fmt::format("{:.5f}", m["lambda_max"]),
                            m.name == "limit" ? "infinitely many" : m.name),
                ", ");
  }
  const bool holds = largest <= guaranteed;
  return {decide(holds, false),
          fmt::format(
              "largest stiffness in any direction, in units of K, of the stiffest contacts found among {:.3g} sets: "
              "{} iterations",
              sets, text),
          !holds
              ? fmt::format("a set of contacts exceeds {}", guaranteed)
              : fmt::format(
                    "{} (1 + √3)/2 = {:.5f}, which is proved to bound every direction after any number of iterations "
                    "(BEYOND.md)",
                    largest <= proved + kSearchRounding ? "no set exceeds" : "some set exceeds", proved)};
}

}  // namespace

std::vector<Claim> chapter_3_stiffness_ratios() {
  return {
      {.id = "R1",
       .place = "3.4, Fig. 5, C.4, E.3, E.4",
       .claim = "after one iteration the ratios are near 1 and never above 1.5",
       .published = "<R1.once.at_least> to <R1.once.at_most> after one iteration, never above <R1.bound.at_most>",
       .rule = fmt::format(
           "reproduced: {} of the rows within <R1.once.at_least> to <R1.once.at_most> after one iteration and none above "
           "<R1.bound.at_most> after any; in kind: {} of the rows",
           percent(kNearlyAll), percent(kMost)),
       .measure = measure_first_ratios,
       .judge = judge_first_ratios},
      {.id = "R1b",
       .place = "2.4, 3.4, C.4.2",
       .claim = "the ratios converge to 1",
       .published = "<R1.limit>",
       .rule = fmt::format("reproduced: within {} of 1 at the exact limit; else refuted", percent(kConverged)),
       .measure = measure_convergence,
       .judge = judge_convergence},
      {.id = "R2",
       .place = "A.3, 5",
       .claim = "the combined stiffness is guaranteed not to exceed 1.5 times the stiffness of a contact",
       .published = "<R2.bound.at_most>",
       .rule = "reproduced: no direction stiffer than <R2.bound.at_most> in the stiffest sets of contacts found",
       .measure = measure_guarantee,
       .judge = judge_guarantee},
  };
}

}  // namespace hapbench
