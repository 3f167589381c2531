#include "scenarios/program/limit_cases.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "device_model/theory/stiffness_limits.hpp"
#include "scenarios/input/text_lines.hpp"

namespace hapbench {
namespace {

constexpr const char *kInconsistent = "inconsistent_runs", *kAstray = "astray";

Cell verdict_cell(const std::optional<JudgedValue>& run) {
  return run ? Cell(std::string(run_verdict_name(run->verdict))) : Cell();
}
Cell value_cell(const std::optional<JudgedValue>& run) {
  return run ? Cell(run->value) : Cell();
}

/// The class of motion just beyond a limit, or "end of the range"; without a limit, the class at the range's low end.
std::string beyond_text(const FieldLimit& limit) {
  if (limit.beyond) return std::string(run_verdict_name(limit.beyond->verdict));
  return limit.value ? "end of the range" : std::string(run_verdict_name(limit.runs.front().verdict));
}
/// The low and the high end of the interval of stable values.
struct Ends {
  const std::optional<double>&low, &high;
  const std::optional<JudgedValue>&below, &above;
  std::optional<double> low_tolerance, high_tolerance;
};
Ends ends_of(const LimitRow& r) {
  const FieldLimit& l = r.found;
  if (r.asked.question.smallest)
    return {l.value, l.other_value, l.beyond, l.other_beyond, l.tolerance(), l.other_tolerance()};
  return {l.other_value, l.value, l.other_beyond, l.beyond, l.other_tolerance(), l.tolerance()};
}

/// A line of limit_runs.csv.
struct LimitRunRow {
  const LimitRow& limit;
  JudgedValue run;
};
const LimitRow& place_of(const LimitRow& row) {
  return row;
}
const LimitRow& place_of(const LimitRunRow& row) {
  return row.limit;
}

/// What tells the cases apart.
template <class Row>
Columns<Row> place_columns(const LimitTable* table) {
  Columns<Row> columns;
  if (table == nullptr || table->has_devices) {
    columns.add(
        "device", "",
        "ideal, admittance, the preset of an impedance device (* with numbers of --set, [soft] and [stiff] at the "
        "ends of what is not published), or a file's",
        [](const Row& r) -> Cell { return place_of(r).device->name; });
  }
  if (table == nullptr || table->has_devices || table->scenes.size() > 1) {
    columns.add("scenario", "", "name of the scene's file", [](const Row& r) -> Cell { return place_of(r).scene; },
                {.heading = table == nullptr ? "" : "scenario"});
  }
  for (std::size_t i = 0; table != nullptr && i < table->over.size(); ++i) {
    columns.add(table->over[i], "by name", "value of the field that varies besides", [i](const Row& r) -> Cell {
      const std::string& value = place_of(r).values[i];
      const auto number = finite_number(value);
      return number ? Cell(*number) : Cell(value);
    });
  }
  columns.add("algorithm", "", "force algorithm", [](const Row& r) -> Cell { return place_of(r).found.algorithm; },
              {.heading = "algorithm"});
  return columns;
}

/// The edge that was asked for and the ends of the interval that it ends. Printed is the end on the other side, too.
void add_ends(Columns<LimitRow>& columns, const LimitTable* table) {
  const bool smallest = table != nullptr && table->first().asked.question.smallest;
  const auto printed_if = [](bool shown, const char* heading) {
    return Shown{.heading = shown ? heading : "", .digits = 6};
  };
  const bool low = table == nullptr || !smallest, high = table == nullptr || smallest;
  columns.add(
      "field", "", "path of the field", [](const LimitRow& r) -> Cell { return r.asked.question.path; }, only_csv());
  columns.add(
      "side", "", "largest or smallest: the stable value that was asked for",
      [](const LimitRow& r) -> Cell { return r.asked.question.smallest ? "smallest" : "largest"; }, only_csv());
  columns.add(
      "limit", "by field",
      "the last stable value before the first edge, by bisection on runs; empty when there is none",
      [](const LimitRow& r) { return cell_if(r.found.value); }, printed_if(true, "first edge"),
      [](const LimitRow& r) { return r.found.tolerance(); });
  columns.add("beyond", "by field", "the first unstable value beyond it; empty when the range ends stable",
              [](const LimitRow& r) { return value_cell(r.found.beyond); });
  columns.add(
      "class_beyond", "", "what became of the run there (describe stability), or \"end of the range\"",
      [](const LimitRow& r) -> Cell { return beyond_text(r.found); }, printed_if(true, "beyond it"));
  columns.add(
      "low", "by field",
      "the low end of the interval of stable values that the limit ends: its smallest stable value, to the resolution",
      [](const LimitRow& r) { return cell_if(ends_of(r).low); }, printed_if(low, "low end"),
      [](const LimitRow& r) { return ends_of(r).low_tolerance; });
  columns.add("below", "by field", "the first value below that is not stable; empty when the range begins stable",
              [](const LimitRow& r) { return value_cell(ends_of(r).below); });
  columns.add(
      "class_below", "", "what became of the run there",
      [](const LimitRow& r) { return verdict_cell(ends_of(r).below); }, printed_if(low, "below it"));
  columns.add(
      "high", "by field", "the high end of this interval", [](const LimitRow& r) { return cell_if(ends_of(r).high); },
      printed_if(high, "high end"), [](const LimitRow& r) { return ends_of(r).high_tolerance; });
  columns.add("above", "by field", "the first value above that is not stable; empty when the range ends stable",
              [](const LimitRow& r) { return value_cell(ends_of(r).above); });
  columns.add(
      "class_above", "", "what became of the run there",
      [](const LimitRow& r) { return verdict_cell(ends_of(r).above); }, printed_if(high, "above it"));
}

void add_theory(Columns<LimitRow>& columns, bool with_inequality) {
  columns.add("theory", "by field", "the limit in theory; empty where there is none",
              [](const LimitRow& r) { return cell_if(r.found.theory); });
  if (with_inequality) {
    columns.add(
        "closed_form", "by field",
        "the same where the integrator's inequality ends, of leapfrog 4 - 2 lambda B dt / M - lambda K dt^2 / M >= 0 "
        "with lambda = lambda_max(S) (A.3); empty where it has none",
        [](const LimitRow& r) { return cell_if(r.found.closed_form); });
  }
  columns.add(
      "linear", "by field",
      "of a device at what only pushes: the largest value at which the loop of device, hand and surface is stable "
      "while they touch, without dry friction and encoder, by its eigenvalues; a limit beyond it is held up by "
      "bounces, dry friction or the end of the run; empty where there is a theory or no device",
      [](const LimitRow& r) { return cell_if(r.found.linear); });
  columns.add(
      "", "by field", "theory",
      [](const LimitRow& r) -> Cell {
        const auto& value = r.found.theory;
        return !value ? "-" : std::isinf(*value) || *value == 0.0 ? "none" : significant(*value, 6);
      },
      only_printed("theory"));
  columns.add(
      "", "%", "first edge / theory - 1, in percent",
      [](const LimitRow& r) -> Cell {
        const auto difference = r.found.difference(), tolerance = r.found.tolerance();
        if (!difference) return "-";
        return deserved_difference(
            100.0 * *difference,
            tolerance ? std::optional(100.0 * *tolerance / std::abs(*r.found.value)) : std::nullopt);
      },
      only_printed("off theory %"));
}

/// What the literature says of a wall on an impedance device.
void add_closed_forms(Columns<LimitRow>& columns) {
  for (std::size_t i = 0; i < stiffness_limits().size(); ++i) {
    const StiffnessLimit& known = stiffness_limits()[i];
    columns.add(
        known.name, "N/m", fmt::format("the K at which {}; for {} ({})", known.formula, known.applies, known.source),
        [i](const LimitRow& r) { return r.found.closed_forms.empty() ? Cell() : cell_if(r.found.closed_forms[i]); });
  }
  columns.add("no_theory", "", "why the eigenvalues of the loop tell nothing; empty where they do",
              [](const LimitRow& r) -> Cell { return r.found.no_theory; });
  columns.add("worst_hand", "N/m",
              "least edge over passive hands of 100 to 1000 N/m and 0.1 to 0.5 kg, and none, by eigenvalues",
              [](const LimitRow& r) { return cell_if(r.found.worst_hand); });
}

void add_search(Columns<LimitRow>& columns) {
  columns.add(
      "limit_tolerance", "by field", "how far beyond the limit the edge may lie: beyond - limit",
      [](const LimitRow& r) { return cell_if(r.found.tolerance()); }, only_json());
  columns.add(
      "low_tolerance", "by field", "the same of the low end",
      [](const LimitRow& r) { return cell_if(ends_of(r).low_tolerance); }, only_json());
  columns.add(
      "high_tolerance", "by field", "the same of the high end",
      [](const LimitRow& r) { return cell_if(ends_of(r).high_tolerance); }, only_json());
  columns.add("undecided", "1", "runs that were too short to tell slow motion from rest, though lengthened",
              [](const LimitRow& r) -> Cell { return std::uint64_t{r.found.undecided}; });
  columns.add(
      "unstable_without_contact", "", "true when hand and device alone are unstable beyond the edge",
      [](const LimitRow& r) -> Cell { return r.found.unstable_alone; }, only_json());
  columns.add(
      "has_effect", "", "false when the field changes no run",
      [](const LimitRow& r) -> Cell { return r.found.has_effect; }, only_json());
}

/// Numbers of the run at the limit, for cases to be compared by.
void add_settled(Columns<LimitRow>& columns) {
  const auto settled = [](const LimitRow& r, double value) { return r.found.value ? Cell(value) : Cell(); };
  columns.add("vibration_m_per_s", "m/s",
              "at the limit: rms of the handle's speed above 30 Hz in the last quarter of the run",
              [](const LimitRow& r) { return r.found.value ? cell_if(r.found.settled.vibration) : Cell(); });
  columns.add("contacts", "1", "at the limit: mean number of rendered contacts there",
              [=](const LimitRow& r) { return settled(r, r.found.settled.contacts); });
  columns.add("lambda_max", "1", "at the limit: largest eigenvalue of the mean S there",
              [=](const LimitRow& r) { return settled(r, r.found.settled.lambda_max); });
  columns.add("stiffness_ratio", "1", "limit over that of the first scene with the first algorithm, all else equal",
              [](const LimitRow& r) { return cell_if(r.stiffness_ratio); });
  columns.add("rendered_ratio", "1", "the same of K lambda_max",
              [](const LimitRow& r) { return cell_if(r.rendered_ratio); });
}

Columns<LimitRunRow> run_columns(const LimitTable* table) {
  Columns<LimitRunRow> columns = place_columns<LimitRunRow>(table);
  columns.add(table == nullptr ? "{field}" : table->first().asked.question.path, "by name", "value of the field",
              [](const LimitRunRow& r) -> Cell { return r.run.value; });
  columns.add("class", "", "what became of the run (describe stability)",
              [](const LimitRunRow& r) -> Cell { return std::string(run_verdict_name(r.run.verdict)); });
  return columns;
}

Json row_json(const Columns<LimitRow>& columns, const LimitRow& row) {
  Json json = columns.json(row);
  Json inconsistent = Json::array();
  for (const JudgedValue& run : row.found.inconsistent)
    inconsistent.push_back({{"value", run.value}, {"class", run_verdict_name(run.verdict)}});
  json[kInconsistent] = json[kAstray] = inconsistent;
  return json;
}

}  // namespace

Columns<LimitRow> limit_columns(const LimitTable* table) {
  Columns<LimitRow> columns = place_columns<LimitRow>(table);
  add_ends(columns, table);
  const auto has_inequality = [](const LimitRow& row) { return row.found.closed_form.has_value(); };
  add_theory(columns, table == nullptr || std::ranges::any_of(table->rows, has_inequality));
  add_search(columns);
  if (table == nullptr || table->has_devices) {
    columns.add("published_N_per_m", "N/m", "published largest stable stiffness of a wall on the device",
                [](const LimitRow& r) { return cell_if(r.device->published_stiffness); });
  }
  if (table == nullptr || table->is_grid()) add_settled(columns);
  const auto has_closed_forms = [](const LimitRow& row) { return !row.found.closed_forms.empty(); };
  if (table == nullptr || std::ranges::any_of(table->rows, has_closed_forms)) add_closed_forms(columns);
  columns.add("runs", "1", "runs of the search",
              [](const LimitRow& r) -> Cell { return std::uint64_t{r.found.runs.size()}; }, {.heading = "runs"});
  const auto inconsistent = [](const LimitRow& r) -> Cell { return std::uint64_t{r.found.inconsistent.size()}; };
  columns.add(kInconsistent, "1", "runs that are unstable on the stable side of the limit, or stable beyond it",
              inconsistent, {.heading = "inconsistent"});
  columns.add(kAstray, "1", "the same as inconsistent_runs, by its former name", inconsistent);
  return columns;
}

std::vector<DescribedTable> limit_tables() {
  DescribedTable limits = limit_columns(nullptr).described(
      "limit.csv", "of limit: one line per device, values of --over, scene and algorithm");
  limits.headings.push_back({"pub-\nlished", true, "published_N_per_m"});
  return {limits, run_columns(nullptr).described("limit_runs.csv", "of limit: one line per run")};
}

void tell_limits(const LimitTable& table, Report& report) {
  const LimitQuestion& question = table.first().asked.question;
  const Columns<LimitRow> columns = limit_columns(&table);
  std::vector<LimitRunRow> runs;
  Json limits = Json::array();
  for (const LimitRow& row : table.rows) {
    limits.push_back(row_json(columns, row));
    for (const JudgedValue& run : row.found.runs) runs.push_back({row, run});
  }
  report.write("limit.csv", columns, table.rows);
  report.write("limit_runs.csv", run_columns(&table), runs);
  report.say(limit_text(table));
  report.json() = {{"field", question.path},
                   {"side", question.smallest ? "smallest" : "largest"},
                   {"from", question.range.from},
                   {"to", question.range.to},
                   {"resolution", question.resolution},
                   {"rule", rule_text(question, is_moved(table.first().scenario))},
                   {"limits", std::move(limits)}};
}

}  // namespace hapbench
