#include "scenarios/program/limit/columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "device_model/theory/linear_loops.hpp"
#include "scenarios/analysis/stability/compared_devices.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/program/digits.hpp"

namespace hapbench {
namespace {

/// Returns the columns that distinguish the cases: device, scene, fields of --over, algorithm. Null: all
/// columns, for `describe`.
template <class Row>
Columns<Row> place_columns(const LimitTable* table) {
  const bool devices = table == nullptr || !table->devices.empty();
  Columns<Row> columns = {
      {"device", "",
       "ideal, admittance, the preset of an impedance device (* with numbers of --set, [soft] and [stiff] at the ends "
       "of what is not published), or a file's",
       [](const LimitRow& r) { return r.device->name; }, when(devices, under("device"))},
      {"scenario", "", "name of the scene's file", [](const LimitRow& r) { return r.scene(); },
       when(devices || table->cases.scenes().size() > 1, under("scenario"))}};
  for (std::size_t i = 1; table != nullptr && i <= table->over(); ++i) {
    const std::string& path = table->cases.axes()[i].path;
    const auto value = [i](const LimitRow& r) {
      const auto number = finite_number(r.axis_values[i]);
      return number ? Cell(*number) : Cell(r.axis_values[i]);
    };
    columns.add({{path, "by name", "value of the field that varies besides", value, under(path)}});
  }
  columns.add(
      {{"algorithm", "", "force algorithm", [](const LimitRow& r) { return r.algorithm(); }, under("algorithm")}});
  return columns;
}

const IntervalEnd& low_end(const LimitRow& row) {
  return row.asked.search.smallest ? row.limit.end : row.limit.other;
}
const IntervalEnd& high_end(const LimitRow& row) {
  return row.asked.search.smallest ? row.limit.other : row.limit.end;
}

Cell value_beyond(const IntervalEnd& end) {
  return end.beyond ? Cell(end.beyond->value) : Cell();
}
Cell class_beyond(const IntervalEnd& end) {
  return end.beyond ? cell_of(run_verdict_name(end.beyond->verdict)) : Cell();
}
/// Returns the class of motion beyond the limit. Without a limit, returns the class at the low end of the
/// range.
Cell class_beyond_limit(const LimitRow& row) {
  const IntervalEnd& end = row.limit.end;
  if (!end.beyond && !end.value) return cell_of(run_verdict_name(row.limit.runs.front().verdict));
  return end.beyond ? class_beyond(end) : Cell("end of the range");
}

std::string linear_edge_text(const LimitRow& row) {
  const auto& edge = row.limit.linear_edge();
  if (!edge) return "-";
  return std::isinf(*edge) || *edge == 0.0 ? "none" : significant(*edge, 6);
}

/// Returns a function of a row that applies `get` to a part of the row.
template <class Part, class Get>
auto of(Part part, Get get) {
  return [part, get](const LimitRow& row) { return cell_of(std::invoke(get, std::invoke(part, row))); };
}

/// Returns the columns of the stability limit, of the stable interval that it ends, and of the linear limit. A
/// single case also prints the other end of the interval.
Columns<LimitRow> edge_columns(const LimitTable* table) {
  const auto is_printed = [table](bool low) {
    return table == nullptr || (!table->is_grid() && low != table->first().asked.search.smallest);
  };
  const auto has_inequality = [](const LimitRow& row) { return row.limit.closed_form.has_value(); };
  const auto limit_end = [](const LimitRow& row) -> const IntervalEnd& { return row.limit.end; };
  const auto tolerance = [](const LimitRow& row) { return row.limit.end.tolerance(); };
  using Row = LimitRow;
  return {
      {"field", "", "path of the field", of(&Row::asked, &LimitQuestion::path), kOnlyCsv},
      {"side", "", "largest or smallest: the stable value that was asked for", of(&Row::asked, &LimitQuestion::side),
       kOnlyCsv},
      {"linear\nedge", "by field", "of limit: theory, or where there is none linear", linear_edge_text, only_printed()},
      {"limit", "by field",
       "the last stable value before the first edge, by bisection on runs; empty when there is none",
       of(limit_end, &IntervalEnd::value), under("edge in\nruns", 6), tolerance},
      {"beyond", "by field", "the first unstable value beyond it; empty when the range ends stable",
       of(limit_end, value_beyond)},
      {"class_beyond", "", "what became of the run there (describe stability), or \"end of the range\"",
       class_beyond_limit, under("beyond it")},
      {"low", "by field",
       "the low end of the interval of stable values that the limit ends: its smallest stable value, to the "
       "resolution",
       of(low_end, &IntervalEnd::value), under(is_printed(true) ? "low end" : "", 6),
       [](const Row& r) { return low_end(r).tolerance(); }},
      {"below", "by field", "the first value below that is not stable; empty when the range begins stable",
       of(low_end, value_beyond)},
      {"class_below", "", "what became of the run there", of(low_end, class_beyond)},
      {"high", "by field", "the high end of this interval", of(high_end, &IntervalEnd::value),
       under(is_printed(false) ? "high end" : "", 6), [](const Row& r) { return high_end(r).tolerance(); }},
      {"above", "by field", "the first value above that is not stable; empty when the range ends stable",
       of(high_end, value_beyond)},
      {"class_above", "", "what became of the run there", of(high_end, class_beyond)},
      {"theory", "by field", "the limit in theory; empty where there is none", of(&Row::limit, &FieldLimit::theory)},
      {"closed_form", "by field",
       "the same where the integrator's inequality ends, of leapfrog 4 - 2 lambda B dt / M - lambda K dt^2 / M >= 0 "
       "with lambda = lambda_max(S) (A.3); empty where it has none",
       of(&Row::limit, &FieldLimit::closed_form),
       when(table == nullptr || std::ranges::any_of(table->rows, has_inequality))},
      {"linear", "by field",
       "of a device at what only pushes: the largest value at which the loop of device, hand and surface is stable "
       "while they touch, without dry friction and encoder, by its eigenvalues; a limit beyond it is held up by "
       "bounces, dry friction or the end of the run; empty where there is a theory or no device",
       of(&Row::limit, &FieldLimit::linear)}};
}

/// Returns the columns of the search's diagnostics. `grid` adds numbers of the run at the limit, for comparing
/// cases.
Columns<LimitRow> search_columns(bool devices, bool grid) {
  using Row = LimitRow;
  const auto may_fail = [](const Row& r) {
    return r.limit.tried_between > 0 ? Cell(may_fail_share(r.limit.tried_between)) : Cell();
  };
  const auto settled = [](auto member) {
    return
        [member](const Row& r) { return r.limit.end.value ? cell_of(std::invoke(member, r.limit.settled)) : Cell(); };
  };
  return {
      {"limit_tolerance", "by field", "how far beyond the limit the edge may lie: beyond - limit",
       [](const Row& r) { return r.limit.end.tolerance(); }, kOnlyJson},
      {"low_tolerance", "by field", "the same of the low end", of(low_end, &IntervalEnd::tolerance), kOnlyJson},
      {"high_tolerance", "by field", "the same of the high end", of(high_end, &IntervalEnd::tolerance), kOnlyJson},
      {"undecided", "1", "runs that were too short to tell slow motion from rest, though lengthened",
       of(&Row::limit, &FieldLimit::undecided)},
      {"unstable_without_contact", "", "true when hand and device alone are unstable beyond the edge",
       of(&Row::limit, &FieldLimit::unstable_alone), kOnlyJson},
      {"has_effect", "", "false when the field changes no run", of(&Row::limit, &FieldLimit::has_effect), kOnlyJson},
      {"scattered", "", "true where stable values are scattered and there is no edge",
       of(&Row::limit, &FieldLimit::scattered), kOnlyJson},
      {"tried_between", "1",
       "values between the ends of the interval that were tried, all stable; 0 in a table of devices or values",
       of(&Row::limit, &FieldLimit::tried_between)},
      {"may_fail_share", "1", "share of the interval that may be unstable for all that, with 95 % confidence",
       may_fail},
      {"published_N_per_m", "N/m", "published largest stable stiffness of a wall on the device",
       of(&Row::device, &ComparedDevice::published_stiffness), when(devices, under("published"))},
      {"vibration_m_per_s", "m/s",
       "at the limit: rms of the handle's speed above 30 Hz from a quarter of the contact on",
       settled(&SettledState::vibration), when(grid)},
      {"contacts", "1", "at the limit: mean number of rendered contacts there", settled(&SettledState::contacts),
       when(grid)},
      {"lambda_max", "1", "at the limit: largest eigenvalue of the mean S there", settled(&SettledState::lambda_max),
       when(grid)},
      {"stiffness_ratio", "1", "limit over that of the first scene with the first algorithm, all else equal",
       &Row::stiffness_ratio, when(grid)},
      {"rendered_ratio", "1", "the same of K lambda_max", &Row::rendered_ratio, when(grid)}};
}

}  // namespace

Columns<LimitRow> limit_columns(const LimitTable* table) {
  using Row = LimitRow;
  Columns<Row> columns = place_columns<Row>(table);
  columns.add(edge_columns(table));
  columns.add(search_columns(table == nullptr || !table->devices.empty(), table == nullptr || table->is_grid()));
  const auto has_forms = [](const Row& r) { return !r.limit.closed_forms.empty(); };
  // Add the closed-form limits of a wall on an impedance device if a case has them.
  const bool forms = table == nullptr || std::ranges::any_of(table->rows, has_forms);
  for (std::size_t i = 0; i < stiffness_limits().size(); ++i) {
    const StiffnessLimit& known = stiffness_limits()[i];
    columns.add(
        {{known.name, "N/m", fmt::format("the K at which {}; for {} ({})", known.formula, known.applies, known.source),
          [i](const Row& r) { return r.limit.closed_forms.empty() ? Cell() : cell_of(r.limit.closed_forms[i]); },
          when(forms)}});
  }
  const auto inconsistent = [](const Row& r) { return r.limit.inconsistent.size(); };
  columns.add({{"no_theory", "", "why the eigenvalues of the loop tell nothing; empty where they do",
                of(&Row::limit, &FieldLimit::no_theory), when(forms)},
               {"worst_hand", "N/m",
                "least edge over passive hands of 100 to 1000 N/m and 0.1 to 0.5 kg, and none, by eigenvalues",
                of(&Row::limit, &FieldLimit::worst_hand), when(forms)},
               {"runs", "1", "runs of the search", [](const Row& r) { return r.limit.runs.size(); }},
               {kInconsistent, "1", "runs that are unstable on the stable side of the limit, or stable beyond it",
                inconsistent, under("inconsistent")},
               {kAstray, "1", "the same as inconsistent_runs, by its former name", inconsistent}});
  return columns;
}

Columns<LimitRunRow> limit_run_columns(const LimitTable* table) {
  Columns<LimitRunRow> columns = place_columns<LimitRunRow>(table);
  columns.add({{table == nullptr ? "{field}" : table->first().asked.path, "by name", "value of the field",
                [](const LimitRunRow& r) { return r.run.value; }},
               {"class", "", "what became of the run (describe stability)",
                [](const LimitRunRow& r) { return run_verdict_name(r.run.verdict); }}});
  return columns;
}

std::vector<DescribedTable> limit_tables() {
  return {limit_columns(nullptr).described("limit.csv",
                                           "of limit: one line per device, values of --over, scene and algorithm"),
          limit_run_columns(nullptr).described("limit_runs.csv", "of limit: one line per run")};
}

}  // namespace hapbench
