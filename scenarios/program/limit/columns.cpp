#include "scenarios/program/limit/columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "device_model/theory/linear_loops.hpp"
#include "scenarios/analysis/stability/compared_devices.hpp"
#include "scenarios/analysis/stability/limit_theory.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/program/describe/fields.hpp"
#include "scenarios/program/digits.hpp"

namespace hapbench {
namespace {

/// Returns the columns that distinguish the cases: device, scene, fields of --over, algorithm. If `table` is null,
/// returns all columns, for `describe`.
template <class Row>
Columns<Row> case_columns(const LimitTable* table) {
  const bool devices = table == nullptr || !table->devices.empty();
  Columns<Row> columns = {
      {"device", "",
       "device of the row: ideal, admittance, a preset of an impedance device, or a device file; * marks a preset "
       "changed by --set; [soft] and [stiff] mark a preset with all unpublished parameters at one end of their ranges",
       [](const LimitRow& r) { return r.device->name; }, when(devices, under("device"))},
      {"scenario", "", "name of the scenario", [](const LimitRow& r) { return r.scene(); },
       when(devices || table->cases.scenes().size() > 1, under("scenario"))}};
  for (std::size_t i = 1; table != nullptr && i <= table->over(); ++i) {
    const std::string& path = table->cases.axes()[i].path;
    const auto value = [i](const LimitRow& r) { return axis_cell(r.axis_values[i]); };
    columns.add({{path, field_unit(path), "value of the field given by --over", value, varied(under(path))}});
  }
  columns.add(
      {{"algorithm", "", "force algorithm", [](const LimitRow& r) { return r.algorithm(); }, under("algorithm")}});
  return columns;
}

const IntervalEnd& low_end(const LimitRow& row) {
  return row.question.search.smallest ? row.limit.end : row.limit.other;
}
const IntervalEnd& high_end(const LimitRow& row) {
  return row.question.search.smallest ? row.limit.other : row.limit.end;
}

Cell value_beyond(const IntervalEnd& end) {
  return end.beyond ? Cell(end.beyond->value) : Cell();
}
Cell class_beyond(const IntervalEnd& end) {
  return end.beyond ? cell_of(run_verdict_name(end.beyond->verdict)) : Cell();
}
/// Returns the class of motion beyond the limit. If no value is stable, returns the class at the low end of the range.
/// If the values are stable to the end of the range, returns the text "end of the range".
Cell class_beyond_limit(const LimitRow& row) {
  const IntervalEnd& end = row.limit.end;
  if (!end.beyond && !end.value) return cell_of(run_verdict_name(row.limit.runs.front().verdict));
  return end.beyond ? class_beyond(end) : Cell("end of the range");
}

std::string linear_limit_text(const LimitRow& row) {
  const auto& linear = row.limit.known_linear_limit();
  if (!linear) return row.limit.theory_has_none ? "none stable" : "-";
  if (!std::isinf(*linear) && *linear != 0.0)
    return deserved_on_side(*linear, std::nullopt, 6, stable_side(row.question));
  return *linear == limit_without_transition(false, row.question.search.smallest) ? "none stable" : "no end";
}

/// Returns a function that computes the cell of a row: it applies `part` to the row, and `get` to the result.
template <class Part, class Get>
auto of(Part part, Get get) {
  return [part, get](const LimitRow& row) { return cell_of(std::invoke(get, std::invoke(part, row))); };
}

/// Returns the columns of the stability limit, of the stable interval at whose end the limit lies, and of the linear
/// limit. If the limits are not printed as a grid, the other end of the interval is printed too.
Columns<LimitRow> limit_value_columns(const LimitTable* table) {
  const auto is_printed = [table](bool low) {
    return table == nullptr || (!table->is_grid() && low != table->first().question.search.smallest);
  };
  const auto has_inequality = [](const LimitRow& row) { return row.limit.closed_form.has_value(); };
  const auto limit_end = [](const LimitRow& row) -> const IntervalEnd& { return row.limit.end; };
  // Returns the printed tolerance of an end of the stable interval.
  const auto tolerance_of = [](auto end) {
    return [end](const LimitRow& row) { return printed_tolerance(row.question, std::invoke(end, row).tolerance()); };
  };
  const Rounding inwards = table == nullptr ? Rounding::nearest : stable_side(table->first().question);
  const std::string unit = table == nullptr ? "unit of the field" : field_unit(table->first().question.path);
  using Row = LimitRow;
  return {
      {"field", "", "path of the field", of(&Row::question, &LimitQuestion::path), kOnlyCsv},
      {"side", "", "largest or smallest: which stable value was searched", of(&Row::question, &LimitQuestion::side),
       kOnlyCsv},
      {"quoted_limit", unit,
       "limit to quote: the smaller of the linear and the simulated limit (with --smallest the larger); empty if no "
       "limit was found within the range",
       [](const Row& r) { return r.limit.quoted.value; }, rounded(inwards, under("quote", 6)),
       [](const Row& r) { return printed_tolerance(r.question, r.limit.quoted_tolerance()); }},
      {"quoted_reason", "", "reason why quoted_limit has this value or none",
       [](const Row& r) { return r.limit.quoted.reason; }},
      {"linear\nlimit", unit,
       "of limit: theoretical limit; if there is no theoretical limit, the linear limit. \"no end\": stable to the "
       "end of the range; \"none stable\": no value of the range; \"-\": neither limit applies",
       linear_limit_text, only_printed()},
      {"limit", unit,
       "simulated limit: last stable value before the first unstable one, by bisection on simulated runs; empty if no "
       "interval of values is stable, or if the values are stable to the end of the range, which is no limit",
       [](const LimitRow& row) { return row.limit.end.beyond ? row.limit.end.value : std::nullopt; },
       rounded(inwards, under("simulated\nlimit", 6)), tolerance_of(limit_end)},
      {"first_unstable", unit,
       "first unstable value beyond the limit; empty if the values are stable to the end of the range",
       of(limit_end, value_beyond)},
      {"first_unstable_class", "",
       "class of the run at the first unstable value (hapbench describe stability), or \"end of the range\" if there "
       "is no such value",
       class_beyond_limit, under("first\nunstable")},
      {"stable_low", unit,
       "low end of the interval of stable values that contains the limit: smallest stable value, to the resolution",
       of(low_end, &IntervalEnd::value), rounded(Rounding::up, under(is_printed(true) ? "stable\nfrom" : "", 6)),
       tolerance_of(low_end)},
      {"unstable_below", unit,
       "first unstable value below the stable interval; empty if the values are stable to the low end of the range",
       of(low_end, value_beyond)},
      {"unstable_below_class", "", "class of the run at the first unstable value below the stable interval",
       of(low_end, class_beyond)},
      {"stable_high", unit,
       "high end of the interval of stable values that contains the limit: largest stable value, to the resolution",
       of(high_end, &IntervalEnd::value), rounded(Rounding::down, under(is_printed(false) ? "stable\nto" : "", 6)),
       tolerance_of(high_end)},
      {"unstable_above", unit,
       "first unstable value above the stable interval; empty if the values are stable to the high end of the range",
       of(high_end, value_beyond)},
      {"unstable_above_class", "", "class of the run at the first unstable value above the stable interval",
       of(high_end, class_beyond)},
      {"theoretical_limit", unit,
       "theoretical limit for contact that cannot be lost (bilateral springs), from the eigenvalues of one time step, "
       "with or without a device; empty if the theory does not apply",
       of(&Row::limit, &FieldLimit::theory)},
      {"closed_form_limit", unit,
       "closed-form limit: theoretical limit from the integrator's inequality, for leapfrog 4 - 2 lambda B dt / M - "
       "lambda K dt^2 / M >= 0 with lambda = lambda_max(S) (thesis A.3); empty if the integrator has no such "
       "inequality",
       of(&Row::limit, &FieldLimit::closed_form),
       when(table == nullptr || std::ranges::any_of(table->rows, has_inequality))},
      {"linear_limit", unit,
       "linear limit of a tool on a surface that can only push: largest value at which the loop of hand, device and "
       "contact is stable by its eigenvalues, with the derivative of the rendered force at the equilibrium and without "
       "dry friction and encoder steps; empty if contacts come and go in every stable run (no_linear_reason), or if a "
       "theoretical limit exists",
       of(&Row::limit, &FieldLimit::linear)},
      {"no_linear_reason", "", "reason why there is neither a theoretical nor a linear limit; empty if there is one",
       of(&Row::limit, &FieldLimit::no_linear)}};
}

/// Returns the columns that describe the search for the limit, such as tolerances, undecided runs and verification
/// samples. With `grid`, also returns columns with quantities that were measured in the run at the limit, to compare
/// the cells of a grid.
Columns<LimitRow> search_columns(bool devices, bool grid) {
  using Row = LimitRow;
  const auto may_fail = [](const Row& r) {
    if (r.limit.tried_between == 0) return Cell();
    return Cell(r.limit.tried_all ? 0.0 : may_fail_share(r.limit.tried_between));
  };
  const auto settled = [](auto member) {
    return
        [member](const Row& r) { return r.limit.end.value ? cell_of(std::invoke(member, r.limit.settled)) : Cell(); };
  };
  return {
      {"limit_tolerance", "unit of the field",
       "uncertainty of the limit: distance from the limit to the first unstable value (field first_unstable)",
       [](const Row& r) { return r.limit.end.tolerance(); }, kOnlyJson},
      {"low_tolerance", "unit of the field",
       "uncertainty of the low end of the stable interval: distance to the first unstable value below",
       of(low_end, &IntervalEnd::tolerance), kOnlyJson},
      {"high_tolerance", "unit of the field",
       "uncertainty of the high end of the stable interval: distance to the first unstable value above",
       of(high_end, &IntervalEnd::tolerance), kOnlyJson},
      {"undecided_runs", "1",
       "number of runs that were too short to distinguish slow motion from rest, even after they were extended",
       of(&Row::limit, &FieldLimit::undecided)},
      {"unstable_without_contact", "",
       "true if hand and device are unstable beyond the limit even without an environment",
       of(&Row::limit, &FieldLimit::unstable_alone), kOnlyJson},
      {"has_effect", "", "true if the field changes at least one run; false if it has no effect",
       of(&Row::limit, &FieldLimit::has_effect), kOnlyJson},
      {"no_contiguous_interval", "",
       "true if stable and unstable values alternate, so that there is no contiguous stable interval and no limit",
       of(&Row::limit, &FieldLimit::scattered), kOnlyJson},
      {"tried_between", "1",
       "number of verification samples: extra values between the ends of the stable interval, all found stable; 0 with "
       "--device or --over, whose searches have no verification",
       of(&Row::limit, &FieldLimit::tried_between)},
      {"may_fail_share", "1",
       "largest fraction of the stable interval that may still be unstable, with 95 % confidence, given the "
       "verification samples; empty without them",
       may_fail},
      {"published_N_per_m", "N/m",
       "largest stable stiffness of a wall on the device, as published; empty if none is published",
       of(&Row::device, &ComparedDevice::published_stiffness), when(devices, under("published"))},
      {"vibration_m_per_s", "m/s",
       "vibration at the limit: rms of the handle's speed above 30 Hz after the first quarter of the contact time",
       settled(&SettledState::vibration), when(grid)},
      {"touch_speed_m_per_s", "m/s", "speed of the handle at the first contact in the run at the limit",
       settled(&SettledState::touch_speed)},
      {"hand_force_max_N", "N", "largest force of the hand in the run at the limit",
       settled(&SettledState::hand_force_max)},
      {"contacts", "1", "mean number of rendered contacts in the run at the limit", settled(&SettledState::contacts),
       when(grid)},
      {"lambda_max", "1", "largest eigenvalue of the mean stiffness tensor S in the run at the limit, in units of K",
       settled(&SettledState::lambda_max), when(grid)},
      {"stiffness_ratio", "1",
       "limit divided by the limit of the first scene with the first algorithm, for the same device and the same "
       "values of --over",
       &Row::stiffness_ratio, when(grid)},
      {"rendered_ratio", "1",
       "rendered stiffness K lambda_max at the limit, divided by its value for the first scene with the first "
       "algorithm, for the same device and the same values of --over",
       &Row::rendered_ratio, when(grid)}};
}

}  // namespace

Columns<LimitRow> limit_columns(const LimitTable* table) {
  using Row = LimitRow;
  Columns<Row> columns = case_columns<Row>(table);
  columns.add(limit_value_columns(table));
  columns.add(search_columns(table == nullptr || !table->devices.empty(), table == nullptr || table->is_grid()));
  const auto has_forms = [](const Row& r) { return !r.limit.closed_forms.empty(); };
  // Add the closed-form limits of a wall on an impedance device if a case has them.
  const bool forms = table == nullptr || std::ranges::any_of(table->rows, has_forms);
  for (std::size_t i = 0; i < stiffness_limits().size(); ++i) {
    const StiffnessLimit& known = stiffness_limits()[i];
    columns.add(
        {{known.name, "N/m",
          fmt::format("limit of K by the formula {}; it applies to {} ({})", known.formula, known.applies,
                      known.source),
          [i](const Row& r) { return r.limit.closed_forms.empty() ? Cell() : cell_of(r.limit.closed_forms[i]); },
          when(forms)}});
  }
  const auto inconsistent = [](const Row& r) { return r.limit.inconsistent.size(); };
  columns.add(
      {{"no_theory_reason", "", "reason why the linear theory does not apply to the contact loop; empty if it applies",
        of(&Row::limit, &FieldLimit::no_theory), when(forms)},
       {"worst_hand_limit", "N/m",
        "smallest linear limit over nine passive hands (100 to 1000 N/m, 0.1 to 0.5 kg) and the case without a hand; "
        "empty if the linear theory does not apply",
        of(&Row::limit, &FieldLimit::worst_hand), when(forms)},
       {"runs", "1", "number of simulated runs of the search", [](const Row& r) { return r.limit.runs.size(); }},
       {kNonMonotonic, "1",
        "number of non-monotonic runs: unstable runs on the stable side of the limit, and stable runs beyond it",
        inconsistent, under("non-\nmonotonic")}});
  return columns;
}

Columns<LimitRunRow> limit_run_columns(const LimitTable* table) {
  Columns<LimitRunRow> columns = case_columns<LimitRunRow>(table);
  columns.add({{table == nullptr ? "{field}" : table->first().question.path, "unit of the field",
                "value of the field in the run", [](const LimitRunRow& r) { return r.run.value; }},
               {"class", "", "class of the run (hapbench describe stability)",
                [](const LimitRunRow& r) { return run_verdict_name(r.run.verdict); }}});
  return columns;
}

std::vector<DescribedTable> limit_tables() {
  return {limit_columns(nullptr).described(
              "limit.csv", "written by limit: one line per device, value of --over, scene and algorithm"),
          limit_run_columns(nullptr).described("limit_runs.csv", "written by limit: one line per run")};
}

}  // namespace hapbench
