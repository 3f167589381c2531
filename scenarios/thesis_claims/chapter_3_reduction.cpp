#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "scenarios/batch/statistics.hpp"
#include "scenarios/thesis_claims/claims.hpp"

/// Claims of 3.3: the number of points before and after the reduction.
namespace hapbench {
namespace {

constexpr const char* kDensities[] = {"signed_distance", "binary"};

// ---- T1, T2, T3: points per row with contact. A case for each density. The hands are calibrated to mean and standard
// deviation of the raw counts, so those are input and what is left after the reduction is not.

Measured measure_counts(const Evidence& e, const std::string& task) {
  Measured measured;
  for (const std::string density : kDensities) {
    const std::string name = task + "_" + density;
    const auto table = e.table(name, "trajectory.csv");
    std::vector<double> raw, reduced;
    for (std::size_t i = 0; i < table.at("colliding").size(); ++i) {
      if (table.at("colliding")[i] == 0.0) continue;
      raw.push_back(table.at("colliding")[i]);
      reduced.push_back(table.at("rendered")[i]);
    }
    measured.push_back({density,
                        {{"raw_mean", {mean_of(raw)}},
                         {"raw_deviation", {standard_deviation(raw)}},
                         {"reduced_mean", {mean_of(reduced)}},
                         {"reduced_deviation", {standard_deviation(reduced)}},
                         {"reduced_max", {e.number(name, "metrics.rendered_max")}}}});
  }
  return measured;
}

std::string counts_text(const Measured& counts) {
  return said_of_each(counts, [](const MeasuredCase& c) {
    return fmt::format("{}: raw {:.1f} ± {:.1f}, reduced {:.2f} ± {:.2f}, at most {}", c.name, c["raw_mean"],
                       c["raw_deviation"], c["reduced_mean"], c["reduced_deviation"], c["reduced_max"]);
  });
}

Finding judge_flat_reduction(const Measured& counts, const PublishedNumbers& published) {
  const bool one = std::all_of(counts.begin(), counts.end(),
                               [&](const MeasuredCase& c) { return c["reduced_max"] == published["T1.reduced"].mean; });
  return {decide(one, false), counts_text(counts),
          one ? "on a flat all gradients are equal, so one point is left" : "more than one point is left on the flat"};
}

/// The thesis gives two recordings of a task and no error of either: a number of ours is near one of them if it is no
/// further from it than the other one is.
bool is_near(double value, double published, double other) {
  return std::abs(value - published) <= std::abs(published - other);
}

/// The density's counts beside one recording: whether the raw ones are near, which are calibrated, and the reduced
/// ones.
struct Nearness {
  bool raw, mean, spread;
};

/// `one` and `other` end the ids of the recordings' counts.
Nearness nearness(const MeasuredCase& c, const PublishedNumbers& p, const std::string& task, const char* one,
                  const char* other) {
  const std::string raws = task + ".raw", reduceds = task + ".reduced";
  const PublishedNumber &raw = p[raws + one], &raw_2 = p[raws + other], &reduced = p[reduceds + one],
                        &reduced_2 = p[reduceds + other];
  return {is_near(c["raw_mean"], raw.mean, raw_2.mean) && is_near(c["raw_deviation"], raw.spread, raw_2.spread),
          is_near(c["reduced_mean"], reduced.mean, reduced_2.mean),
          is_near(c["reduced_deviation"], reduced.spread, reduced_2.spread)};
}

/// The appendix gives other counts than 3.3.
Finding judge_reduced_points(const Measured& counts, const PublishedNumbers& published, const std::string& task) {
  const double bound = published["T3.reduced.bound"].at_most;
  std::size_t all = 0, means = 0;
  std::string why;
  for (const MeasuredCase& c : counts) {
    const bool bounded = c["reduced_max"] < bound;
    bool whole = false, mean = false, raw = false;
    for (const Nearness& near : {nearness(c, published, task, "", ".C3"), nearness(c, published, task, ".C3", "")}) {
      raw = raw || near.raw;
      mean = mean || (near.raw && near.mean);
      whole = whole || (near.raw && near.mean && near.spread && bounded);
    }
    if (whole) ++all;
    if (mean) ++means;
    append_item(why, fmt::format("{}: {}", c.name,
                                 whole   ? "as published"
                                 : !raw  ? "the raw counts are not the published ones"
                                 : !mean ? "another number is left than published"
                                         : fmt::format("the number left is as published, {}",
                                                       bounded ? "its spread is not"
                                                               : fmt::format("some rows keep {} or more", bound))));
  }
  return {decide(all == counts.size(), means > 0), counts_text(counts), why};
}

const char* const kCountsRule =
    "reproduced: at both densities mean and spread of the raw counts (calibrated) and of the reduced ones as near to those "
    "of 3.3 or C.3 as these are to each other, and no row keeps <T3.reduced.bound.at_most> or more; in kind: the means of one "
    "density, with its raw spread";

// ---- T2b: the raw counts of task 2 over the force of a constant hand.

constexpr double kHeldForces[] = {0.2, 0.5, 1.0, 1.8};  ///< [N]; the last one is about that of appendix D

Measured measure_hands(const Evidence& e) {
  Measured measured;
  for (const double force : kHeldForces) {
    double rows = 0.0, raw = 0.0, kept = 0.0;
    for_each_row(e.load("task2_held", {fmt::format("hand.force_N={}", force)}), [&](const StepRecord& row) {
      if (row.colliding == 0) return;
      rows += 1.0;
      raw += static_cast<double>(row.colliding);
      kept = std::max(kept, static_cast<double>(row.rendered->size()));
    });
    measured.push_back({fmt::format("{} N", force), {{"raw", {raw / rows}}, {"kept", {kept}}}});
  }
  return measured;
}

Finding judge_hands(const Measured& measured, const PublishedNumbers& p) {
  const std::string text = said_of_each(measured, [](const MeasuredCase& m) {
    return fmt::format("{}: raw {:.0f}, at most {} kept", m.name, m["raw"], m["kept"]);
  });
  const double most = p["T2.raw"].mean + p["T2.raw"].spread;
  return {found(measured.front()["raw"] <= most && measured.back()["raw"] > most), text,
          "the published counts fit a hand about ten times gentler than those of appendix D"};
}

}  // namespace

std::vector<Claim> chapter_3_reduction() {
  return {
      {.id = "T1",
       .place = "3.3, Fig. 4, C.2a",
       .claim = "on a flat the reduction always leaves one point",
       .published = "raw <T1.raw>, reduced <T1.reduced>",
       .rule = "reproduced: never more than one",
       .measure = [](const Evidence& e) { return measure_counts(e, "task1_flat"); },
       .judge = judge_flat_reduction},
      {.id = "T2",
       .place = "3.3, 3.4, Fig. 4, C.2b",
       .claim = "turning in the hole, the reduction leaves a few points, fewer than 15",
       .published =
           "raw <T2.raw>, reduced <T2.reduced> (C.3: <T2.raw.C3>, <T2.reduced.C3>), below <T3.reduced.bound.at_most>",
       .rule = kCountsRule,
       .measure = [](const Evidence& e) { return measure_counts(e, "task2_rotate"); },
       .judge = [](const Measured& m, const PublishedNumbers& p) { return judge_reduced_points(m, p, "T2"); }},
      {.id = "T2b",
       .place = "3.3, D.4",
       .claim = "task 2's raw counts are those of a hand much gentler than the subjects of appendix D",
       .published = "raw <T2.raw>; forces about 1.8 N",
       .rule =
           "holds: the gentlest hand's raw mean lies within a spread of the published one, the firmest one's beyond it",
       .measure = measure_hands,
       .judge = judge_hands,
       .ours = true},
      {.id = "T3",
       .place = "3.3, 3.4, Fig. 4, C.2c",
       .claim = "spinning in the hole, fewer than 15 points are left",
       .published =
           "raw <T3.raw>, reduced <T3.reduced> (C.3: <T3.raw.C3>, <T3.reduced.C3>), below <T3.reduced.bound.at_most>",
       .rule = kCountsRule,
       .measure = [](const Evidence& e) { return measure_counts(e, "task3_spin"); },
       .judge = [](const Measured& m, const PublishedNumbers& p) { return judge_reduced_points(m, p, "T3"); }},
  };
}

}  // namespace hapbench
