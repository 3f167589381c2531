#include "scenarios/program/limit_cases.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <set>

#include "algorithms/registry.hpp"
#include "scenarios/description/bundled_scenarios.hpp"
#include "scenarios/description/metric_sections.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/run/assemble.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

constexpr const char* kNoOthers = "none";      ///< for --friction
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

/// The devices, those with what --set changes marked, each with what else nobody published of it: both ends, or its dry
/// friction times the factors.
std::vector<ComparedDevice> asked_devices(const LimitOptions& options) {
  const bool none_other = options.friction == std::vector<std::string>{kNoOthers};
  for (const std::string& override : options.overrides) {
    const std::string_view path = overridden_path(override);
    if (path == "device" || path == "device.type" || path == "device.preset") {
      throw InputError(fmt::format(
          "--set: got {} with --device; allowed: fields of the devices, such as device.delay_samples; a device "
          "of your own goes into --device, as a file NAME.json",
          path));
    }
    if (path == "device.coulomb_N" && !options.friction.empty() && !none_other)
      throw InputError("--friction: got it beside --set device.coulomb_N; allowed: either");
  }
  std::vector<ComparedDevice> devices;
  for (const ComparedDevice& chosen : chosen_devices(options.devices)) {
    const ComparedDevice device = with_marked_name(chosen, options.overrides);
    devices.push_back(device);
    if (none_other) continue;
    for (const std::string& factor : options.friction) {
      if (const auto other = with_friction_times(device, number_between("--friction", factor, 0.0, 1e3)))
        devices.push_back(*other);
    }
    if (!options.friction.empty() || chosen.name.ends_with(']')) continue;
    for (const ComparedDevice& end : with_unpublished_numbers(device)) devices.push_back(end);
  }
  return devices;
}

std::vector<ScenarioText> asked_scenes(const std::vector<std::string>& given) {
  std::vector<ScenarioText> scenes;
  std::set<fs::path> names;
  for (const fs::path& file : find_scenarios(given)) {
    if (!names.insert(file.stem()).second) {
      throw InputError(fmt::format("{}: a second scenario named \"{}\"; allowed: each name once", file.string(),
                                   file.stem().string()));
    }
    scenes.push_back(read_scenario_text(file));
  }
  return scenes;
}

/// Errors name the device, since the overrides hold for all devices.
template <class Work>
auto with_device(const ComparedDevice* device, Work work) {
  try {
    return work();
  } catch (const InputError& error) {
    if (device == nullptr) throw;
    std::vector<InputError> faults;
    for (const InputError& fault : error.faults()) {
      if (fault.place().empty()) throw;  // of an option
      const bool is_of_type = fault.place().find("/device/") != std::string::npos && !device->has_place_for_mass;
      faults.emplace_back(fault.kind(), fmt::format("--device {}: {}", device->name, fault.place()),
                          fault.problem() + (is_of_type ? "; \"--device impedance\" leaves this one out" : ""));
    }
    throw InputError::all(faults);
  }
}

/// The rule by which a run is stable.
void set_rule(const LimitOptions& options, LimitQuestion& question) {
  question.bounded = options.stable == "bounded";
  if (!options.vibration.empty()) {
    if (!options.stable.empty() && options.stable != "still")
      throw InputError(fmt::format("--vibration: got it beside --stable {}; allowed: with still", options.stable));
    question.most_vibration = number_between("--vibration", options.vibration, 1e-9, 1e3);
  } else if (options.stable == "still" || (options.stable.empty() && !options.devices.empty())) {
    question.most_vibration = kMostVibration;
  }
  for (const std::string& bound : options.bounds) add_bound(bound, question.bounds);
}

LimitQuestion question_of(const LimitOptions& options, const ScenarioText& scene,
                          const std::vector<std::string>& overrides) {
  if (options.field.find('=') != std::string::npos) {
    throw InputError(
        fmt::format("--vary: got \"{}\"; allowed: a field alone, and its range as --between a:b", options.field));
  }
  LimitQuestion question = limit_question(scene, overrides, options.field, range_of("--between", options.between));
  question.smallest = options.smallest;
  if (!options.resolution.empty()) question.resolution = number_between("--resolution", options.resolution, 1e-6, 0.5);
  set_rule(options, question);
  return question;
}

/// Adds the cases of a scene with all algorithms. Warnings that are not among them yet are added.
void add_cases(const LimitOptions& options, LimitRow row, const ScenarioText& scene, std::vector<std::string> overrides,
               const std::vector<std::string>& algorithms, LimitTable& table, std::vector<std::string>& warnings) {
  with_device(row.device ? &*row.device : nullptr, [&] {
    if (row.device) overrides = overrides_on(*row.device, scene, overrides);
    row.scene = scene.file.stem().string();
    row.asked = {&scene, overrides, {}, question_of(options, scene, overrides)};
    const LoadedScenario loaded = load_scenario(scene, overrides);
    row.scenario = loaded.scenario;
    append_new(warnings, row.asked.question.warnings);
    append_new(warnings, with_files(loaded, check_named_files(loaded)));
    // A field of the rendering changes nothing of hand and device.
    if (row.asked.question.path.starts_with("rendering.")) row.asked.question.tremor = tremor_speeds(loaded);
    const std::vector<std::string> own = {loaded.scenario.rendering.algorithm};
    for (const std::string& algorithm : algorithms.empty() ? own : algorithms) {
      row.asked.algorithm = algorithm;
      table.rows.push_back(row);
    }
  });
}

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

std::vector<std::string> device_names() {
  std::vector<std::string> names = {"all", kPresets};
  for (const ComparedDevice& device : compared_devices()) names.push_back(device.name);
  return names;
}

std::vector<ComparedDevice> chosen_devices(const std::vector<std::string>& given) {
  std::vector<std::string> unknown;
  std::copy_if(given.begin(), given.end(), std::back_inserter(unknown),
               [](const std::string& name) { return !is_file(name) && !name.ends_with(']'); });
  if (!unknown.empty()) {
    const std::vector<std::string> names = device_names();
    chosen_names("--device: got", unknown, {names.begin() + 1, names.end()});
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
        fmt::format("--device: got a second device named \"{}\"; allowed: each name once, and a file is "
                    "named by what stands before .json",
                    device.name));
  }
  return chosen;
}

LimitTable limit_cases(const LimitOptions& options) {
  if (options.devices.empty() && !options.friction.empty())
    throw InputError("--friction: got factors; allowed: with --device");
  LimitTable table{.scenes = asked_scenes(options.scenarios), .has_devices = !options.devices.empty()};
  std::vector<std::optional<ComparedDevice>> devices = {std::nullopt};
  if (table.has_devices) {
    const std::vector<ComparedDevice> asked = asked_devices(options);
    devices.assign(asked.begin(), asked.end());
  }
  std::vector<std::string> algorithms;
  if (!options.algorithms.empty())
    algorithms = chosen_names("--algorithms: got", options.algorithms, algorithm_names());
  std::vector<Axis> axes;
  for (const std::string& text : options.over) axes.push_back(parse_axis(text));
  for (const Axis& axis : axes) table.over.push_back(axis.path);
  const Cases over({}, options.overrides, std::move(axes));
  table.columns = table.scenes.size() * std::max<std::size_t>(1, algorithms.size());
  std::vector<std::string> warnings;
  for (const std::optional<ComparedDevice>& device : devices) {
    for (std::size_t point = 0; point < over.size(); ++point) {
      for (const ScenarioText& scene : table.scenes)
        add_cases(options, {device, over.values(point)}, scene, over.overrides(point), algorithms, table, warnings);
    }
  }
  print_warnings(warnings);
  return table;
}

void add_limits(LimitTable& table, std::vector<FieldLimit> limits) {
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    LimitRow& row = table.rows[i];
    row.found = std::move(limits[i]);
    const FieldLimit& reference = table.rows[i - i % table.columns].found;
    if (!row.found.value || !reference.value) continue;
    row.stiffness_ratio = *row.found.value / *reference.value;
    if (const double lambda = reference.settled.lambda_max; lambda > 0.0)
      row.rendered_ratio = *row.stiffness_ratio * row.found.settled.lambda_max / lambda;
  }
}

}  // namespace hapbench
