#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

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
    const auto table = e.results.table(name, "trajectory.csv");
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
                         {"reduced_max", {e.results.number(name, "metrics.rendered_max")}}}});
  }
  return measured;
}

std::string counts_text(const Measured& counts) {
  std::string text;
  for (const MeasuredCase& c : counts) {
    append_item(text, fmt::format("{}: raw {:.1f} ± {:.1f}, reduced {:.2f} ± {:.2f}, at most {}", c.name, c["raw_mean"],
                                  c["raw_deviation"], c["reduced_mean"], c["reduced_deviation"], c["reduced_max"]));
  }
  return text;
}

Finding judge_flat_reduction(const Measured& counts, const PublishedNumbers& published) {
  const bool one = std::all_of(counts.begin(), counts.end(),
                               [&](const MeasuredCase& c) { return c["reduced_max"] == published["T1.reduced"].mean; });
  return {decide(one, false), counts_text(counts),
          one ? "on a flat all gradients are equal, so one point is left" : "more than one point is left on the flat"};
}

/// Ids of the published pairs of raw and reduced counts; the appendix gives other ones than 3.3.
struct PublishedCounts {
  const char* raw;
  const char* reduced;
};

bool is_near(double value, const PublishedNumber& published) {
  return std::abs(value - published.mean) <= published.spread;
}

/// Counts the densities at which both the raw and the reduced mean lie within a published spread.
Finding judge_reduced_points(const Measured& counts, const PublishedNumbers& published,
                             std::initializer_list<PublishedCounts> pairs, std::optional<double> bound) {
  std::size_t near = 0;
  std::string why;
  for (const MeasuredCase& c : counts) {
    const bool raw = std::any_of(pairs.begin(), pairs.end(),
                                 [&](const PublishedCounts& p) { return is_near(c["raw_mean"], published[p.raw]); });
    const bool reduced = std::any_of(pairs.begin(), pairs.end(), [&](const PublishedCounts& p) {
      return is_near(c["reduced_mean"], published[p.reduced]);
    });
    const bool bounded = !bound || c["reduced_max"] < *bound;
    if (raw && reduced && bounded) ++near;
    append_item(why, fmt::format("{}: {}", c.name,
                                 !raw       ? "the raw count is not the published one"
                                 : !reduced ? "another number is left than published"
                                 : !bounded ? fmt::format("some rows keep {} or more", *bound)
                                            : "as published"));
  }
  return {decide(near == counts.size(), near > 0), counts_text(counts), why};
}

Finding judge_turning(const Measured& counts, const PublishedNumbers& p) {
  return judge_reduced_points(counts, p, {{"T2.raw", "T2.reduced"}, {"T2.raw.C3", "T2.reduced.C3"}}, {});
}

Finding judge_spinning(const Measured& counts, const PublishedNumbers& p) {
  return judge_reduced_points(counts, p, {{"T3.raw", "T3.reduced"}, {"T3.raw.C3", "T3.reduced.C3"}},
                              p["T3.reduced.bound"].at_most);
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
       .place = "3.3, Fig. 4, C.2b",
       .claim = "turning in the hole, the reduction leaves a few points",
       .published = "raw <T2.raw>, reduced <T2.reduced> (C.3: <T2.raw.C3>, <T2.reduced.C3>)",
       .rule =
           "reproduced: with the raw mean within a published standard deviation, the reduced mean is within one, too, "
           "at both densities; in kind: at one of them",
       .measure = [](const Evidence& e) { return measure_counts(e, "task2_rotate"); },
       .judge = judge_turning},
      {.id = "T3",
       .place = "3.3, 3.4, Fig. 4, C.2c",
       .claim = "spinning in the hole, fewer than 15 points are left",
       .published =
           "raw <T3.raw>, reduced <T3.reduced> (C.3: <T3.raw.C3>, <T3.reduced.C3>), below <T3.reduced.bound.at_most>",
       .rule =
           "reproduced: with the raw mean within a published standard deviation, the reduced mean is within one, too, "
           "and no row keeps <T3.reduced.bound.at_most> or more, at both densities; in kind: at one of them",
       .measure = [](const Evidence& e) { return measure_counts(e, "task3_spin"); },
       .judge = judge_spinning},
  };
}

}  // namespace hapbench
