#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "algorithms/laws/shaped_stiffness.hpp"
#include "scenarios/thesis_claims/claims.hpp"
#include "scenarios/thesis_claims/contact_sets.hpp"
#include "scenarios/thesis_claims/measurements.hpp"

/// Claims of chapter 3: the stiffness ratios after some iterations and in the limit.
namespace hapbench {
namespace {

// ---- R1, R3: least and greatest ratio of each recorded row of tasks 2 and 3 after a number of updates; task 1 has one
// point, whose ratio is 1. A case for each task and density.

constexpr const char* kTasks[] = {"task2_rotate", "task3_spin"};

Measured measure_ratios(const Evidence& e, double updates) {
  const PublishedNumber& once = e.published["R1.once"];
  Measured measured;
  for (const std::string task : kTasks) {
    for (const std::string density : {"signed_distance", "binary"}) {
      const auto table = e.results.table(task + "_" + density, "ratios.csv");
      const auto &iteration = table.at("iteration"), &low = table.at("ratio_min"), &high = table.at("ratio_max");
      double rows = 0.0, inside = 0.0, least = 1.0, most = 1.0, any_most = 1.0;
      for (std::size_t i = 0; i < iteration.size(); ++i) {
        if (iteration[i] < 1.0 || std::isnan(low[i])) continue;
        any_most = std::max(any_most, high[i]);
        if (iteration[i] != updates) continue;
        least = std::min(least, low[i]);
        most = std::max(most, high[i]);
        rows += 1.0;
        if (low[i] >= once.at_least && high[i] <= once.at_most) inside += 1.0;
      }
      measured.push_back({task.substr(0, 5) + " " + density,
                          {{"inside", {inside / rows}}, {"min", {least}}, {"max", {most}}, {"any_max", {any_most}}}});
    }
  }
  return measured;
}

Finding judge_ratios(const Measured& measured, const PublishedNumbers& published) {
  const PublishedNumber& once = published["R1.once"];
  const double never_above = published["R1.bound"].at_most;
  double inside = 1.0, any_max = 0.0;
  std::string text;
  for (const MeasuredCase& m : measured) {
    inside = std::min(inside, m["inside"]);
    any_max = std::max(any_max, m["any_max"]);
    append_item(text, fmt::format("{}: {:.0f} % of the rows within {} to {}, all within {:.2f} to {:.2f}", m.name,
                                  100.0 * m["inside"], once.at_least, once.at_most, m["min"], m["max"]));
  }
  const bool bounded = any_max <= never_above;
  return {decide(inside >= threshold(published, "nearly_all") && bounded,
                 inside >= threshold(published, "most") && bounded),
          fmt::format("{}; never above {:.3f} after any update", text, any_max),
          fmt::format("{} {} throughout; in the worse task {:.0f} % of the rows lie within the published range",
                      bounded ? "below" : "not below", never_above, 100.0 * inside)};
}

const char* const kRatiosRule =
    "reproduced: in both tasks, at both densities <rule.nearly_all.mean*100> % of the rows within <R1.once.at_least> to "
    "<R1.once.at_most> and none above <R1.bound.at_most> after any update; in kind: <rule.most.mean*100> % of the rows";

// ---- R1b: the largest ratio after 160 iterations and at the exact limit, the projection of the identity on the cone
// of contact tensors.

Measured measure_convergence(const Evidence& e) {
  double last_max = 1.0, limit_max = 1.0;
  for (const char* task : {"task2_rotate_signed_distance", "task3_spin_signed_distance"}) {
    const auto table = e.results.table(task, "ratios.csv");
    for (std::size_t i = 0; i < table.at("iteration").size(); ++i) {
      const double ratio = table.at("ratio_max")[i];
      if (table.at("iteration")[i] == 160.0 && ratio > last_max) last_max = ratio;
    }
    for (ContactBuffer& set : rendered_contact_sets(drill_in_hole(e.load(task).scenario), 64)) {
      solve_exact_shaping(set);
      limit_max = std::max(limit_max, ratio_range(set, stiffness_tensor(set)).max);
    }
  }
  return {{"", {{"last_max", {last_max}}, {"limit_max", {limit_max}}}}};
}

Finding judge_convergence(const Measured& measured, const PublishedNumbers& p) {
  const MeasuredCase& m = measured.at(0);
  const bool one = std::abs(m["limit_max"] - 1.0) <= threshold(p, "converged");
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
       .place = "3.4, 4.3, Fig. 5, C.4.2, E.3, E.4",
       .claim = "after one iteration the ratios are near 1 and never above 1.5",
       .published = "<R1.once.at_least> to <R1.once.at_most> after one iteration, never above <R1.bound.at_most>",
       .rule = std::string(kRatiosRule) + "; one iteration is <ratios.one_iteration> update",
       .measure = [](const Evidence& e) { return measure_ratios(e, e.published["ratios.one_iteration"].mean); },
       .judge = judge_ratios},
      {.id = "R3",
       .place = "3.4, Fig. 5, 4.3, C.4.2",
       .claim = "the default of three iterations keeps the ratios near 1: they converge quickly",
       .published = "<R1.iterations> iterations; the range after one, <R1.once.at_least> to <R1.once.at_most>, shrinks",
       .rule = kRatiosRule,
       .measure = [](const Evidence& e) { return measure_ratios(e, e.published["R1.iterations"].mean); },
       .judge = judge_ratios},
      {.id = "R1b",
       .place = "2.4, 3.4, C.4.2",
       .claim = "the ratios converge to 1",
       .published = "<R1.limit>",
       .rule = "reproduced: within <rule.converged.mean*100> % of 1 at the exact limit; else refuted",
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
