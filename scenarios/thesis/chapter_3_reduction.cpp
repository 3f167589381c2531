#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "results/io/columns.hpp"
#include "scenarios/cases/league.hpp"
#include "scenarios/thesis/claims.hpp"

/// Claims of 3.3: the number of points before and after the reduction.
namespace hapbench {
namespace {

constexpr const char* kDensities[] = {"signed_distance", "binary"};

// ---- T1, T2, T3: points per row with contact. A case for each density. The hands are calibrated to mean and standard
// deviation of the raw counts, so those are input and what is left after the reduction is not. Taps beyond the limit of
// the input, which are ours, and what is left within kAfterTap of them count for the means, not for the bound of 15.

constexpr double kAfterTap = 0.1;  ///< [s]

Measured measure_counts(const Evidence& e, const std::string& task) {
  Measured measured;
  for (const std::string density : kDensities) {
    const std::string name = task + "_" + density;
    const auto table = e.table(name, "trajectory.csv");
    std::vector<double> raw, reduced;
    double outside = 0.0, tap = -kAfterTap;
    for (std::size_t i = 0; i < table.at("colliding").size(); ++i) {
      const double time = table.at("time_s")[i];
      const Vec3 force{table.at("fmeas_x_N")[i], table.at("fmeas_y_N")[i], table.at("fmeas_z_N")[i]};
      if (force.norm() > e.published["L1.measured"].mean) tap = time;
      if (time >= tap + kAfterTap) outside = std::max(outside, table.at("rendered")[i]);
      if (table.at("colliding")[i] == 0.0) continue;
      raw.push_back(table.at("colliding")[i]);
      reduced.push_back(table.at("rendered")[i]);
    }
    measured.push_back({density,
                        {{"raw_mean", {mean_of(raw)}},
                         {"raw_deviation", {standard_deviation(raw)}},
                         {"reduced_mean", {mean_of(reduced)}},
                         {"reduced_deviation", {standard_deviation(reduced)}},
                         {"reduced_max", {e.number(name, "metrics.rendered_max")}},
                         {"outside_taps", {outside}}}});
  }
  return measured;
}

Finding judge_flat_reduction(const Measured& counts, const PublishedNumbers& published) {
  const bool one = std::all_of(counts.begin(), counts.end(),
                               [&](const MeasuredCase& c) { return c["reduced_max"] == published["T1.reduced"].mean; });
  return {decide(one, false), "",
          one ? "on a flat all gradients are equal, so one point is left" : "more than one point is left on the flat"};
}

/// The thesis gives two recordings of a task and no error of either: a number of ours is near one of them if it is no
/// further from it than the other one is.
bool is_near(double value, double published, double other) {
  return std::abs(value - published) <= std::abs(published - other);
}

struct Nearness {
  bool mean, spread;
};

/// Whether some counts of a density are near those of one recording.
Nearness nearness(const MeasuredCase& c, const std::string& counts, const PublishedNumber& one,
                  const PublishedNumber& other) {
  return {is_near(c[counts + "_mean"], one.mean, other.mean),
          is_near(c[counts + "_deviation"], one.spread, other.spread)};
}

/// The appendix gives other counts than 3.3.
Finding judge_reduced_points(const Measured& counts, const PublishedNumbers& published, const std::string& task) {
  const double bound = published["T3.reduced.bound"].at_most;
  std::size_t all = 0, means = 0;
  std::string why;
  for (const MeasuredCase& c : counts) {
    const bool bounded = c["outside_taps"] < bound;
    bool whole = false, mean = false, raw = false;
    for (const auto& [one, other] : {std::pair("", ".C3"), std::pair(".C3", "")}) {
      const Nearness calibrated = nearness(c, "raw", published[task + ".raw" + one], published[task + ".raw" + other]);
      const Nearness left =
          nearness(c, "reduced", published[task + ".reduced" + one], published[task + ".reduced" + other]);
      if (!calibrated.mean || !calibrated.spread) continue;
      raw = true;
      mean = mean || left.mean;
      whole = whole || (left.mean && left.spread && bounded);
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
  return {decide(all == counts.size(), means > 0), "", why};
}

}  // namespace

std::vector<ClaimRule> chapter_3_reduction() {
  return {
      {"T1", [](const Evidence& e) { return measure_counts(e, "task1_flat"); }, judge_flat_reduction},
      {"T2", [](const Evidence& e) { return measure_counts(e, "task2_rotate"); },
       [](const Measured& m, const PublishedNumbers& p) { return judge_reduced_points(m, p, "T2"); }},
      {"T3", [](const Evidence& e) { return measure_counts(e, "task3_spin"); },
       [](const Measured& m, const PublishedNumbers& p) { return judge_reduced_points(m, p, "T3"); }},
  };
}

}  // namespace hapbench
