#include "scenarios/program/limit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <set>

#include "algorithms/registry.hpp"
#include "scenarios/format/bundled_scenarios.hpp"
#include "scenarios/format/metric_sections.hpp"
#include "scenarios/format/text_lines.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/progress_bar.hpp"

namespace hapbench {
namespace {

struct LimitOptions : CommonOptions {
  std::vector<std::string> scenarios;
  std::string field = kStiffnessPath;
  std::string between, resolution, stable, vibration;
  std::vector<std::string> bounds;
  bool smallest = false;
  std::vector<std::string> algorithms, devices, friction, over;
};

constexpr const char* kPresets = "impedance";  ///< stands for all presets, which have that type

bool is_file(const std::string& name) {
  return name.ends_with(".json");
}

/// The devices of a name or a type that are none of files; none of an unknown name.
std::vector<ComparedDevice> devices_named(const std::string& name) {
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

/// The devices, those with what --set changes marked, each with what else nobody published of it: both ends, or its dry
/// friction times the factors.
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
    for (const std::string& factor : options.friction) {
      if (const auto other = with_friction_times(device, number_between("--friction", factor, 0.0, 1e3)))
        devices.push_back(*other);
    }
    if (!options.friction.empty() || is_end) continue;
    for (const ComparedDevice& end : with_unpublished_numbers(device)) devices.push_back(end);
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

/// The rule by which a run is stable; the default is that of `tune`.
void set_rule(const LimitOptions& options, const Scenario& scenario, LimitQuestion& question) {
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
}

LimitQuestion question_of(const LimitOptions& options, const ScenarioText& scene, const Scenario& scenario,
                          const std::vector<std::string>& overrides) {
  if (options.field.find('=') != std::string::npos)
    throw InputError(
        fmt::format("--vary: got \"{}\"; allowed: a field alone, and its range as --between a:b", options.field));
  LimitQuestion question = limit_question(scene, overrides, options.field, range_of("--between", options.between));
  question.smallest = options.smallest;
  if (!options.resolution.empty()) question.resolution = number_between("--resolution", options.resolution, 1e-6, 0.5);
  question.between = options.devices.empty() && options.over.empty();
  set_rule(options, scenario, question);
  return question;
}

/// The question without its rows. The axis of --device has no field's name, which it leaves to --over. Throws
/// InputError.
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
  if (!options.algorithms.empty())
    algorithm = {"rendering.algorithm", chosen_names("--algorithms: got", options.algorithms, algorithm_names())};
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

/// Compares the limits by those of the first scene and algorithm.
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
    require_names("--bound: got", {std::string(parts[0])}, names_of(all_metrics(), &Metric::name));
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
  std::vector<std::string> unknown;
  std::copy_if(given.begin(), given.end(), std::back_inserter(unknown),
               [](const std::string& name) { return !is_file(name) && !name.ends_with(']'); });
  if (!unknown.empty()) {
    std::vector<std::string> names = names_of(compared_devices(), &ComparedDevice::name);
    names.insert(names.begin(), {"FILE.json", kPresets});
    chosen_names("--device: got", unknown, names, "hapbench describe presets");
  }
  std::vector<ComparedDevice> chosen;
  for (const std::string& name : given) {
    const std::vector<ComparedDevice> found =
        is_file(name) ? std::vector<ComparedDevice>{device_of_file(name)} : devices_named(name);
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
