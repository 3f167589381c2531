#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>

#include "results/io/table_writer.hpp"
#include "scenarios/description/bundled_scenarios.hpp"
#include "scenarios/description/load_scenario.hpp"
#include "scenarios/description/metric_sections.hpp"
#include "scenarios/description/writer.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/program/compare_devices.hpp"
#include "scenarios/program/limit.hpp"
#include "scenarios/program/result_tables.hpp"
#include "scenarios/program/table.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/studies/stability/field_limit.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

struct LimitOptions {
  std::string scenario;
  std::string field;
  std::string between;
  std::string resolution;
  std::string vibration;
  std::vector<std::string> bounds;
  bool smallest = false;
  std::vector<std::string> algorithms;
  unsigned jobs = 0;  ///< 0: as many as the machine has
  std::string out;
  std::vector<std::string> overrides;
  OutputOptions output;
};

}  // namespace

std::optional<Range> range_of(const char* option, const std::string& text) {
  if (text.empty()) return std::nullopt;
  const Words ends = parts_of(text, ':');
  const auto from = finite_number(ends.front()), to = finite_number(ends.back());
  if (ends.size() != 2 || !from || !to || !(*from < *to)) {
    throw InputError(fmt::format("{}: got \"{}\"; allowed: a:b with numbers a < b", option, text));
  }
  return Range{*from, *to};
}

double number_between(const char* option, const std::string& text, double least, double most) {
  const auto number = finite_number(text);
  if (number && *number >= least && *number <= most) return *number;
  throw InputError(fmt::format("{}: got \"{}\"; allowed: {} ... {}", option, text, least, most));
}

std::string beyond_text(const FieldLimit& limit) {
  if (limit.beyond) return std::string(run_verdict_name(limit.beyond->verdict));
  return limit.value ? "end of the range" : std::string(run_verdict_name(limit.runs.front().verdict));
}

std::string other_beyond_text(const FieldLimit& limit) {
  if (limit.other_beyond) return std::string(run_verdict_name(limit.other_beyond->verdict));
  return limit.value ? "end of the range" : "-";
}

std::string none_text(const FieldLimit& limit) {
  std::map<RunVerdict, std::size_t> counts;
  for (const JudgedValue& run : limit.runs) ++counts[run.verdict];
  std::vector<std::string> texts;
  for (const auto& [verdict, count] : counts) texts.push_back(fmt::format("{} {}", count, run_verdict_name(verdict)));
  return fmt::format("none of {} values tried is stable: {}", limit.runs.size(), fmt::join(texts, ", "));
}

double vibration_of(const std::string& text) {
  return number_between("--vibration", text, 1e-9, 1e3);
}

double resolution_of(const std::string& text) {
  return number_between("--resolution", text, 1e-6, 0.5);
}

void add_bound(const std::string& text, std::map<std::string, MetricBound>& bounds) {
  const Words parts = parts_of(text, '=');
  if (parts.size() == 2) {
    require_names("--bound: got", {std::string(parts[0])}, metric_names());
    const Words ends = parts_of(parts[1], ':');
    const auto least = finite_number(ends.front()), most = finite_number(ends.back());
    if (ends.size() <= 2 && least && most && *least <= *most) {
      MetricBound& bound = bounds[std::string(parts[0])];
      bound.max = *most;
      if (ends.size() == 2) bound.min = *least;
      return;
    }
  }
  throw InputError(
      fmt::format("--bound: got \"{}\"; allowed: metric=most or metric=least:most, as inside_settled_m=3e-4", text));
}

namespace {

LimitQuestion question_of(const LimitOptions& options, const ScenarioText& scenario) {
  if (options.field.find('=') != std::string::npos) {
    throw InputError(
        fmt::format("--vary: got \"{}\"; allowed: a field alone, and its range as --between a:b", options.field));
  }
  LimitQuestion question =
      limit_question(scenario, options.overrides, options.field, range_of("--between", options.between));
  question.smallest = options.smallest;
  if (!options.resolution.empty()) question.resolution = resolution_of(options.resolution);
  if (!options.vibration.empty()) question.most_vibration = vibration_of(options.vibration);
  for (const std::string& bound : options.bounds) add_bound(bound, question.bounds);
  return question;
}

const char* side(const LimitQuestion& question) {
  return question.smallest ? "smallest" : "largest";
}

/// States the question.
std::string question_text(const LimitQuestion& question, const Scenario& scenario) {
  const std::string width = question.whole ? "1"
                            : question.range.logarithmic
                                ? fmt::format("{} %", 100.0 * question.resolution)
                                : fmt::format("{} % of the range", 100.0 * question.resolution);
  const auto end = [&question](double value) { return significant(question.whole ? std::round(value) : value); };
  return fmt::format("{}: {} stable {} between {} and {}, to {}; {} steps a run\n\n", scenario.name, side(question),
                     question.path, end(question.range.from), end(question.range.to), width, scenario.time.steps);
}

std::string value_text(const std::optional<double>& value) {
  return !value ? "-" : std::isinf(*value) || *value == 0.0 ? "none" : significant(*value, 6);
}

Table table_of(const std::vector<FieldLimit>& limits, const LimitQuestion& question) {
  Table table(limit_headings(question.smallest));
  for (const FieldLimit& limit : limits) {
    const auto difference = limit.difference();
    const auto tolerance = limit.tolerance(), other = limit.other_tolerance();
    const auto width = tolerance ? std::optional(100.0 * *tolerance / std::abs(*limit.value)) : std::nullopt;
    table.add({limit.algorithm, limit.other_value ? deserved(*limit.other_value, other, 6) : "none",
               other_beyond_text(limit), limit.value ? deserved(*limit.value, tolerance, 6) : "none",
               beyond_text(limit), value_text(limit.theory),
               difference ? deserved_difference(100.0 * *difference, width) : "-", std::to_string(limit.runs.size()),
               std::to_string(limit.inconsistent.size())});
  }
  return table;
}

/// Remarks on algorithms whose stable values are not all on one side of the limit, or whose hand and device are
/// unstable by themselves.
std::string remarks_text(const std::vector<FieldLimit>& limits, const LimitQuestion& question) {
  constexpr std::size_t kMost = 4;
  std::string text;
  for (const FieldLimit& limit : limits) {
    if (!limit.value) text += fmt::format("{}: {}\n", limit.algorithm, none_text(limit));
    if (limit.value && limit.own && !is_stable(limit.own->verdict)) {
      text +=
          fmt::format("{}: {} at the scenario's own {}: the edge is that of the first stable values from the {} end\n",
                      limit.algorithm, run_verdict_name(limit.own->verdict), significant(limit.own->value),
                      question.smallest ? "high" : "low");
    }
    if (limit.theory_has_none) {
      text += fmt::format("{}: by the eigenvalues of a step no value of the range is stable{}\n", limit.algorithm,
                          limit.value ? ": the runs are too short for its growth" : "");
    }
    if (limit.is_beyond_linear(question.resolution)) {
      text += fmt::format(
          "{}: the loop of device, hand and surface, linear and in contact, is stable up to {} only: beyond it bounces, dry "
          "friction or the end of the run hold the tool, and one that rests on the surface may not be stable\n",
          limit.algorithm, significant(*limit.linear, 6));
    }
    if (limit.undecided > 0) {
      text +=
          fmt::format("{}: {} runs were too short to tell slow motion from rest, though made up to 64 times as long\n",
                      limit.algorithm, limit.undecided);
    }
    if (!limit.has_effect) {
      text += fmt::format("{}: {} has no effect here: the handle moves alike in all {} runs\n", limit.algorithm,
                          question.path, limit.runs.size());
    }
    if (limit.unstable_alone) {
      text +=
          fmt::format("{}: at {} hand and device are unstable by themselves: the tool vibrates without contact, too\n",
                      limit.algorithm, significant((limit.beyond ? *limit.beyond : limit.runs.front()).value));
    }
    if (limit.inconsistent.empty()) continue;
    text += fmt::format("{}: not one edge:", limit.algorithm);
    for (std::size_t i = 0; i < std::min(kMost, limit.inconsistent.size()); ++i) {
      const JudgedValue& run = limit.inconsistent[i];
      text += fmt::format("{} {} at {}", i == 0 ? "" : ",", run_verdict_name(run.verdict), significant(run.value));
    }
    text +=
        limit.inconsistent.size() > kMost ? fmt::format(" and at {} more\n", limit.inconsistent.size() - kMost) : "\n";
  }
  return text;
}

/// With dry friction: the approach that the limits belong to.
std::string approach_text(const std::vector<FieldLimit>& limits, const Scenario& scenario) {
  const auto* device = std::get_if<ImpedanceDeviceConfig>(&scenario.device);
  if (device == nullptr || device->coulomb == 0.0) return "";
  std::string text;
  for (const FieldLimit& limit : limits) {
    if (!limit.value) continue;
    text += wrapped(
        fmt::format(
            "{}: dry friction of {} N helps to hold the tool, so that this is the limit of an approach, not of the "
            "device: of a handle that first touches at {} m/s and of a hand that presses with {} N; --set "
            "device.coulomb_N=0 shows what is left without",
            limit.algorithm, significant(device->coulomb, 3), significant(limit.settled.touch_speed, 2),
            significant(limit.settled.press, 2)),
        0);
  }
  return text;
}

/// A line of limit.csv.
struct LimitRow {
  const FieldLimit& limit;
  const LimitQuestion& question;
};
using LimitField = Field<LimitRow>;

Cell value_of(const std::optional<JudgedValue>& run) {
  return run ? Cell(run->value) : Cell();
}
Cell class_of(const std::optional<JudgedValue>& run) {
  return run ? Cell(std::string(run_verdict_name(run->verdict))) : Cell();
}

const LimitField kLimitFields[] = {
    {{"algorithm", "", "force algorithm"}, [](const LimitRow& r) -> Cell { return r.limit.algorithm; }},
    {{"field", "", "path of the field"},
     [](const LimitRow& r) -> Cell { return r.question.path; },
     LimitField::In::csv},
    {{"side", "", "largest or smallest: the stable value that was asked for"},
     [](const LimitRow& r) -> Cell { return side(r.question); },
     LimitField::In::csv},
    {{"limit", "by field",
      "the last stable value before the first edge, by bisection on runs; empty when there is none"},
     [](const LimitRow& r) { return cell_if(r.limit.value); }},
    {{"beyond", "by field", "the first unstable value beyond it; empty when the range ends stable"},
     [](const LimitRow& r) { return r.limit.beyond ? Cell(r.limit.beyond->value) : Cell(); }},
    {{"class_beyond", "", "what became of the run there (describe stability)"},
     [](const LimitRow& r) -> Cell { return beyond_text(r.limit); }},
    {{"low", "by field",
      "the low end of the interval of stable values that the limit ends: its smallest stable value, to the resolution"},
     [](const LimitRow& r) { return cell_if(r.question.smallest ? r.limit.value : r.limit.other_value); }},
    {{"below", "by field", "the first value below that is not stable; empty when the range begins stable"},
     [](const LimitRow& r) { return value_of(r.question.smallest ? r.limit.beyond : r.limit.other_beyond); }},
    {{"class_below", "", "what became of the run there"},
     [](const LimitRow& r) { return class_of(r.question.smallest ? r.limit.beyond : r.limit.other_beyond); }},
    {{"high", "by field", "the high end of this interval"},
     [](const LimitRow& r) { return cell_if(r.question.smallest ? r.limit.other_value : r.limit.value); }},
    {{"above", "by field", "the first value above that is not stable; empty when the range ends stable"},
     [](const LimitRow& r) { return value_of(r.question.smallest ? r.limit.other_beyond : r.limit.beyond); }},
    {{"class_above", "", "what became of the run there"},
     [](const LimitRow& r) { return class_of(r.question.smallest ? r.limit.other_beyond : r.limit.beyond); }},
    {{"theory", "by field", "the limit in theory; empty where there is none"},
     [](const LimitRow& r) { return cell_if(r.limit.theory); }},
    {{"linear", "by field",
      "of a device at what only pushes: the largest value at which the loop of device, hand and surface is stable while "
      "they touch, without dry friction and encoder, by its eigenvalues; a limit beyond it is held up by bounces, dry "
      "friction or the end of the run; empty where there is a theory or no device"},
     [](const LimitRow& r) { return cell_if(r.limit.linear); }},
    {{"limit_tolerance", "by field", "how far beyond the limit the edge may lie: beyond - limit"},
     [](const LimitRow& r) { return cell_if(r.limit.tolerance()); },
     LimitField::In::json},
    {{"low_tolerance", "by field", "the same of the low end"},
     [](const LimitRow& r) { return cell_if(r.question.smallest ? r.limit.tolerance() : r.limit.other_tolerance()); },
     LimitField::In::json},
    {{"high_tolerance", "by field", "the same of the high end"},
     [](const LimitRow& r) { return cell_if(r.question.smallest ? r.limit.other_tolerance() : r.limit.tolerance()); },
     LimitField::In::json},
    {{"undecided", "1", "runs that were too short to tell slow motion from rest, though lengthened"},
     [](const LimitRow& r) -> Cell { return std::uint64_t{r.limit.undecided}; }},
    {{"unstable_without_contact", "", "true when hand and device alone are unstable beyond the edge"},
     [](const LimitRow& r) -> Cell { return r.limit.unstable_alone; },
     LimitField::In::json},
    {{"has_effect", "", "false when the field changes no run"},
     [](const LimitRow& r) -> Cell { return r.limit.has_effect; },
     LimitField::In::json},
    {{"runs", "1", "runs of the search"}, [](const LimitRow& r) -> Cell { return r.limit.runs.size(); }},
    {kInconsistentColumn, [](const LimitRow& r) -> Cell { return r.limit.inconsistent.size(); }},
    {kAstrayColumn, [](const LimitRow& r) -> Cell { return r.limit.inconsistent.size(); }}};

/// {field} is the path of the field.
constexpr Column kLimitRunColumns[] = {{"algorithm", "", "force algorithm"},
                                       {"{field}", "by name", "value of the field"},
                                       {"class", "", "what became of the run (describe stability)"}};

std::vector<LimitRow> rows_of(const std::vector<FieldLimit>& limits, const LimitQuestion& question) {
  std::vector<LimitRow> rows;
  for (const FieldLimit& limit : limits) rows.push_back({limit, question});
  return rows;
}

void write_limits(const fs::path& directory, const std::vector<FieldLimit>& limits, const LimitQuestion& question) {
  FileSet files;
  write_csv(directory / "limit.csv", kLimitFields, rows_of(limits, question), &files);
  CsvWriter runs(directory / "limit_runs.csv",
                 fmt::format(fmt::runtime(header_of(kLimitRunColumns)), fmt::arg("field", question.path)));
  for (const FieldLimit& limit : limits) {
    for (const JudgedValue& run : limit.runs)
      runs.row(std::string_view(limit.algorithm), run.value, run_verdict_name(run.verdict));
  }
  runs.finish(&files);
  files.commit();
}

Json limits_json(const std::vector<FieldLimit>& limits, const LimitQuestion& question, bool moved) {
  Json rows = Json::array();
  for (const LimitRow& row : rows_of(limits, question)) {
    Json& json = rows.emplace_back();
    add_row(json, kLimitFields, row);
    Json inconsistent = Json::array();
    for (const JudgedValue& run : row.limit.inconsistent)
      inconsistent.push_back({{"value", run.value}, {"class", run_verdict_name(run.verdict)}});
    json[kInconsistentColumn.name] = json[kAstrayColumn.name] = inconsistent;
  }
  return {{"field", question.path},
          {"side", side(question)},
          {"from", question.range.from},
          {"to", question.range.to},
          {"resolution", question.resolution},
          {"rule", rule_text(question, moved)},
          {"limits", std::move(rows)}};
}

int limit(const LimitOptions& options) {
  const fs::path file = find_scenario(options.scenario);
  const ScenarioText scenario = read_scenario_text(file);
  const LoadedScenario loaded = load_scenario(scenario, options.overrides);
  const std::vector<std::string> algorithms =
      options.algorithms.empty() ? std::vector<std::string>{loaded.scenario.rendering.algorithm}
                                 : chosen_names("--algorithms: got", options.algorithms, all_algorithms());
  LimitQuestion question = question_of(options, scenario);
  // A field of the rendering changes nothing of hand and device.
  if (question.path.starts_with("rendering.")) question.tremor = tremor_speeds(loaded);
  print_warnings(question.warnings);
  print_warnings(check_named_files(loaded));
  const fs::path out = results_directory(options.out, "limit_" + file.stem().string());
  require_writable_directory(out);

  const std::vector<FieldLimit> limits = field_limits(scenario, options.overrides, algorithms, question,
                                                      job_options(options.jobs, options.output, "limit"));
  write_limits(out, limits, question);
  const bool on_device = std::holds_alternative<ImpedanceDeviceConfig>(loaded.scenario.device);
  print(options.output,
        question_text(question, loaded.scenario) + table_of(limits, question).text() + "\n" +
            wrapped(rule_text(question, is_moved(loaded.scenario)), 0) + remarks_text(limits, question) +
            approach_text(limits, loaded.scenario) +
            (on_device && question.path == "rendering.stiffness_N_per_m" ? kWhichStiffness : "") +
            fmt::format("\nresults in {}\n", out.string()),
        limits_json(limits, question, is_moved(loaded.scenario)));
  return kSuccess;
}

}  // namespace

std::vector<Column> limit_columns() {
  return columns_of(kLimitFields);
}

std::vector<Table::Column> limit_headings(bool smallest) {
  return {
      {"algorithm", false},
      {smallest ? "high end" : "low end", true, smallest ? "high" : "low"},
      {smallest ? "above it" : "below it", false,
       smallest ? "what becomes of the run at the first value above the high end; \"end of the range\": none was tried"
                : "what becomes of the run at the first value below the low end; \"end of the range\": none was tried"},
      {"first edge", true, "limit"},
      {"beyond it", false,
       "what becomes of the run at the first unstable value beyond the first edge, a class of motion; \"end of the "
       "range\": no value up to there is unstable"},
      {"theory"},
      {"off theory %", true, "first edge / theory - 1, in percent; of stability --map the largest along the edge"},
      {"runs"},
      {"inconsistent", true, kInconsistentColumn.name}};
}

std::span<const Column> limit_run_columns() {
  return kLimitRunColumns;
}

void add_limit(CommandLine& line) {
  auto [command, options] =
      line.command("limit", "Find the largest stable value of any field, by bisection on runs of any scene", limit,
                   "no limit is written");
  command.add("scenario", options.scenario, "scenario file, or name of a bundled scenario").required();
  command.add("--vary", options.field, "the field, as in rendering.stiffness_N_per_m").required();
  command.add("--between", options.between,
              "a:b, the range to search (default: a thousandth to a thousandfold of the scenario's value)");
  command.flag("--smallest", options.smallest, "find the smallest stable value instead, as of a mass");
  command.add("--algorithms", options.algorithms, "names separated by commas, or all (default: the scenario's own)")
      .comma_separated();
  command.add("--resolution", options.resolution,
              "relative width of the answer (default: 0.001); of the range when the range reaches 0 or below");
  command.add("--vibration", options.vibration,
              "judge stability by the handle's vibration: the largest allowed above 30 Hz [m/s rms]");
  command.add("--bound", options.bounds,
              "a stable run keeps metric=most or metric=least:most, too, as inside_settled_m=3e-4; repeatable");
  add_jobs(command, options.jobs, "algorithms at once (default: as many as the machine has threads)");
  command.add("--out", options.out, "directory of the results (default: results/out/limit_NAME)");
  add_overrides(command, options.overrides, "override a field of all runs: path=value");
  add_output_options(command, options.output);
  command.footer(
      "A run is stable when it comes to rest or dies out, the classes of \"hapbench describe stability\". It is not "
      "stable when it vibrates, diverges, goes through the surface, is thrown out (leaves the hole, or ends without contact "
      "beyond the shell's box by more than the tool reaches), loses contact, is stuck, touches nothing, or does not keep a "
      "--bound. Oscillations slower than a quarter of the run are not seen. "
      "The range is tried at 17 values. The first edge upwards of the scenario's own value (of the first stable value, "
      "if that one is not stable; with --smallest downwards, from the high end) is bisected, then the other end of the "
      "interval of stable values, below which a surface may be too soft; three values are tried "
      "on either side of the first edge, which may reveal an earlier edge. The column inconsistent counts unstable values in the interval "
      "and stable ones outside of it. Where the hand is an impedance, a run without environment tells whether "
      "hand and device alone are unstable beyond the edge. Where the springs stay in contact, the theoretical limit "
      "stands beside the edge. limit_runs.csv has every run.");
}

}  // namespace hapbench
