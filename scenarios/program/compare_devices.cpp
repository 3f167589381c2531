#include "scenarios/program/compare_devices.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>

#include "scenarios/batch/parallel_for.hpp"
#include "scenarios/description/bundled_scenarios.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/program/device_limits_text.hpp"
#include "scenarios/run/assemble.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

bool is_file(const std::string& name) {
  return name.ends_with(".json");
}

constexpr const char* kPresets = "impedance";  ///< all of the program with that type

/// Those of the program by their names or type, and files. Each name once, since it is all that tells the rows apart.
std::vector<ComparedDevice> chosen_devices(const std::vector<std::string>& given) {
  const std::vector<ComparedDevice> all = compared_devices();
  std::vector<std::string> known = {kPresets}, named;
  for (const ComparedDevice& device : all) known.push_back(device.name);
  std::remove_copy_if(given.begin(), given.end(), std::back_inserter(named), is_file);
  if (!named.empty()) chosen_names("--devices: got", named, known);

  std::vector<ComparedDevice> chosen;
  for (const std::string& name : given) {
    if (is_file(name)) chosen.push_back(device_of_file(name));
    std::copy_if(all.begin(), all.end(), std::back_inserter(chosen), [&name](const ComparedDevice& device) {
      return name == "all" || name == device.name || (name == kPresets && device.published_stiffness);
    });
  }
  std::set<std::string> names;
  for (const ComparedDevice& device : chosen) {
    if (!names.insert(device.name).second)
      throw InputError(
          fmt::format("--devices: got a second device named \"{}\"; allowed: each name once, and a file is "
                      "named by what stands before .json",
                      device.name));
  }
  return chosen;
}

/// Another device for all rows would leave them their names alone.
void require_fields_alone(const std::vector<std::string>& overrides) {
  for (const std::string& override : overrides) {
    const std::string_view path = overridden_path(override);
    if (path != "device" && path != "device.type" && path != "device.preset") continue;
    throw InputError(fmt::format(
        "--set: got {} with --devices; allowed: fields of the devices, such as device.delay_samples; a device "
        "of your own goes into --devices, as a file NAME.json",
        path));
  }
}

std::vector<ScenarioText> chosen_scenes(const std::vector<std::string>& given) {
  std::vector<ScenarioText> scenes;
  std::set<fs::path> names;
  for (const fs::path& file : find_scenarios(given.empty() ? default_device_scenes() : given)) {
    if (!names.insert(file.stem()).second) {
      throw InputError(fmt::format("{}: a second scenario named \"{}\"; allowed: each name once", file.string(),
                                   file.stem().string()));
    }
    scenes.push_back(read_scenario_text(file));
  }
  return scenes;
}

DeviceQuestion question_of(const CompareDevicesOptions& options) {
  require_fields_alone(options.overrides);
  DeviceQuestion question;
  for (const ComparedDevice& device : chosen_devices(options.devices))
    question.devices.push_back(with_marked_name(device, options.overrides));
  question.scenes = chosen_scenes(options.scenarios);
  question.algorithms = options.algorithms.empty()
                            ? std::vector<std::string>{"shaped_stiffness", "summation"}
                            : chosen_names("--algorithms: got", options.algorithms, all_algorithms());
  question.overrides = options.overrides;
  question.most_vibration = options.vibration.empty() ? kMostVibration : vibration_of(options.vibration);
  if (!options.resolution.empty()) question.resolution = resolution_of(options.resolution);
  return question;
}

/// The scene on the device. A fault is one of the device that is named, since the overrides are for all.
LoadedScenario load_on(const ComparedDevice& device, const ScenarioText& scene,
                       const std::vector<std::string>& overrides) {
  try {
    return load_scenario(scene, overrides_on(device, scene, overrides));
  } catch (const InputError& error) {
    std::vector<InputError> faults;
    for (const InputError& fault : error.faults()) {
      const bool is_of_type = fault.place().find("/device/") != std::string::npos && !device.has_place_for_mass;
      faults.emplace_back(fault.kind(), fmt::format("--devices {}: {}", device.name, fault.place()),
                          fault.problem() + (is_of_type ? "; \"--devices impedance\" leaves this one out" : ""));
    }
    throw InputError::all(faults);
  }
}

/// Each once.
void print_all_warnings(const DeviceQuestion& question) {
  std::vector<std::string> warnings;
  for (const ComparedDevice& device : question.devices) {
    for (const ScenarioText& scene : question.scenes) {
      const LoadedScenario loaded = load_on(device, scene, question.overrides);
      for (const auto& some : {loaded.warnings, check_named_files(loaded)}) {
        for (const std::string& warning : some) {
          if (std::find(warnings.begin(), warnings.end(), warning) == warnings.end()) warnings.push_back(warning);
        }
      }
    }
  }
  print_warnings(warnings);
}

double number_between(const char* option, const std::string& text, double least, double greatest) {
  const auto number = finite_number(text);
  if (number && *number >= least && *number <= greatest) return *number;
  throw InputError(fmt::format("{}: got \"{}\"; allowed: {} ... {}", option, text, least, greatest));
}

}  // namespace

double vibration_of(const std::string& text) {
  return number_between("--vibration", text, 1e-9, 1e3);
}

double resolution_of(const std::string& text) {
  return number_between("--resolution", text, 1e-6, 0.5);
}

int compare_devices(const CompareDevicesOptions& options) {
  const DeviceQuestion question = question_of(options);
  print_all_warnings(question);
  const fs::path out = options.out.empty() ? fs::path("results") / "out" / "compare_devices" : fs::path(options.out);
  require_writable_directory(out);
  const JobOptions jobs{options.jobs == 0 ? static_cast<unsigned>(available_threads()) : options.jobs,
                        options.output.quiet ? "" : "compare"};
  const std::vector<DeviceLimit> limits = device_limits(question, jobs);
  write_device_limits(out, question, limits);
  print(options.output, device_limits_text(question, limits) + fmt::format("\nresults in {}\n", out.string()),
        device_limits_json(question, limits));
  return kSuccess;
}

}  // namespace hapbench
