#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <utility>

#include "algorithms/laws/exact_shaping.hpp"
#include "algorithms/laws/force_law.hpp"
#include "algorithms/laws/shaped_stiffness.hpp"
#include "results/observe/ideal_trajectory.hpp"
#include "scenarios/batch/comparison.hpp"
#include "scenarios/batch/statistics.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/run/checked_scenario.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "scenarios/scene/named_files.hpp"
#include "scenarios/scene/scenario.hpp"
#include "scenarios/scene/tools.hpp"
#include "scenarios/thesis/claims.hpp"
#include "scenarios/thesis/measurements.hpp"
#include "sim/core/math.hpp"
#include "sim/core/random.hpp"

/// Claims of thesis section 3.3: the number of points before and after the reduction.
namespace hapbench {
namespace {

// ---- T1, T2, T3: number of points in each step with contact. One case for each point density. The hands are
// calibrated to the mean and standard deviation of the raw counts (before the reduction), so that the raw counts are
// inputs; the counts after the reduction are results. The simulated hands also tap with forces above the input limit.
// Steps within kAfterTap after a tap count for the means, but not for the bound of 15 points.

constexpr double kAfterTap = 0.1;  ///< time after a tap [s]

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
      // Steps within kAfterTap after a force above the input limit do not count for the bound.
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
  const double left = published["T1.reduced"].mean;
  const bool one = std::ranges::all_of(counts, [&](const MeasuredCase& c) { return c["reduced_max"] == left; });
  return {decide(one, false),
          one ? "on a flat all gradients are equal, so one point is left" : "more than one point is left on the flat"};
}

/// Returns two values: true if the mean of the counts is near the published mean of recording `one`, and true if the
/// spread of the counts is near the published spread of recording `one`. `counts` is "raw" or "reduced". The thesis
/// publishes two recordings of a task, `one` and `other`, without uncertainties. A value is near recording `one` if its
/// difference from this recording is at most the difference between the two recordings.
std::pair<bool, bool> nearness(const MeasuredCase& c, const std::string& counts, const PublishedNumber& one,
                               const PublishedNumber& other) {
  const auto is_near = [](double value, double published, double elsewhere) {
    return std::abs(value - published) <= std::abs(published - elsewhere);
  };
  return {is_near(c[counts + "_mean"], one.mean, other.mean),
          is_near(c[counts + "_deviation"], one.spread, other.spread)};
}

/// Agreement of the counts of one density with a published recording, from section 3.3 or from appendix C.3.
struct CountsAgree {
  std::string raw = {};   ///< recordings whose mean and spread of the raw counts agree, such as "3.3"
  std::string mean = {};  ///< the recordings of `raw` whose mean after the reduction agrees, too
  std::string whole =
      {};  ///< the recordings of `mean` whose spread after the reduction agrees, if no step reaches the bound
};

/// Compares the counts of one density with both published recordings of a task, in thesis 3.3 and in appendix C.3. The
/// counts of the two recordings differ. `bounded`: true if no step reaches the published bound.
CountsAgree agreement(const MeasuredCase& c, const PublishedNumbers& published, const std::string& task, bool bounded) {
  CountsAgree agree;
  for (const auto& [one, other] : {std::pair("", ".C3"), std::pair(".C3", "")}) {
    const auto [raw_mean, raw_spread] =
        nearness(c, "raw", published[task + ".raw" + one], published[task + ".raw" + other]);
    const auto [mean_left, spread_left] =
        nearness(c, "reduced", published[task + ".reduced" + one], published[task + ".reduced" + other]);
    if (!raw_mean || !raw_spread) continue;
    const char* section = *one == '\0' ? "3.3" : "C.3";
    append_item(agree.raw, section, " and ");
    if (mean_left) append_item(agree.mean, section, " and ");
    if (mean_left && spread_left && bounded) append_item(agree.whole, section, " and ");
  }
  return agree;
}

std::string agreement_text(const CountsAgree& agree, bool bounded, double bound) {
  if (!agree.whole.empty()) return "all counts are near those of " + agree.whole;
  if (agree.raw.empty()) return "the raw counts are near the counts of neither 3.3 nor C.3";
  if (agree.mean.empty())
    return "the raw counts are near those of " + agree.raw + ", but the number of points left is not";
  return "the number of points left is as published in " + agree.mean + ", " +
         (bounded ? std::string("but its standard deviation is not")
                  : fmt::format("but some steps keep {} or more", bound));
}

/// Numbers of densities whose counts agree with a publication, as far as the members of CountsAgree with these names.
struct AgreeingDensities {
  std::size_t raw = 0, mean = 0, whole = 0;
  std::string text = {};  ///< agreement_text() of each density
};

AgreeingDensities agreeing_densities(const Measured& counts, const PublishedNumbers& published,
                                     const std::string& task) {
  const double bound = published["T3.reduced.bound"].at_most;
  AgreeingDensities densities;
  for (const MeasuredCase& c : counts) {
    const bool bounded = c["outside_taps"] < bound;
    const CountsAgree agree = agreement(c, published, task, bounded);
    densities.raw += agree.raw.empty() ? 0U : 1U;
    densities.mean += agree.mean.empty() ? 0U : 1U;
    densities.whole += agree.whole.empty() ? 0U : 1U;
    append_item(densities.text,
                fmt::format("with the density field {}, {}", c.name, agreement_text(agree, bounded, bound)));
  }
  return densities;
}

/// The earlier rule of T2 and T3 did not ask whether the raw counts, which are an input, agree.
Verdict judge_reduced_points_before(const Measured& counts, const PublishedNumbers& published,
                                    const std::string& task) {
  const AgreeingDensities densities = agreeing_densities(counts, published, task);
  return decide(densities.whole == counts.size(), densities.mean > 0);
}

/// Judges the number of points after the reduction. The raw counts are an input: a density whose raw counts differ from
/// the published raw counts predicts nothing.
Finding judge_reduced_points(const Measured& counts, const PublishedNumbers& published, const std::string& task) {
  const AgreeingDensities densities = agreeing_densities(counts, published, task);
  return {densities.raw == 0 ? Verdict::not_judged : decide(densities.whole == counts.size(), densities.mean > 0),
          densities.text};
}

}  // namespace

std::vector<ClaimRule> chapter_3_counts() {
  return {{"T1", [](const Evidence& e) { return measure_counts(e, "task1_flat"); }, judge_flat_reduction},
          {"T2",
           [](const Evidence& e) { return measure_counts(e, "task2_rotate"); },
           [](const Measured& m, const PublishedNumbers& p) { return judge_reduced_points(m, p, "T2"); },
           {[](const Measured& m, const PublishedNumbers& p) { return judge_reduced_points_before(m, p, "T2"); }}},
          {"T3",
           [](const Evidence& e) { return measure_counts(e, "task3_spin"); },
           [](const Measured& m, const PublishedNumbers& p) { return judge_reduced_points(m, p, "T3"); },
           {[](const Measured& m, const PublishedNumbers& p) { return judge_reduced_points_before(m, p, "T3"); }}}};
}

}  // namespace hapbench
