#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>

#include "device_model/device_presets.hpp"
#include "device_model/theory/linear_loops.hpp"
#include "scenarios/format/text_lines.hpp"
#include "scenarios/program/index.hpp"
#include "scenarios/program/limit.hpp"

/// The table of `limit` and what is printed of it.
namespace hapbench {
namespace {

constexpr const char *kInconsistent = "inconsistent_runs", *kAstray = "astray";

Cell value_cell(const std::optional<JudgedValue>& run) {
  return run ? Cell(run->value) : Cell();
}

/// The class of motion just beyond a limit, or "end of the range"; without a limit, the class at the range's low end.
std::string beyond_text(const FieldLimit& limit) {
  if (limit.beyond) return std::string(run_verdict_name(limit.beyond->verdict));
  return limit.value ? "end of the range" : std::string(run_verdict_name(limit.runs.front().verdict));
}
const IntervalEnd& end_of(const LimitRow& r, bool low) {
  return low == r.asked.smallest ? r : r.other;
}

/// A line of limit_runs.csv.
struct LimitRunRow {
  const LimitRow& limit;
  JudgedValue run;

  operator const LimitRow&() const { return limit; }  // NOLINT: what it has of the case
};

/// What tells the cases apart.
template <class Row>
Columns<Row> place_columns(const LimitTable* table) {
  Columns<Row> columns;
  if (table == nullptr || !table->devices.empty()) {
    columns.add(
        "device", "",
        "ideal, admittance, the preset of an impedance device (* with numbers of --set, [soft] and [stiff] at the "
        "ends of what is not published), or a file's",
        [](const LimitRow& r) { return r.device->name; }, {.heading = "device"});
  }
  if (table == nullptr || !table->devices.empty() || table->cases.scenes().size() > 1) {
    columns.add("scenario", "", "name of the scene's file", [](const LimitRow& r) { return r.scene(); },
                {.heading = "scenario"});
  }
  for (std::size_t i = 1; table != nullptr && i <= table->over(); ++i) {
    columns.add(table->cases.axes()[i].path, "by name", "value of the field that varies besides",
                [i](const LimitRow& r) {
                  const auto number = finite_number(r.axis_values[i]);
                  return number ? Cell(*number) : Cell(r.axis_values[i]);
                },
                {.heading = table->cases.axes()[i].path});
  }
  columns.add("algorithm", "", "force algorithm", [](const LimitRow& r) { return r.algorithm(); },
              {.heading = "algorithm"});
  return columns;
}

/// The edge that was asked for and the ends of the interval that it ends. Printed are the linear edge, that in runs,
/// and, of one case alone, the end on the other side.
void add_ends(Columns<LimitRow>& columns, const LimitTable* table) {
  const auto add_end = [&](bool low, const std::string& end, const char* meaning, const std::string& outside,
                           const char* first) {
    const bool shown = table == nullptr || (!table->is_grid() && low != table->first().asked.smallest);
    columns.add(
        end, "by field", meaning, [low](const LimitRow& r) { return end_of(r, low).value; },
        {.heading = shown ? end + " end" : "", .digits = 6},
        [low](const LimitRow& r) { return end_of(r, low).tolerance(); });
    columns.add(outside, "by field", first, [low](const LimitRow& r) { return value_cell(end_of(r, low).beyond); });
    columns.add("class_" + outside, "", "what became of the run there", [low](const LimitRow& r) {
      const auto& run = end_of(r, low).beyond;
      return run ? cell_of(run_verdict_name(run->verdict)) : Cell();
    });
  };
  columns.add(
      "field", "", "path of the field", [](const LimitRow& r) { return r.asked.path; }, only_csv());
  columns.add(
      "side", "", "largest or smallest: the stable value that was asked for",
      [](const LimitRow& r) { return r.asked.side(); }, only_csv());
  columns.print("linear\nedge", "by field", "of limit: theory, or where there is none linear", [](const LimitRow& r) {
    const auto& edge = r.linear_edge();
    return edge && (std::isinf(*edge) || *edge == 0.0) ? "none" : significant(edge, 6);
  });
  columns.add("limit", "by field",
              "the last stable value before the first edge, by bisection on runs; empty when there is none",
              &LimitRow::value, {.heading = "edge in\nruns", .digits = 6}, &LimitRow::tolerance);
  columns.add("beyond", "by field", "the first unstable value beyond it; empty when the range ends stable",
              [](const LimitRow& r) { return value_cell(r.beyond); });
  columns.add("class_beyond", "", "what became of the run there (describe stability), or \"end of the range\"",
              beyond_text, {.heading = "beyond it"});
  add_end(
      true, "low",
      "the low end of the interval of stable values that the limit ends: its smallest stable value, to the resolution",
      "below", "the first value below that is not stable; empty when the range begins stable");
  add_end(false, "high", "the high end of this interval", "above",
          "the first value above that is not stable; empty when the range ends stable");
}

void add_theory(Columns<LimitRow>& columns, bool with_inequality) {
  columns.add("theory", "by field", "the limit in theory; empty where there is none", &LimitRow::theory);
  if (with_inequality) {
    columns.add(
        "closed_form", "by field",
        "the same where the integrator's inequality ends, of leapfrog 4 - 2 lambda B dt / M - lambda K dt^2 / M >= 0 "
        "with lambda = lambda_max(S) (A.3); empty where it has none",
        &LimitRow::closed_form);
  }
  columns.add(
      "linear", "by field",
      "of a device at what only pushes: the largest value at which the loop of device, hand and surface is stable "
      "while they touch, without dry friction and encoder, by its eigenvalues; a limit beyond it is held up by "
      "bounces, dry friction or the end of the run; empty where there is a theory or no device",
      &LimitRow::linear);
}

/// What the literature says of a wall on an impedance device.
void add_closed_forms(Columns<LimitRow>& columns) {
  for (std::size_t i = 0; i < stiffness_limits().size(); ++i) {
    const StiffnessLimit& known = stiffness_limits()[i];
    columns.add(known.name, "N/m",
                fmt::format("the K at which {}; for {} ({})", known.formula, known.applies, known.source),
                [i](const LimitRow& r) { return r.closed_forms.empty() ? Cell() : cell_if(r.closed_forms[i]); });
  }
  columns.add("no_theory", "", "why the eigenvalues of the loop tell nothing; empty where they do",
              &LimitRow::no_theory);
  columns.add("worst_hand", "N/m",
              "least edge over passive hands of 100 to 1000 N/m and 0.1 to 0.5 kg, and none, by eigenvalues",
              &LimitRow::worst_hand);
}

void add_search(Columns<LimitRow>& columns) {
  columns.add("limit_tolerance", "by field", "how far beyond the limit the edge may lie: beyond - limit",
              &LimitRow::tolerance, only_json());
  columns.add(
      "low_tolerance", "by field", "the same of the low end",
      [](const LimitRow& r) { return end_of(r, true).tolerance(); }, only_json());
  columns.add(
      "high_tolerance", "by field", "the same of the high end",
      [](const LimitRow& r) { return end_of(r, false).tolerance(); }, only_json());
  columns.add("undecided", "1", "runs that were too short to tell slow motion from rest, though lengthened",
              &LimitRow::undecided);
  columns.add("unstable_without_contact", "", "true when hand and device alone are unstable beyond the edge",
              &LimitRow::unstable_alone, only_json());
  columns.add("has_effect", "", "false when the field changes no run", &LimitRow::has_effect, only_json());
  columns.add("scattered", "", "true where stable values are scattered and there is no edge", &LimitRow::scattered,
              only_json());
  columns.add("tried_between", "1",
              "values between the ends of the interval that were tried, all stable; 0 in a table of devices or values",
              &LimitRow::tried_between);
  columns.add("may_fail_share", "1", "share of the interval that may be unstable for all that, with 95 % confidence",
              [](const LimitRow& r) { return r.tried_between > 0 ? Cell(may_fail_share(r.tried_between)) : Cell(); });
}

/// Numbers of the run at the limit, for cases to be compared by.
void add_settled(Columns<LimitRow>& columns) {
  const auto settled = [](const LimitRow& r, double value) { return r.value ? Cell(value) : Cell(); };
  columns.add("vibration_m_per_s", "m/s",
              "at the limit: rms of the handle's speed above 30 Hz from a quarter of the contact on",
              [](const LimitRow& r) { return r.value ? cell_if(r.settled.vibration) : Cell(); });
  columns.add("contacts", "1", "at the limit: mean number of rendered contacts there",
              [=](const LimitRow& r) { return settled(r, r.settled.contacts); });
  columns.add("lambda_max", "1", "at the limit: largest eigenvalue of the mean S there",
              [=](const LimitRow& r) { return settled(r, r.settled.lambda_max); });
  columns.add("stiffness_ratio", "1", "limit over that of the first scene with the first algorithm, all else equal",
              &LimitRow::stiffness_ratio);
  columns.add("rendered_ratio", "1", "the same of K lambda_max", &LimitRow::rendered_ratio);
}

Columns<LimitRunRow> run_columns(const LimitTable* table) {
  Columns<LimitRunRow> columns = place_columns<LimitRunRow>(table);
  columns.add(table == nullptr ? "{field}" : table->first().asked.path, "by name", "value of the field",
              [](const LimitRunRow& r) { return r.run.value; });
  columns.add("class", "", "what became of the run (describe stability)",
              [](const LimitRunRow& r) { return run_verdict_name(r.run.verdict); });
  return columns;
}

/// The columns of limit.csv for this table; without one all that there may be, for `describe`.
Columns<LimitRow> limit_columns(const LimitTable* table) {
  Columns<LimitRow> columns = place_columns<LimitRow>(table);
  add_ends(columns, table);
  const auto has_inequality = [](const LimitRow& row) { return row.closed_form.has_value(); };
  add_theory(columns, table == nullptr || std::ranges::any_of(table->rows, has_inequality));
  add_search(columns);
  if (table == nullptr || !table->devices.empty()) {
    columns.add("published_N_per_m", "N/m", "published largest stable stiffness of a wall on the device",
                [](const LimitRow& r) { return r.device->published_stiffness; }, {.heading = "published"});
  }
  if (table == nullptr || table->is_grid()) add_settled(columns);
  const auto has_closed_forms = [](const LimitRow& row) { return !row.closed_forms.empty(); };
  if (table == nullptr || std::ranges::any_of(table->rows, has_closed_forms)) add_closed_forms(columns);
  columns.add("runs", "1", "runs of the search", [](const LimitRow& r) { return r.runs.size(); });
  const auto inconsistent = [](const LimitRow& r) { return r.inconsistent.size(); };
  columns.add(kInconsistent, "1", "runs that are unstable on the stable side of the limit, or stable beyond it",
              inconsistent, {.heading = "inconsistent"});
  columns.add(kAstray, "1", "the same as inconsistent_runs, by its former name", inconsistent);
  return columns;
}

constexpr const char* kBeyondLinear =
    "beyond it stable runs are intermittent contact: bounces below 30 Hz, dry friction or the end of the run hold the "
    "tool, and one that rests on the surface may not be stable";

std::string damping_text(const RenderingConfig& rendering) {
  if (rendering.damping) return fmt::format("B = {} N s/m", significant(*rendering.damping));
  if (rendering.damping_ratio == 0.0) return "no damping is rendered (damping_ratio 0): B = 0 at every K";
  return fmt::format("B = 2 zeta sqrt(K m) with damping_ratio zeta = {} and rendering.mass_kg m = {}",
                     significant(rendering.damping_ratio), significant(rendering.mass));
}

/// The rule as one line.
std::string rule_text(const StabilityRule& rule, const Scenario& scenario) {
  std::string text =
      rule.most_vibration
          ? fmt::format(
                "stable: at most {} m/s rms above {:.0f} Hz at the handle, from a quarter of the contact on, and no "
                "bounces below that go on",
                *rule.most_vibration, kVibrationCutoff)
          : fmt::format("stable: comes to rest or dies out{}", rule.bounded ? ", or vibrates without growing" : "");
  if (!rule.most_vibration && is_moved(scenario))
    text +=
        ", as far as it is above 30 Hz and 1 mm/s, because a script moves the tool; where that ends in the first half of a run, all beyond 1 mm/s from then on";
  for (const auto& [metric, bound] : rule.bounds) {
    if (bound.min) text += fmt::format(", {} >= {}", metric, *bound.min);
    if (bound.max) text += fmt::format(", {} <= {}", metric, *bound.max);
  }
  return text;
}

/// States the question of one scene; `over`: other fields also vary.
std::string question_text(const LimitQuestion& question, const Scenario& scenario, bool over) {
  const std::string width = question.whole ? "1"
                            : question.range.logarithmic
                                ? fmt::format("{} %", 100.0 * question.resolution)
                                : fmt::format("{} % of the range", 100.0 * question.resolution);
  const auto end = [&question](double value) { return significant(question.whole ? std::round(value) : value); };
  std::string text = fmt::format("{}: {} stable {} between {} and {}, to {}", scenario.name, question.side(),
                                 question.path, end(question.range.from), end(question.range.to), width);
  if (!over) text += fmt::format("; {} steps", scenario.time.steps);
  if (!over && question.path != "time.step_s") text += fmt::format(" of {} s", significant(scenario.time.step));
  if (!over && question.path == kStiffnessPath) text += "; " + damping_text(scenario.rendering);
  return wrapped(text, 0);
}

/// Why there is no edge.
std::string none_text(const FieldLimit& limit) {
  std::map<RunVerdict, std::size_t> counts;
  for (const JudgedValue& run : limit.runs) ++counts[run.verdict];
  std::vector<std::string> texts;
  for (const auto& [verdict, count] : counts) texts.push_back(fmt::format("{} {}", count, run_verdict_name(verdict)));
  return fmt::format("{} of {} values tried is stable: {}",
                     limit.scattered
                         ? fmt::format("no edge, stable values are scattered: no stretch of {:g} %", 100.0 * kNear)
                         : "none",
                     limit.runs.size(), fmt::join(texts, ", "));
}

/// Remarks on a limit that is not all of the answer.
std::string remarks_text(const LimitRow& row) {
  const FieldLimit& limit = row;
  const LimitQuestion& question = row.asked;
  std::string text;
  const auto say = [&](const std::string& what) { text += wrapped(row.algorithm() + ": " + what, 0); };
  if (limit.value && limit.own && !question.holds(limit.own->verdict)) {
    say(fmt::format("{} at the scenario's own {}: the edge is that of the first stable values from the {} end",
                    run_verdict_name(limit.own->verdict), significant(limit.own->value),
                    question.smallest ? "high" : "low"));
  }
  if (limit.theory_has_none)
    say(fmt::format("by the eigenvalues of a step no value of the range is stable{}",
                    limit.value ? ": the runs are too short for its growth" : ""));
  if (limit.undecided > 0)
    say(fmt::format("{} runs were too short to tell slow motion from rest, though made up to 64 times as long",
                    limit.undecided));
  if (!limit.has_effect)
    say(fmt::format("{} has no effect here: the handle moves alike in all {} runs", question.path, limit.runs.size()));
  if (limit.unstable_alone)
    say(fmt::format("at {} hand and device are unstable by themselves: the tool also vibrates without contact",
                    significant((limit.beyond ? *limit.beyond : limit.runs.front()).value)));
  return text;
}

/// What is to be known of the numbers, as far as it is of any.
std::string notes_text(const LimitTable& table) {
  const auto any = [&](auto holds) { return std::ranges::any_of(table.rows, holds); };
  const auto is_on_device = [](const LimitRow& row) {
    return std::holds_alternative<ImpedanceDeviceConfig>(row.scenario.device);
  };
  const auto rubs = [](const LimitRow& row) {
    const auto* device = std::get_if<ImpedanceDeviceConfig>(&row.scenario.device);
    return device != nullptr && device->coulomb > 0.0;
  };
  const auto is_beyond_linear = [](const LimitRow& row) { return row.is_beyond_linear(row.asked.resolution); };
  const auto is_published = [](const ComparedDevice& device) { return device.published_stiffness.has_value(); };
  std::string names;
  for (const ComparedDevice& device : table.devices) names += device.name + " ";
  const auto is_marked = [&names](const char* mark) { return names.find(mark) != std::string::npos; };
  const std::pair<bool, std::string> notes[] = {
      {table.is_grid() && any(is_beyond_linear),
       fmt::format("linear edge: of the loop of device, hand and surface while they touch; {}", kBeyondLinear)},
      {table.is_grid(),
       "a table tries no values between those of its searches, as the limit of one scene does. inconsistent: values that "
       "are unstable before an edge or stable beyond it; limit_runs.csv has what becomes of each value"},
      {std::ranges::any_of(table.devices, is_published),
       "published: largest stable stiffness of a wall (\"hapbench describe DEVICE\" names its source)"},
      {is_marked("* "), "*: a preset with numbers of --set, of which nothing is published"},
      {is_marked("[soft]"),
       fmt::format("[soft], [stiff]: the preset at either end of what nobody published of it ({})", kPresetRanges)},
      {is_marked("[friction*"), "[friction*2]: with its dry friction times a factor"},
      {table.first().asked.path == kStiffnessPath && any(is_on_device),
       "which K to quote: device_model/README.md, \"Which K to quote?\""},
      {any(rubs),
       "dry friction, which is ours in every preset, holds a hand that presses slowly: the limit is that of this approach, "
       "not of a device; --set device.coulomb_N=0 shows what is left without"}};
  std::string text;
  for (const auto& [holds, note] : notes)
    if (holds) text += wrapped(note, 0);
  std::vector<std::string> delays;
  if (table.over() == 0)
    for (const LimitRow& row : table.rows) append_new(delays, {delay_note(row.scenario)});
  for (const std::string& delay : delays) text += delay.empty() ? "" : wrapped(delay, 0);
  return text;
}

/// The question of each scene, the answers, and what is to be known of them.
std::string limits_text(const LimitTable& table, const Columns<LimitRow>& columns) {
  std::string text, answers, remarks;
  for (std::size_t i = 0; i < table.columns(); ++i) {
    const LimitRow& row = table.rows[i];
    if (i == 0 || row.scene() != table.rows[i - 1].scene())
      text += question_text(row.asked, row.scenario, table.over() > 0);
    if (table.is_grid()) continue;
    answers += wrapped(fmt::format("{}: {}", row.algorithm(), limit_answer(row, row.asked.resolution)), 0);
    remarks += remarks_text(row);
  }
  const LimitRow& first = table.first();
  return fmt::format("{}\n{}{}{}\n{}{}{}", text, answers, answers.empty() ? "" : "\n", columns.table(table.rows).text(),
                     wrapped(rule_text(first.asked, first.scenario), 0), remarks, notes_text(table));
}

}  // namespace

std::vector<DescribedTable> limit_tables() {
  return {limit_columns(nullptr).described("limit.csv",
                                           "of limit: one line per device, values of --over, scene and algorithm"),
          run_columns(nullptr).described("limit_runs.csv", "of limit: one line per run")};
}

std::string limit_answer(const FieldLimit& found, double resolution) {
  if (!found.value) return none_text(found);
  std::string text = found.beyond
                         ? fmt::format("edge in runs {}", deserved(*found.value, found.tolerance()))
                         : fmt::format("stable in runs to the end of the range, {}", significant(*found.value, 6));
  const auto& linear = found.linear_edge();
  if (linear && std::isfinite(*linear) && *linear > 0.0) {
    const std::string edge = fmt::format("linear edge {}; ", significant(*linear, 6));
    text = edge + (found.is_beyond_linear(resolution) ? fmt::format("{} ({})", kBeyondLinear, text) : text);
  }
  if (found.tried_between == 0) return text;
  return text + fmt::format("; {} values between its ends are also stable: at most {:.0f} % of them may fail (95 %)",
                            found.tried_between, 100.0 * may_fail_share(found.tried_between));
}

void tell_limits(const LimitTable& table, Report& report) {
  const LimitQuestion& question = table.first().asked;
  const Columns<LimitRow> columns = limit_columns(&table);
  std::vector<LimitRunRow> runs;
  Json limits = Json::array();
  for (const LimitRow& row : table.rows) {
    Json inconsistent = Json::array();
    for (const JudgedValue& run : row.inconsistent)
      inconsistent.push_back({{"value", run.value}, {"class", run_verdict_name(run.verdict)}});
    Json& limit = limits.emplace_back(columns.json(row));
    limit[kInconsistent] = limit[kAstray] = inconsistent;
    for (const JudgedValue& run : row.runs) runs.push_back({row, run});
  }
  report.write("limit.csv", columns, table.rows);
  report.write("limit_runs.csv", run_columns(&table), runs);
  report.say(limits_text(table, columns));
  report.json() = {{"field", question.path},
                   {"side", question.side()},
                   {"from", question.range.from},
                   {"to", question.range.to},
                   {"resolution", question.resolution},
                   {"rule", rule_text(question, table.first().scenario)},
                   {"limits", std::move(limits)}};
}

}  // namespace hapbench
