#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <array>
#include <cmath>
#include <memory>

#include "results/io/atomic_file.hpp"
#include "results/io/csv_writer.hpp"
#include "results/io/json_text.hpp"
#include "scenarios/batch/parallel_for.hpp"
#include "scenarios/description/bundled_scenarios.hpp"
#include "scenarios/description/load_scenario.hpp"
#include "scenarios/program/result_tables.hpp"
#include "scenarios/program/stability.hpp"
#include "scenarios/program/table.hpp"
#include "scenarios/run/progress_bar.hpp"
#include "scenarios/studies/stability/stability_limits.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

std::string_view case_name(StabilityCase which) {
  // In the order of the enumeration.
  constexpr std::array<std::string_view, 4> kNames = {"stiffness_undamped", "damping_alone", "stiffness_damped",
                                                      "time_step"};
  return kNames[static_cast<std::size_t>(which)];
}

void write_limits(const fs::path& file, const std::vector<StabilityLimit>& limits) {
  CsvWriter csv(file, kStabilityLimitColumns);
  for (const StabilityLimit& limit : limits) {
    csv.row(case_name(limit.which), std::string_view(limit.unit), limit.analytic, limit.eigenvalue, limit.simulation,
            limit.damping_at_limit, limit.lambda);
  }
  csv.finish();
}

void write_root_locus(const fs::path& file, const std::vector<RootLocusPoint>& locus) {
  CsvWriter csv(file, kRootLocusColumns);
  for (const RootLocusPoint& point : locus) {
    csv.row(case_name(point.which), point.value, point.first.real(), point.first.imag(), point.second.real(),
            point.second.imag(), std::max(std::abs(point.first), std::abs(point.second)));
  }
  csv.finish();
}

Json limits_json(const LoadedScenario& loaded, const std::vector<StabilityLimit>& limits) {
  Json rows = Json::array();
  for (const StabilityLimit& limit : limits) {
    rows.push_back({{"case", case_name(limit.which)},
                    {"unit", limit.unit},
                    {"analytic", limit.analytic ? Json(*limit.analytic) : Json(nullptr)},
                    {"eigenvalue", limit.eigenvalue},
                    {"simulation", limit.simulation},
                    {"damping_at_limit_N_s_per_m", limit.damping_at_limit},
                    {"lambda_max", limit.lambda}});
  }
  return {{"name", loaded.scenario.name},
          {"algorithm", loaded.scenario.rendering.algorithm},
          {"integrator", loaded.scenario.integrator.type->info.name},
          {"limits", std::move(rows)}};
}

/// Warning for limits in which theory and runs disagree by more than 1 %: the theory assumes a constant stiffness.
std::string disagreement_text(const std::vector<StabilityLimit>& limits) {
  for (const StabilityLimit& limit : limits) {
    if (std::abs(limit.simulation / limit.limit() - 1.0) <= 0.01 || limit.simulation == limit.limit()) continue;
    return "\nThe runs differ from the limit in theory by more than 1 %: this algorithm's stiffness is not constant.\n";
  }
  return "";
}

/// "none" where nothing is unstable.
std::string limit_text(double limit) {
  return std::isinf(limit) ? "none" : significant(limit, 6);
}

std::string limits_text(const LoadedScenario& loaded, const std::vector<StabilityLimit>& limits) {
  Table table({{"limit", false}, {"analytic"}, {"eigenvalues"}, {"simulation"}, {"unit", false}, {"B there N s/m"}});
  for (const StabilityLimit& limit : limits) {
    table.add({limit.name, limit_text(limit.analytic.value_or(std::nan(""))), limit_text(limit.eigenvalue),
               limit_text(limit.simulation), limit.unit, significant(limit.damping_at_limit, 5)});
  }
  const RenderingConfig& rendering = loaded.scenario.rendering;
  return fmt::format("{}: {}, {}, M = {} kg, dt = {} s, zeta = {}, lambda_max(S) = {}\n\n{}", loaded.scenario.name,
                     rendering.algorithm, loaded.scenario.integrator.type->info.name, rendering.mass,
                     loaded.scenario.time.step, rendering.damping_ratio, significant(limits.front().lambda, 6),
                     table.text()) +
         disagreement_text(limits);
}

int limits(const StabilityOptions& options) {
  if (options.scenarios.empty()) {
    throw InputError("stability: got no scenario; allowed: springs scenarios, --map, --stress, --search");
  }
  std::vector<LoadedScenario> scenarios;
  for (const std::string& argument : options.scenarios) {
    scenarios.push_back(load_scenario(find_scenario(argument), options.overrides));
  }
  // All of it is found before anything is written.
  std::vector<std::vector<StabilityLimit>> all_limits;
  for (const LoadedScenario& loaded : scenarios) {
    const WaitNotice notice(loaded.scenario.name + ": limits", !options.output.quiet);
    all_limits.push_back(with_file(loaded, [&] { return stability_limits(loaded.scenario); }));
  }
  const std::vector<fs::path> directories =
      output_directories(options.out, scenarios, "stability_", "one of each name");
  for (const fs::path& directory : directories) require_writable_directory(directory);

  std::string text;
  Json json = Json::array();
  for (std::size_t i = 0; i < scenarios.size(); ++i) {
    const LoadedScenario& loaded = scenarios[i];
    const std::vector<StabilityLimit>& limits = all_limits[i];
    const fs::path& directory = directories[i];
    write_limits(directory / "limits.csv", limits);
    write_root_locus(directory / "root_locus.csv", root_locus(loaded.scenario, limits));
    write_file_atomically(directory / "scenario.effective.json",
                          json_text(effective_scenario(loaded.scenario, directory)));
    text += limits_text(loaded, limits) + fmt::format("\nroot locus in {}\n", (directory / "root_locus.csv").string());
    json.push_back(limits_json(loaded, limits));
  }
  print(options.output, text, json);
  return kSuccess;
}

int stability(const StabilityOptions& options) {
  require_algorithms(options.algorithms);
  const bool has_algorithms = !options.maps.empty() || options.search;
  if (!options.algorithms.empty() && !has_algorithms) {
    throw InputError("--algorithms: got names; allowed: with --map and --search only");
  }
  if (!options.overrides.empty() && options.stress)
    throw InputError("--set: got an override; allowed: with scenarios and --map only");
  if (!options.maps.empty()) return stability_maps_command(options);
  if (options.stress) return stability_stress_command(options);
  if (options.search) return stability_search_command(options);
  return limits(options);
}

/// What is asked for is said by exactly one of these; each has options of its own.
void add_experiments(Command& command, StabilityOptions& options) {
  CommandOption scenarios =
      command.add("scenarios", options.scenarios,
                  "springs scenarios, for their limits; with --search the scene: files, or names of bundled ones");
  CommandOption map = command.add("--map", options.maps,
                                  "maps of stable, dying, vibrating and diverged runs: names separated by commas, or "
                                  "all (see \"hapbench describe stability\")");
  map.comma_separated();
  CommandOption stress = command.flag("--stress", options.stress, "random contact sets through every algorithm");
  CommandOption search =
      command.flag("--search", options.search, "the hand's motion that an algorithm renders worst in a scene");
  map.excludes(stress).excludes(search).excludes(scenarios);
  stress.excludes(search).excludes(scenarios);

  command.add("--size", options.size, "points of a map along each side (default: 17)").range(2, 101).needs(map);
  command.add("--integrators", options.integrators, "of --map: names separated by commas, or all (default: leapfrog)")
      .comma_separated()
      .needs(map);
  command.add("--count", options.count, "contact sets of --stress (default: 100000)")
      .range(std::uint64_t{1}, std::uint64_t{1'000'000'000})
      .needs(stress);
  command.add("--objective", options.objective, "what --search makes large: created energy (default), vibration")
      .one_of({"created", "vibration"})
      .needs(search);
  command.add("--evaluations", options.evaluations, "runs of --search before minimising (default: 400)")
      .range(std::uint64_t{1}, std::uint64_t{1'000'000'000})
      .needs(search);
  command.add("--seed", options.seed, "of --stress and --search (default: 1)")
      .range(std::uint64_t{0}, std::uint64_t{1} << 53)
      .excludes(map);
  command.add("--jobs", options.jobs, "threads (default: as many as the machine has)").range(1, 1024);
  command
      .add("--algorithms", options.algorithms,
           "of --map and --search: names separated by commas (default: all, of --search the scene's own)")
      .comma_separated();
}

}  // namespace

std::vector<std::string> StabilityOptions::chosen_algorithms() const {
  return algorithms.empty() ? all_algorithms() : algorithms;
}

fs::path StabilityOptions::directory(const std::string& name) const {
  return out.empty() ? fs::path("results") / "out" / name : fs::path(out);
}

JobOptions StabilityOptions::job_options(const std::string& label) const {
  return {jobs == 0 ? static_cast<unsigned>(available_threads()) : jobs, output.quiet ? "" : label};
}

void add_stability(CommandLine& line) {
  auto options = std::make_shared<StabilityOptions>();
  Command command = line.command(
      "stability",
      "Stability limits of springs (thesis A.3), stability maps, stress test, search for the worst motion");
  add_experiments(command, *options);
  command.add("--out", options->out, "directory of the results (default: results/out/stability_NAME)");
  command
      .add("--set", options->overrides,
           "override a field: path=value; with --map time.step_s and those of device and hand")
      .repeatable();
  add_output_options(command, options->output);
  command.runs([options] { return stability(*options); }, "maps and searches that were complete are kept");
}

}  // namespace hapbench
