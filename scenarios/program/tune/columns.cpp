#include "scenarios/program/tune/columns.hpp"

#include <fmt/format.h>

#include <functional>
#include <optional>

#include "scenarios/program/digits.hpp"
#include "scenarios/program/tune/answer.hpp"

namespace hapbench {
namespace {

constexpr const char* kRatioColumn = "rendering.damping_ratio";

/// Returns the columns of the choice and of the constraint that a larger stiffness violates. Their cells are empty
/// without a feasible choice.
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
      {"feasible", "", "true if some stiffness of the search keeps all constraints", feasible},
      {"stiffness_N_per_m", "N/m", "largest stiffness K that keeps all constraints; empty if no stiffness does",
       of_choice(&TuneTrial::stiffness)},
      {"K [N/m]", "N/m", "of tune: largest stiffness that keeps the margin and all bounds [N/m]", stiffness,
       only_printed()},
      {kRatioColumn, "1", "damping ratio zeta of rendering.mass_kg at this K; empty if the search does not vary it",
       of_setting(&TuneSetting::damping_ratio), under("zeta", 3, kOnlyCsv)},
      {"damping_ratio", "1", "damping ratio zeta of rendering.mass_kg at this K; empty if the search does not vary it",
       of_setting(&TuneSetting::damping_ratio), kOnlyJson},
      {"mass_kg", "kg", "virtual mass at this K; empty if the search does not vary it (the scene's mass)",
       of_setting(&TuneSetting::mass)},
      {"velocity_filter", "",
       "velocity filter of the device at this K, as JSON; empty if the search does not vary it (the scene's filter)",
       of_setting(&TuneSetting::filter)},
      {"lambda_max", "1",
       "largest eigenvalue of the mean stiffness tensor S at the end of the run, in units of K; the largest rendered "
       "stiffness is K lambda_max",
       of_choice(&TuneTrial::lambda_max)},
      {"binding", "",
       "binding constraint, the first constraint that a larger K violates: settled, margin, no_force, friction, a "
       "bounded metric, a rule of failure or low vibration, or range (the end of the search range)",
       &Row::binding},
      {"why", "", "explanation of the binding constraint", &Row::why},
      {"relax", "",
       "if no stiffness keeps all constraints: the bound to relax, and its new value, which a second search confirms; "
       "or "
       "the option to change",
       &Row::relax}};
}

}  // namespace

Json bounds_json(const TuneQuestion& question) {
  Json bounds = Json::object();
  for (const auto& [name, bound] : question.limits) {
    if (bound.min) bounds[name]["min"] = *bound.min;
    if (bound.max) bounds[name]["max"] = *bound.max;
  }
  return bounds;
}

Columns<TunedLaw> tuned_columns(const TuneQuestion& question) {
  using Row = TunedLaw;
  Columns<Row> columns = choice_columns();
  for (const Margin& margin : kMargins) {
    columns.add({{margin.column, margin.unit, margin.meaning, [of = margin.of](const Row& r) { return r.margins.*of; },
                  under(margin.heading, 3, kOnlyCsv)}});
  }
  const auto may_fail = [](const Row& r) {
    return r.verified > 0 ? Cell(may_fail_share(kVerificationSamples)) : Cell();
  };
  const auto metric = [](const char* heading, const char* name, double factor) {
    const auto text = [=](const Row& r) {
      const auto value = r.choice ? value_in(r.choice->metrics, name, factor) : std::nullopt;
      return value ? deserved(*value, value_in(r.error, name, factor)) : "-";
    };
    return Columns<Row>::Entry(heading, "unit of the metric", name, text, only_printed());
  };
  columns.add(
      {{"verified", "1",
        fmt::format(
            "number of verification samples: full-length runs between K and G K (G is the margin), all settled, {} of "
            "them just below G K",
            kSamplesNearLimit),
        &Row::verified},
       {"may_fail_share", "1",
        "largest fraction of the values between K and G K that may still be unstable, with 95 % confidence, given the "
        "verification samples",
        may_fail},
       {"runs", "1", "number of simulated runs of the search and the verification", &Row::runs},
       metric("settled\ndepth [mm]", "inside_settled_m", 1e3),
       metric("vibration\n[N rms]", "force_rms_above_30Hz_N", 1.0),
       metric("max force\nstep [N]", "settled_force_step_max_N", 1.0),
       {"bounds", "", "bounds on metrics of the runs at K (--bound), as JSON; empty if none were given",
        [bounds = bounds_json(question)](const Row&) { return bounds.empty() ? Cell() : Cell(bounds.dump()); },
        kOnlyCsv},
       {"binding", "", "of tune: binding constraint, the first constraint that a larger K violates", &Row::binding,
        only_printed()}});
  return columns;
}

Columns<TuneTrial> trial_columns() {
  using Row = TuneTrial;
  const auto of_setting = [](auto member) {
    return [member](const Row& r) { return cell_of(std::invoke(member, r.setting)); };
  };
  Columns<Row> columns = {
      {"algorithm", "", "force algorithm of the trial", &Row::algorithm},
      {"stiffness_N_per_m", "N/m", "K", &Row::stiffness},
      {kRatioColumn, "1", "damping ratio zeta of rendering.mass_kg in the trial; empty if the search does not vary it",
       of_setting(&TuneSetting::damping_ratio)},
      {"mass_kg", "kg", "virtual mass of the trial; empty if the search does not vary it",
       of_setting(&TuneSetting::mass)},
      {"velocity_filter", "",
       "velocity filter of the device in the trial, as JSON; empty if the search does not vary it",
       of_setting(&TuneSetting::filter)},
      {"feasible", "", "true if the trial keeps all constraints", &Row::feasible},
      {"binding", "",
       "first violated constraint that the search found: settled (at K), margin (at stiffnesses up to G K), no_force "
       "(no force is rendered), friction (explicit integration of friction is unstable), a bounded metric, a rule of "
       "failure or low vibration, or runs (the largest number of runs was reached)",
       &Row::binding},
      {"why", "", "explanation of the violated constraint", &Row::why}};
  for (const char* name : {kTuneMetrics[0], kTuneMetrics[1], kTuneMetrics[2]}) {
    columns.add({{name, name == kTuneMetrics[0] ? "m" : "N",
                  "metric of the same name in the scene's own run at K; empty if this run was not made",
                  [name](const Row& r) { return value_in(r.metrics, name); }}});
  }
  return columns;
}

std::vector<DescribedTable> tune_tables() {
  return {tuned_columns({}).described("tune.csv", "written by tune: one line per algorithm"),
          trial_columns().described("tune_trials.csv",
                                    "written by tune: one line per algorithm, setting and stiffness that was tried")};
}

}  // namespace hapbench
