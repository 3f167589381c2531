#include "scenarios/program/tune/columns.hpp"

#include <fmt/format.h>

#include <functional>
#include <optional>

#include "scenarios/program/run_table.hpp"
#include "scenarios/program/tune/answer.hpp"

namespace hapbench {
namespace {

constexpr const char* kRatioColumn = "rendering.damping_ratio";

/// Returns the columns of the choice and of the constraint that a larger stiffness violates; empty without a
/// feasible choice.
Columns<TunedLaw> choice_columns() {
  using Row = TunedLaw;
  const auto of_setting = [](auto member) {
    return [member](const Row& r) { return r.choice ? cell_of(std::invoke(member, r.choice->setting)) : Cell(); };
  };
  const auto of_choice = [](auto member) {
    return [member](const Row& r) { return r.choice ? cell_of(std::invoke(member, *r.choice)) : Cell(); };
  };
  const auto feasible = [](const Row& r) { return r.choice.has_value(); };
  const auto stiffness = [](const Row& r) { return r.choice ? stiffness_text(*r.choice) : "none"; };
  return {
      {"algorithm", "", "force algorithm", &Row::algorithm, under("algorithm")},
      {"feasible", "", "false when nothing that was tried keeps all constraints", feasible},
      {"stiffness_N_per_m", "N/m", "the largest K; empty when nothing is feasible", of_choice(&TuneTrial::stiffness)},
      {"K [N/m]", "N/m", "of tune: the largest stiffness that keeps margin and limits [N/m]", stiffness,
       only_printed()},
      {kRatioColumn, "1", "zeta with it; empty where it has no part", of_setting(&TuneSetting::damping_ratio),
       under("zeta", 3, kOnlyCsv)},
      {"damping_ratio", "1", "the same", of_setting(&TuneSetting::damping_ratio), kOnlyJson},
      {"mass_kg", "kg", "virtual mass with it, of an admittance device; else empty: the scene's",
       of_setting(&TuneSetting::mass)},
      {"velocity_filter", "", "with it, as JSON; empty: the scene's", of_setting(&TuneSetting::filter)},
      {"lambda_max", "1",
       "largest eigenvalue of the mean S in the end of the run: K lambda_max is the stiffness rendered",
       of_choice(&TuneTrial::lambda_max)},
      {"binding", "",
       "what a larger K does not keep: settled, margin, a limited metric, or range, the end of the search",
       &Row::binding},
      {"why", "", "the same in words", &Row::why},
      {"relax", "", "where nothing is feasible: which limit to relax, and to what", &Row::relax}};
}

}  // namespace

Columns<TunedLaw> tuned_columns() {
  using Row = TunedLaw;
  Columns<Row> columns = choice_columns();
  for (const Margin& margin : kMargins) {
    columns.add({{margin.column, margin.unit, margin.meaning, [of = margin.of](const Row& r) { return r.margins.*of; },
                  under(margin.heading, 3, kOnlyCsv)}});
  }
  const auto may_fail = [](const Row& r) { return r.verified > 0 ? Cell(may_fail_share(kTriedBetween)) : Cell(); };
  const auto metric = [](const char* heading, const char* name, double factor) {
    const auto text = [=](const Row& r) {
      const auto value = r.choice ? value_in(r.choice->metrics, name, factor) : std::nullopt;
      return value ? number_text(*value, value_in(r.error, name, factor)) : "-";
    };
    return Columns<Row>::Entry(heading, "by name", name, text, only_printed());
  };
  columns.add(
      {{"verified", "1",
        fmt::format("full-length runs between K and G K, all settled, {} of them just below G K", kTriedNear),
        &Row::verified},
       {"may_fail_share", "1", "share of what lies between K and G K that may not be, with 95 % confidence", may_fail},
       {"runs", "1", "simulations in all", &Row::runs},
       metric("settled\ninside [mm]", "inside_settled_m", 1e3),
       metric("vibration\n[N rms]", "force_rms_above_30Hz_N", 1.0),
       metric("largest\nstep [N]", "settled_force_step_max_N", 1.0),
       {"binding", "", "of tune: what a larger K does not keep", &Row::binding, only_printed()}});
  return columns;
}

Columns<TuneTrial> trial_columns() {
  using Row = TuneTrial;
  const auto of_setting = [](auto member) {
    return [member](const Row& r) { return cell_of(std::invoke(member, r.setting)); };
  };
  Columns<Row> columns = {
      {"algorithm", "", "force algorithm", &Row::algorithm},
      {"stiffness_N_per_m", "N/m", "K", &Row::stiffness},
      {kRatioColumn, "1", "zeta; empty where it has no part", of_setting(&TuneSetting::damping_ratio)},
      {"mass_kg", "kg", "virtual mass; empty where it is not searched", of_setting(&TuneSetting::mass)},
      {"velocity_filter", "", "of the device, as JSON; empty: the scene's", of_setting(&TuneSetting::filter)},
      {"feasible", "", "true when every constraint is kept", &Row::feasible},
      {"binding", "",
       "the first constraint that is not: settled (at K), margin (up to G K), a limited metric, or runs, the bound on "
       "them",
       &Row::binding},
      {"why", "", "the same in words", &Row::why}};
  for (const char* name : {kTuneMetrics[0], kTuneMetrics[1], kTuneMetrics[2]}) {
    columns.add(
        {{name, name == kTuneMetrics[0] ? "m" : "N", "of the scene's own run at K; empty where it was not asked for",
          [name](const Row& r) { return value_in(r.metrics, name); }}});
  }
  return columns;
}

std::vector<DescribedTable> tune_tables() {
  return {
      tuned_columns().described("tune.csv", "of tune: one line per algorithm"),
      trial_columns().described("tune_trials.csv", "of tune: one line per algorithm, setting and K that was tried")};
}

}  // namespace hapbench
