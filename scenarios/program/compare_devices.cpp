#include "scenarios/program/compare_devices.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "results/io/csv_writer.hpp"
#include "scenarios/batch/parallel_for.hpp"
#include "scenarios/description/bundled_scenarios.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/program/device_limits_text.hpp"
#include "scenarios/program/result_tables.hpp"
#include "scenarios/run/assemble.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

std::vector<ComparedDevice> chosen_devices(const std::vector<std::string>& given) {
  std::vector<ComparedDevice> all = compared_devices(), chosen;
  std::vector<std::string> names;
  for (const ComparedDevice& device : all) names.push_back(device.name);
  for (const std::string& name : chosen_names("--devices: got", given, names)) {
    chosen.push_back(*std::find_if(all.begin(), all.end(), [&](const auto& device) { return device.name == name; }));
  }
  return chosen;
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
  DeviceQuestion question;
  question.devices = chosen_devices(options.devices);
  question.scenes = chosen_scenes(options.scenarios);
  question.algorithms = options.algorithms.empty()
                            ? std::vector<std::string>{"shaped_stiffness", "summation"}
                            : chosen_names("--algorithms: got", options.algorithms, all_algorithms());
  question.overrides = options.overrides;
  question.most_vibration = options.vibration.empty() ? kMostVibration : vibration_of(options.vibration);
  if (!options.resolution.empty()) question.resolution = resolution_of(options.resolution);
  return question;
}

/// Each once.
void print_all_warnings(const DeviceQuestion& question) {
  std::vector<std::string> warnings;
  for (const ComparedDevice& device : question.devices) {
    for (const ScenarioText& scene : question.scenes) {
      const LoadedScenario loaded = load_scenario(scene, overrides_on(device, scene, question.overrides));
      for (const auto& some : {loaded.warnings, check_named_files(loaded)}) {
        for (const std::string& warning : some) {
          if (std::find(warnings.begin(), warnings.end(), warning) == warnings.end()) warnings.push_back(warning);
        }
      }
    }
  }
  print_warnings(warnings);
}

void write(const fs::path& directory, const DeviceQuestion& question, const std::vector<DeviceLimit>& limits) {
  CsvWriter table(directory / "device_limits.csv", kDeviceLimitColumns);
  CsvWriter runs(directory / "device_runs.csv", kDeviceRunColumns);
  for (const DeviceLimit& found : limits) {
    const ComparedDevice& device = question.devices[found.device];
    const std::string scene = scene_name(question, found.scene);
    const FieldLimit& limit = found.limit;
    const auto settled = [&limit](double value) { return limit.value ? std::optional(value) : std::nullopt; };
    const DeviceRatio ratio = ratio_of(found, limits.at(reference_of(question, found.device)));
    table.row(std::string_view(device.name), std::string_view(scene), std::string_view(limit.algorithm), limit.value,
              limit.beyond ? std::optional(limit.beyond->value) : std::nullopt, std::string_view(beyond_text(limit)),
              device.published_stiffness, limit.value ? limit.settled.vibration : std::nullopt,
              settled(limit.settled.contacts), settled(limit.settled.lambda_max), ratio.stiffness, ratio.rendered,
              std::uint64_t{limit.runs.size()}, std::uint64_t{limit.astray.size()});
    for (const JudgedValue& run : limit.runs) {
      runs.row(std::string_view(device.name), std::string_view(scene), std::string_view(limit.algorithm), run.value,
               run_verdict_name(run.verdict));
    }
  }
  table.finish();
  runs.finish();
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
  write(out, question, limits);
  print(options.output, device_limits_text(question, limits) + fmt::format("\nresults in {}\n", out.string()),
        device_limits_json(question, limits));
  return kSuccess;
}

}  // namespace hapbench
