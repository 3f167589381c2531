#include "scenarios/program/limit/limit.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>

#include "device_model/theory/linear_loops.hpp"
#include "scenarios/input/bundled_files.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/program/report.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/progress_bar.hpp"
#include "scenarios/scene/metric_sections.hpp"

namespace hapbench {
namespace {

// ---- The question

/// The answer of a case, and what it was: a line of limit.csv.
struct LimitRow : FieldLimit {
  std::vector<std::string> axis_values = {};  ///< of LimitTable::cases
  const ComparedDevice* device = nullptr;     ///< none: the scene's own
  Scenario scenario = {};                     ///< as it is asked for, with its own value of the field
  LimitQuestion asked = {};
  /// The limit over that of the first scene and algorithm, all else equal, and the same of K lambda_max(S), the
  /// stiffness that the hand meets; empty where either has no limit.
  std::optional<double> stiffness_ratio = {}, rendered_ratio = {};

  const std::string& scene() const { return axis_values[axis_values.size() - 2]; }
  const std::string& algorithm() const { return scenario.rendering.algorithm; }
};

struct LimitTable {
  std::vector<ComparedDevice> devices;  ///< empty: each scene's own
  /// The axes are the device, the fields of --over, the scene and the algorithm; all but the fields are named.
  Cases cases;
  std::vector<LimitRow> rows = {};

  const LimitRow& first() const { return rows.front(); }
  /// The fields of --over: axes 1 to this one.
  std::size_t over() const { return cases.axes().size() - 3; }
  /// Scenes times algorithms: as many rows follow each other with all else equal.
  std::size_t columns() const { return cases.axes()[over() + 1].size() * cases.axes()[over() + 2].size(); }
  /// True where a table of rows and columns shows the limits, and not one of every number.
  bool is_grid() const { return !devices.empty() || over() > 0; }
};

struct LimitOptions : CommonOptions {
  std::vector<std::string> scenarios;
  std::string field = kStiffnessPath;
  std::string between, resolution, stable, vibration;
  std::vector<std::string> bounds;
  bool smallest = false;
  std::vector<std::string> algorithms, devices, friction, over;
};

constexpr const char *kPresets = "impedance", *kFile = ".json";  ///< the type of all presets, and the end of files

/// The devices of a name, a type or a file; none of an unknown name.
std::vector<ComparedDevice> devices_named(const std::string& name) {
  if (name.ends_with(kFile)) return {device_of_file(name)};
  std::vector<ComparedDevice> found;
  for (const ComparedDevice& device : compared_devices()) {
    if (name == "all" || name == device.name || (name == kPresets && device.published_stiffness))
      found.push_back(device);
    for (const ComparedDevice& end : with_unpublished_numbers(device))
      if (name == end.name) found.push_back(end);
  }
  return found;
}

/// The number that an option was given. Throws InputError unless it is one from `least` to `most`.
double number_between(const char* option, const std::string& text, double least, double most) {
  const auto number = finite_number(text);
  if (number && *number >= least && *number <= most) return *number;
  throw InputError(fmt::format("{}: got \"{}\"; allowed: {} ... {}", option, text, least, most));
}

/// The devices, marked where --set changes them, each with what nobody published of it: both ends or other frictions.
std::vector<ComparedDevice> asked_devices(const LimitOptions& options) {
  const bool none_other = options.friction == std::vector<std::string>{"none"};
  bool is_changed = false;
  for (const std::string& override : options.overrides) {
    const std::string_view path = overridden_path(override);
    is_changed = is_changed || path.starts_with("device.");
    if (path == "device" || path == "device.type" || path == "device.preset") {
      throw InputError(fmt::format(
          "--set: got {} with --device; allowed: fields of the devices, such as device.delay_samples; a device "
          "of your own goes into --device, as a file NAME.json",
          path));
    }
    if (path == "device.coulomb_N" && !options.friction.empty() && !none_other)
      throw InputError("--friction: cannot be combined with --set device.coulomb_N; allowed: one of the two");
  }
  std::vector<ComparedDevice> devices;
  for (ComparedDevice device : chosen_devices(options.devices)) {
    const bool is_end = device.name.ends_with(']');
    if (is_changed && device.published_stiffness) {  // nothing is published of this one
      device.name += '*';
      device.published_stiffness.reset();
    }
    devices.push_back(device);
    if (none_other) continue;
    for (const std::string& factor : options.friction)
      if (const auto other = with_friction_times(device, number_between("--friction", factor, 0.0, 1e3)))
        devices.push_back(*other);
    if (options.friction.empty() && !is_end)
      std::ranges::move(with_unpublished_numbers(device), std::back_inserter(devices));
  }
  return devices;
}

/// The error with the device's name, since the overrides hold for all devices.
InputError on_device(const ComparedDevice& device, const InputError& error) {
  std::vector<InputError> faults;
  for (const InputError& fault : error.faults()) {
    if (fault.place().empty()) return error;  // of an option
    const bool is_of_type = fault.place().find("/device/") != std::string::npos && !device.has_place_for_mass;
    faults.emplace_back(fault.kind(), fmt::format("--device {}: {}", device.name, fault.place()),
                        fault.problem() + (is_of_type ? "; \"--device impedance\" leaves this one out" : ""));
  }
  return InputError::all(faults);
}

/// By default a run is stable by the rule of `tune`.
LimitQuestion question_of(const LimitOptions& options, const ScenarioText& scene, const Scenario& scenario,
                          const std::vector<std::string>& overrides) {
  if (options.field.find('=') != std::string::npos)
    throw InputError(
        fmt::format("--vary: got \"{}\"; allowed: a field alone, and its range as --between a:b", options.field));
  LimitQuestion question = limit_question(scene, overrides, options.field, range_of("--between", options.between));
  question.smallest = options.smallest;
  if (!options.resolution.empty()) question.resolution = number_between("--resolution", options.resolution, 1e-6, 0.5);
  question.between = options.devices.empty() && options.over.empty();
  question.bounded = options.stable == "bounded";
  if (!options.vibration.empty()) {
    if (!options.stable.empty() && options.stable != "still")
      throw InputError(
          fmt::format("--vibration: cannot be combined with --stable {}; allowed: with still", options.stable));
    question.most_vibration = number_between("--vibration", options.vibration, 1e-9, 1e3);
  } else if (options.stable.empty()) {
    question.most_vibration = rule_of(scenario).most_vibration;
  } else if (options.stable == "still") {
    question.most_vibration = kMostVibration;
  }
  for (const std::string& bound : options.bounds) add_bound(bound, question.bounds);
  return question;
}

/// A table without rows. The axis of --device has no field's name, which it leaves to --over. Throws InputError.
LimitTable asked_table(const LimitOptions& options) {
  if (options.devices.empty() && !options.friction.empty())
    throw InputError("--friction: got factors; allowed: with --device");
  const std::vector<std::filesystem::path> files = find_scenarios(options.scenarios);
  const Axis scene{.path = kSceneAxis, .values = names_of_scenarios(files)};
  std::vector<ScenarioText> scenes;
  std::transform(files.begin(), files.end(), std::back_inserter(scenes), read_scenario_text);
  std::vector<ComparedDevice> devices;
  std::vector<Axis> axes = {{.path = "--device", .values = {""}, .named = true}};
  if (!options.devices.empty()) {
    devices = asked_devices(options);
    axes[0].values = names_of(devices, &ComparedDevice::name);
  }
  Axis algorithm{.path = "--algorithms", .values = {""}, .named = true};
  if (!options.algorithms.empty()) algorithm = {"rendering.algorithm", chosen_algorithms(options.algorithms)};
  for (const std::string& text : options.over) axes.push_back(parse_axis(text));
  axes.insert(axes.end(), {scene, algorithm});
  return {std::move(devices), Cases(std::move(scenes), options.overrides, std::move(axes))};
}

/// The case of that number. Warnings that are not among them yet are added.
LimitRow asked_row(const LimitOptions& options, const LimitTable& table, std::size_t i,
                   std::vector<std::string>& warnings) {
  LimitRow row;
  row.axis_values = table.cases.values(i);
  if (!table.devices.empty()) row.device = &table.devices[table.cases.place(i, 0)];
  const ScenarioText& scene = table.cases.scene(i);
  try {
    std::vector<std::string> overrides = table.cases.overrides(i);
    if (row.device != nullptr) overrides = overrides_on(*row.device, scene, overrides);
    const LoadedScenario loaded = load_scenario(scene, overrides);
    row.scenario = loaded.scenario;
    row.asked = question_of(options, scene, row.scenario, overrides);
    append_new(warnings, row.asked.warnings);
    append_new(warnings, with_files(loaded, checked(loaded).file_warnings));
  } catch (const InputError& error) {
    throw row.device != nullptr ? on_device(*row.device, error) : error;
  }
  return row;
}

/// One search runs on all threads; of several each has one.
void find_limits(const LimitOptions& options, std::vector<LimitRow>& rows) {
  const bool alone = rows.size() == 1;
  if (alone) rows[0].asked.threads = job_options(options, "").threads;
  const WaitNotice notice("limit", !options.output.quiet && alone);
  for_each_job(rows.size(), job_options(options, alone ? "" : "limit"),
               [&](std::size_t i) { static_cast<FieldLimit&>(rows[i]) = field_limit(rows[i].asked); });
}

void add_ratios(LimitTable& table) {
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    LimitRow& row = table.rows[i];
    const FieldLimit& reference = table.rows[i - i % table.columns()];
    if (!row.value || !reference.value) continue;
    row.stiffness_ratio = *row.value / *reference.value;
    if (const double lambda = reference.settled.lambda_max; lambda > 0.0)
      row.rendered_ratio = *row.stiffness_ratio * row.settled.lambda_max / lambda;
  }
}

// ---- Tables

constexpr const char *kInconsistent = "inconsistent_runs", *kAstray = "astray";

/// A line of limit_runs.csv.
struct LimitRunRow {
  const LimitRow& limit;
  JudgedValue run;

  operator const LimitRow&() const { return limit; }  // NOLINT: what it has of the case
};

/// What tells the cases apart. `table`, here and below: none for all columns that there may be, for `describe`.
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

Columns<LimitRunRow> run_columns(const LimitTable* table) {
  Columns<LimitRunRow> columns = place_columns<LimitRunRow>(table);
  columns.add({{table == nullptr ? "{field}" : table->first().asked.path, "by name", "value of the field",
                [](const LimitRunRow& r) { return r.run.value; }},
               {"class", "", "what became of the run (describe stability)",
                [](const LimitRunRow& r) { return run_verdict_name(r.run.verdict); }}});
  return columns;
}

const IntervalEnd& low_end(const LimitRow& row) {
  return row.asked.smallest ? row : row.other;
}
const IntervalEnd& high_end(const LimitRow& row) {
  return row.asked.smallest ? row.other : row;
}

Cell value_beyond(const IntervalEnd& end) {
  return end.beyond ? Cell(end.beyond->value) : Cell();
}
Cell class_beyond(const IntervalEnd& end) {
  return end.beyond ? cell_of(run_verdict_name(end.beyond->verdict)) : Cell();
}
/// Without a limit, the class at the range's low end.
Cell class_beyond_limit(const LimitRow& row) {
  if (!row.beyond && !row.value) return cell_of(run_verdict_name(row.runs.front().verdict));
  return row.beyond ? class_beyond(row) : Cell("end of the range");
}

std::string linear_edge_text(const LimitRow& row) {
  const auto& edge = row.linear_edge();
  if (!edge) return "-";
  return std::isinf(*edge) || *edge == 0.0 ? "none" : significant(*edge, 6);
}

/// What `get` gives of a part of a row.
template <class Part, class Get>
auto of(Part part, Get get) {
  return [part, get](const LimitRow& row) { return cell_of(std::invoke(get, std::invoke(part, row))); };
}

/// The edge, the interval that it ends, and the edge in theory. Of one case alone the end on the other side is printed.
Columns<LimitRow> edge_columns(const LimitTable* table) {
  const auto is_printed = [table](bool low) {
    return table == nullptr || (!table->is_grid() && low != table->first().asked.smallest);
  };
  const auto has_inequality = [](const LimitRow& row) { return row.closed_form.has_value(); };
  using Row = LimitRow;
  return {
      {"field", "", "path of the field", of(&Row::asked, &LimitQuestion::path), kOnlyCsv},
      {"side", "", "largest or smallest: the stable value that was asked for", of(&Row::asked, &LimitQuestion::side),
       kOnlyCsv},
      {"linear\nedge", "by field", "of limit: theory, or where there is none linear", linear_edge_text, only_printed()},
      {"limit", "by field",
       "the last stable value before the first edge, by bisection on runs; empty when there is none", &Row::value,
       under("edge in\nruns", 6), &Row::tolerance},
      {"beyond", "by field", "the first unstable value beyond it; empty when the range ends stable", value_beyond},
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
      {"theory", "by field", "the limit in theory; empty where there is none", &Row::theory},
      {"closed_form", "by field",
       "the same where the integrator's inequality ends, of leapfrog 4 - 2 lambda B dt / M - lambda K dt^2 / M >= 0 "
       "with lambda = lambda_max(S) (A.3); empty where it has none",
       &Row::closed_form, when(table == nullptr || std::ranges::any_of(table->rows, has_inequality))},
      {"linear", "by field",
       "of a device at what only pushes: the largest value at which the loop of device, hand and surface is stable "
       "while they touch, without dry friction and encoder, by its eigenvalues; a limit beyond it is held up by "
       "bounces, dry friction or the end of the run; empty where there is a theory or no device",
       &Row::linear}};
}

/// What is known of the answer, and in a table of cases numbers of the run at the limit, for these to be compared by.
Columns<LimitRow> search_columns(bool devices, bool grid) {
  using Row = LimitRow;
  const auto may_fail = [](const Row& r) {
    return r.tried_between > 0 ? Cell(may_fail_share(r.tried_between)) : Cell();
  };
  const auto settled = [](auto member) {
    return [member](const Row& r) { return r.value ? cell_of(std::invoke(member, r.settled)) : Cell(); };
  };
  return {
      {"limit_tolerance", "by field", "how far beyond the limit the edge may lie: beyond - limit", &Row::tolerance,
       kOnlyJson},
      {"low_tolerance", "by field", "the same of the low end", of(low_end, &IntervalEnd::tolerance), kOnlyJson},
      {"high_tolerance", "by field", "the same of the high end", of(high_end, &IntervalEnd::tolerance), kOnlyJson},
      {"undecided", "1", "runs that were too short to tell slow motion from rest, though lengthened", &Row::undecided},
      {"unstable_without_contact", "", "true when hand and device alone are unstable beyond the edge",
       &Row::unstable_alone, kOnlyJson},
      {"has_effect", "", "false when the field changes no run", &Row::has_effect, kOnlyJson},
      {"scattered", "", "true where stable values are scattered and there is no edge", &Row::scattered, kOnlyJson},
      {"tried_between", "1",
       "values between the ends of the interval that were tried, all stable; 0 in a table of devices or values",
       &Row::tried_between},
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

/// The columns of limit.csv; before the last what the literature says of a wall on an impedance device.
Columns<LimitRow> limit_columns(const LimitTable* table) {
  using Row = LimitRow;
  Columns<Row> columns = place_columns<Row>(table);
  columns.add(edge_columns(table));
  columns.add(search_columns(table == nullptr || !table->devices.empty(), table == nullptr || table->is_grid()));
  const auto has_forms = [](const Row& r) { return !r.closed_forms.empty(); };
  const bool forms = table == nullptr || std::ranges::any_of(table->rows, has_forms);
  for (std::size_t i = 0; i < stiffness_limits().size(); ++i) {
    const StiffnessLimit& known = stiffness_limits()[i];
    columns.add(
        {{known.name, "N/m", fmt::format("the K at which {}; for {} ({})", known.formula, known.applies, known.source),
          [i](const Row& r) { return r.closed_forms.empty() ? Cell() : cell_of(r.closed_forms[i]); }, when(forms)}});
  }
  const auto inconsistent = [](const Row& r) { return r.inconsistent.size(); };
  columns.add({{"no_theory", "", "why the eigenvalues of the loop tell nothing; empty where they do", &Row::no_theory,
                when(forms)},
               {"worst_hand", "N/m",
                "least edge over passive hands of 100 to 1000 N/m and 0.1 to 0.5 kg, and none, by eigenvalues",
                &Row::worst_hand, when(forms)},
               {"runs", "1", "runs of the search", [](const Row& r) { return r.runs.size(); }},
               {kInconsistent, "1", "runs that are unstable on the stable side of the limit, or stable beyond it",
                inconsistent, under("inconsistent")},
               {kAstray, "1", "the same as inconsistent_runs, by its former name", inconsistent}});
  return columns;
}

// ---- Text

constexpr const char* kBeyondLinear =
    "beyond it stable runs are intermittent contact: bounces below 30 Hz, dry friction or the end of the run hold the "
    "tool, and one that rests on the surface may not be stable";

std::string damping_text(const RenderingConfig& rendering) {
  if (rendering.damping) return fmt::format("B = {} N s/m", significant(*rendering.damping));
  if (rendering.damping_ratio == 0.0) return "no damping is rendered (damping_ratio 0): B = 0 at every K";
  return fmt::format("B = 2 zeta sqrt(K m) with damping_ratio zeta = {} and rendering.mass_kg m = {}",
                     significant(rendering.damping_ratio), significant(rendering.mass));
}

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

std::string notes_text(const LimitTable& table) {
  std::optional<double> friction;  // the most of a handle; none where no row is on an impedance device
  for (const LimitRow& row : table.rows)
    if (const auto* device = std::get_if<ImpedanceDeviceConfig>(&row.scenario.device))
      friction = std::max(friction, std::optional(device->coulomb));
  const auto is_beyond_linear = [](const LimitRow& row) { return row.is_beyond_linear(row.asked.resolution); };
  const auto is_published = [](const ComparedDevice& device) { return device.published_stiffness.has_value(); };
  std::string names;
  for (const ComparedDevice& device : table.devices) names += device.name + " ";
  const auto is_marked = [&names](const char* mark) { return names.find(mark) != std::string::npos; };
  const std::pair<bool, std::string> notes[] = {
      {table.is_grid() && std::ranges::any_of(table.rows, is_beyond_linear),
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
      {table.first().asked.path == kStiffnessPath && friction.has_value(),
       "which K to quote: device_model/README.md, \"Which K to quote?\""},
      {friction > 0.0,
       "dry friction, which is ours in every preset, holds a hand that presses slowly: the limit is that of this approach, "
       "not of a device; --set device.coulomb_N=0 shows what is left without"}};
  std::string text;
  for (const auto& [holds, note] : notes)
    if (holds) text += wrapped(note, 0);
  std::vector<std::string> delays = {""};
  if (table.over() == 0)
    for (const LimitRow& row : table.rows) append_new(delays, {delay_note(row.scenario)});
  for (const std::string& delay : std::span(delays).subspan(1)) text += wrapped(delay, 0);
  return text;
}

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

// ---- The command

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

int limit(const LimitOptions& options) {
  LimitTable table = asked_table(options);
  std::vector<std::string> warnings;
  for (std::size_t i = 0; i < table.cases.size(); ++i) table.rows.push_back(asked_row(options, table, i, warnings));
  print_warnings(warnings);
  Report report(options, options.scenarios.size() > 1 ? "limit" : "limit_" + table.first().scene());
  find_limits(options, table.rows);
  add_ratios(table);
  tell_limits(table, report);
  report.say(fmt::format("\nresults in {}\n", report.folder().string()));
  return report.finish();
}

}  // namespace

std::optional<Range> range_of(const char* option, const std::string& text) {
  if (text.empty()) return std::nullopt;
  const Words ends = parts_of(text, ':');
  const auto from = finite_number(ends.front()), to = finite_number(ends.back());
  if (ends.size() != 2 || !from || !to || !(*from < *to))
    throw InputError(fmt::format("{}: got \"{}\"; allowed: a:b with numbers a < b", option, text));
  return Range{*from, *to};
}

void add_bound(const std::string& text, std::map<std::string, MetricBound>& bounds) {
  const Words parts = parts_of(text, '=');
  if (parts.size() == 2) {
    require_valid_name("--bound: got", std::string(parts[0]), names_of(all_metrics(), &Metric::name),
                       "hapbench describe metrics");
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

std::vector<ComparedDevice> chosen_devices(const std::vector<std::string>& given) {
  std::vector<std::string> plain = given, all = names_of(compared_devices(), &ComparedDevice::name);
  std::erase_if(plain, [](const std::string& name) { return name.ends_with(kFile) || name.ends_with(']'); });
  all.insert(all.begin(), {"FILE.json", kPresets});
  chosen_names("--device: got", plain, all, "hapbench describe presets");
  std::vector<ComparedDevice> chosen;
  for (const std::string& name : given) {
    const std::vector<ComparedDevice> found = devices_named(name);
    if (found.empty())
      throw InputError(fmt::format("--device: got \"{}\"; allowed: a preset with [soft] or [stiff] behind it", name));
    chosen.insert(chosen.end(), found.begin(), found.end());
  }
  std::set<std::string> names;
  for (const ComparedDevice& device : chosen) {
    if (names.insert(device.name).second) continue;
    throw InputError(
        fmt::format("--device: got a second device named \"{}\"; allowed: each name once, and a file is named by what "
                    "stands before .json",
                    device.name));
  }
  return chosen;
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

std::vector<DescribedTable> limit_tables() {
  return {limit_columns(nullptr).described("limit.csv",
                                           "of limit: one line per device, values of --over, scene and algorithm"),
          run_columns(nullptr).described("limit_runs.csv", "of limit: one line per run")};
}

void add_limit(CommandLine& line) {
  auto [command, options] = line.command(
      "limit", "Find how far any field may go, on which device, with which algorithm, by bisection on runs", limit,
      "no limit is written");
  command.add("scenarios", options.scenarios, "scenario files, or names of bundled scenarios", {.required = true});
  command.add("--vary", options.field, fmt::format("the field (default: {})", options.field));
  command.add("--between", options.between,
              "a:b, the range to search (default: a thousandth to a thousandfold of the scenario's value)");
  command.flag("--smallest", options.smallest, "find the smallest stable value instead, as of a mass");
  add_algorithms(command, options.algorithms, "each scenario's own");
  command.add("--device", options.devices,
              "in place of each scene's own: presets, ideal, admittance, files NAME.json, all, or impedance for all "
              "presets, separated by commas; a preset also at both ends of what nobody published of it",
              {.comma_separated = true});
  command.add("--friction", options.friction,
              "in place of these ends each device's dry friction times factors, such as 0,2; none: neither",
              {.comma_separated = true});
  command.add("--over", options.over,
              "ask for each value of another field, which it takes as sweep --vary does; repeatable",
              {.several = true});
  command.add(
      "--stable", options.stable,
      "what a run has to do: be settled (come to rest), bounded (vibrating also counts) or still (a handle that "
      "does not vibrate; default where a script moves the tool, elsewhere settled)",
      {.one_of = {"settled", "bounded", "still"}});
  command.add(
      "--vibration", options.vibration,
      fmt::format("of still: the largest vibration of the handle above 30 Hz [m/s rms] (default: {})", kMostVibration));
  command.add("--bound", options.bounds,
              "a stable run also keeps metric=most or metric=least:most, as inside_settled_m=3e-4; repeatable");
  command.add("--resolution", options.resolution,
              "relative width of the answer (default: 0.001); of the range when the range reaches 0 or below");
  add_common(command, options, "limit_NAME");
  command.footer(
      "A run is stable when it comes to rest or dies out; where a script moves the tool, when its handle does not vibrate. \"hapbench describe stability\" "
      "has all classes. Oscillations slower than a quarter of the run are not seen. "
      "The range is tried at 17 values. The first edge upwards of the scenario's own value (of the first stable value, "
      "if that one is not stable; with --smallest downwards, from the high end) is bisected, then the other end of the "
      "interval of stable values, below which a surface may be too soft; three values are tried "
      "on either side of the first edge, which may reveal an earlier edge. Of one scene and device the interval is then tried at 48 values between its ends and 8 "
      "just below its edge, and ends at the first that is not stable; where no 2 % of values are stable, there is no edge. The linear edge, of the loop in contact, is the answer "
      "where stable runs beyond it are intermittent contact. The column inconsistent counts unstable values in the interval "
      "and stable ones outside of it. Where the hand is an impedance, a run without environment tells whether "
      "hand and device alone are unstable beyond the edge. A hand with a mass loses it on ideal and admittance, where the virtual mass stands for it. "
      "limit_runs.csv has every run.");
}

}  // namespace hapbench
