#include "scenarios/program/limit/question.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iterator>

#include "scenarios/analysis/stability/compared_devices.hpp"
#include "scenarios/batch/axis.hpp"
#include "scenarios/batch/cases.hpp"
#include "scenarios/input/bundled_scenarios.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/program/chosen_devices.hpp"
#include "scenarios/program/names.hpp"
#include "scenarios/program/option_values.hpp"
#include "scenarios/run/checked_scenario.hpp"
#include "scenarios/run/vibration_limit.hpp"
#include "scenarios/scene/field_files.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "scenarios/scene/overrides.hpp"
#include "scenarios/scene/scenario.hpp"

namespace hapbench {
namespace {

constexpr const char* kNoFriction = "none";

/// Returns true if --set changes fields of the devices. Throws InputError if --set would select another device.
bool are_devices_changed(const LimitOptions& options) {
  const bool has_factors = !options.friction.empty() && options.friction != std::vector<std::string>{kNoFriction};
  bool is_changed = false;
  for (const std::string& override : options.overrides) {
    const std::string_view path = overridden_path(override);
    is_changed = is_changed || path.starts_with("device.");
    if (path == "device" || path == "device.type" || path == "device.preset") {
      fail_in({.about_options = {"--set", "--device"}},
              fmt::format(
                  "--set: got {} with --device; allowed: fields of the devices, such as device.delay_samples; a device "
                  "of your own goes into --device, as a file NAME.json",
                  path));
    }
    if (path == "device.coulomb_N" && has_factors)
      fail_in({.about_options = {"--friction", "--set"}},
              "--friction: cannot be combined with --set device.coulomb_N; allowed: one of the two");
  }
  return is_changed;
}

/// Returns the selected devices, each followed by its variants. With --friction none, there are no variants. Otherwise,
/// the values of --friction are factors, and each variant is the device with its friction multiplied by one factor.
/// Without --friction, the variants are the device at both ends of the range of its unpublished parameters. If --set
/// changes a preset, "*" is appended to the name of the preset.
std::vector<ComparedDevice> device_variants(const LimitOptions& options) {
  const bool none_other = options.friction == std::vector<std::string>{kNoFriction};
  const bool is_changed = are_devices_changed(options);
  std::vector<ComparedDevice> devices;
  for (ComparedDevice device : chosen_devices(options.devices)) {
    const bool is_end = device.name.ends_with(']');
    if (is_changed && device.published_stiffness) {  // the published limit does not hold for the changed device
      device.name += '*';
      device.published_stiffness.reset();
    }
    devices.push_back(device);
    // Add the variants of the device.
    if (none_other) continue;
    for (const std::string& factor : options.friction)
      if (const auto other = with_friction_times(device, parse_bounded_number("--friction", factor, 0.0, 1e3)))
        devices.push_back(*other);
    if (options.friction.empty() && !is_end)
      std::ranges::move(with_unpublished_numbers(device), std::back_inserter(devices));
  }
  return devices;
}

/// Returns the error with the device's name in its location. The name is needed because the overrides apply to all
/// devices.
InputError on_device(const ComparedDevice& device, const InputError& error) {
  std::vector<InputError> faults;
  for (const InputError& fault : error.faults()) {
    if (fault.location_text().empty()) return error;  // the error is about an option, not a file
    ErrorLocation location = fault.location();
    const bool is_of_type = location.pointer.starts_with("/device/") && !device.has_place_for_mass;
    location.option = fmt::format("--device {}", device.name);
    location.about_options.emplace_back("--device");
    faults.emplace_back(fault.kind(), location,
                        fault.problem() + (is_of_type ? "; \"--device impedance\" leaves this device out" : ""));
  }
  return InputError::all(faults);
}

/// Returns the question for a scene. By default, a run is stable by the rule of the command `tune`. Throws InputError
/// if an option is invalid.
LimitQuestion question_of(const LimitOptions& options, const ScenarioText& scene, const Scenario& scenario,
                          const std::vector<std::string>& overrides) {
  if (options.field.find('=') != std::string::npos)
    fail_in_option("--vary",
                   fmt::format("got \"{}\"; allowed: a field alone, and its range as --between a:b", options.field));
  // Set the search.
  LimitQuestion question = limit_question(scene, overrides, options.field, parse_range("--between", options.between));
  question.search.smallest = options.smallest;
  if (!options.resolution.empty())
    question.search.resolution = parse_bounded_number("--resolution", options.resolution, 1e-6, 0.5);
  question.between = options.devices.empty() && options.over.empty();
  // Set the rule for stable runs.
  question.rule.bounded = options.stable == "bounded";
  if (!options.vibration.empty()) {
    if (!options.stable.empty() && options.stable != "still")
      fail_in({.about_options = {"--vibration", "--stable"}},
              fmt::format("--vibration: cannot be combined with --stable {}; allowed: with still", options.stable));
    question.rule.max_vibration = parse_bounded_number("--vibration", options.vibration, 1e-9, 1e3);
  } else if (options.stable.empty()) {
    question.rule.max_vibration = rule_of(scenario).max_vibration;
  } else if (options.stable == "still") {
    question.rule.max_vibration = kMaxVibration;
  }
  for (const std::string& bound : options.bounds) add_bound(bound, question.rule.bounds);
  return question;
}

/// Returns the warnings. In warnings about fields of the device, replaces the scene's file by "--device NAME", because
/// this option replaces the file's device. Returns the warnings unchanged if `device` is null.
std::vector<std::string> of_option(const ComparedDevice* device, std::vector<std::string> warnings) {
  if (device == nullptr) return warnings;
  for (std::string& warning : warnings)
    if (const std::size_t end = warning.find(": /device/"); end != std::string::npos)
      warning.replace(0, end, "--device " + device->name);
  return warnings;
}

}  // namespace

LimitTable make_limit_table(const LimitOptions& options) {
  if (options.devices.empty() && !options.friction.empty())
    fail_in_option("--friction", "got factors; allowed: with --device");
  const std::vector<std::filesystem::path> files = find_scenarios(options.scenarios);
  const Axis scene{.path = kSceneAxis, .values = names_of_scenarios(files)};
  // Read the scenes.
  std::vector<ScenarioText> scenes;
  std::transform(files.begin(), files.end(), std::back_inserter(scenes), read_scenario_text);
  std::vector<ComparedDevice> devices;
  std::vector<Axis> axes = {{.path = "--device", .values = {""}, .named = true}};
  if (!options.devices.empty()) {
    devices = device_variants(options);
    axes[0].values = names_of(devices, &ComparedDevice::name);
  }
  // Make the axes in the order of LimitTable::cases.
  Axis algorithm{.path = "--algorithms", .values = {""}, .named = true};
  if (!options.algorithms.empty()) algorithm = {"rendering.algorithm", chosen_algorithms(options.algorithms)};
  for (const std::string& text : options.over) axes.push_back(parse_axis(text, false, "--over"));
  axes.insert(axes.end(), {scene, algorithm});
  return {std::move(devices), Cases(std::move(scenes), options.overrides, std::move(axes))};
}

LimitRow make_limit_row(const LimitOptions& options, const LimitTable& table, std::size_t i,
                        std::vector<std::string>& warnings) {
  LimitRow row;
  row.axis_values = table.cases.values(i);
  if (!table.devices.empty()) row.device = &table.devices[table.cases.value_index(i, 0)];
  const ScenarioText& scene = table.cases.scene(i);
  try {
    std::vector<std::string> overrides = table.cases.overrides(i);
    if (row.device != nullptr) overrides = overrides_on(*row.device, scene, overrides);
    const LoadedScenario loaded = load_scenario(scene, overrides);
    row.scenario = loaded.scenario;
    row.question = question_of(options, scene, row.scenario, overrides);
    append_new(warnings, of_option(row.device, row.question.warnings));
    append_new(warnings, of_option(row.device, with_files(loaded, checked(loaded).file_warnings())));
    // The searched field itself may be the one with which runs have the metric.
    const Range& range = row.question.search.range;
    if (!row.question.rule.bounds.empty())
      require_bounded_metrics(row.question.rule.bounds,
                              {loaded, row.question.at(range.from), row.question.at(range.to)});
  } catch (const InputError& error) {
    throw row.device != nullptr ? on_device(*row.device, error) : error;
  }
  return row;
}

}  // namespace hapbench
