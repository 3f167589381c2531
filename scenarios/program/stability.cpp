#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <array>
#include <cmath>

#include "results/io/json_text.hpp"
#include "results/io/table_writer.hpp"
#include "scenarios/description/bundled_scenarios.hpp"
#include "scenarios/description/load_scenario.hpp"
#include "scenarios/program/command.hpp"
#include "scenarios/program/result_tables.hpp"
#include "scenarios/program/table.hpp"
#include "scenarios/run/progress_bar.hpp"
#include "scenarios/studies/stability/stability_limits.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

struct StabilityOptions {
  std::vector<std::string> scenarios;
  std::string out;
  std::vector<std::string> overrides;
  OutputOptions output;
};

std::string_view case_name(StabilityCase which) {
  constexpr std::array<std::string_view, 4> kNames = {"stiffness_undamped", "damping_alone", "stiffness_damped",
                                                      "time_step"};
  return kNames[static_cast<std::size_t>(which)];  // in the order of the enumeration
}

const Field<StabilityLimit> kStabilityLimitFields[] = {
    {{"case", "",
      "what grows until the run is unstable: stiffness, damping or time step; stuck: the stiffness of a tool that dry friction holds"},
     [](const StabilityLimit& l) -> Cell { return std::string(l.stuck ? "stuck" : case_name(l.which)); }},
    {{"unit", "", "unit of the limit"}, [](const StabilityLimit& l) -> Cell { return l.unit; }},
    {{"analytic", "unit", "the limit in closed form; empty where the integrator has none"},
     [](const StabilityLimit& l) { return cell_if(l.analytic); }},
    {{"eigenvalue", "unit", "by bisection on the eigenvalues of a step"},
     [](const StabilityLimit& l) -> Cell { return l.eigenvalue; }},
    {{"simulation", "unit", "by bisection on runs"}, [](const StabilityLimit& l) -> Cell { return l.simulation; }},
    {{"simulation_tolerance", "unit", "how far beyond `simulation` the edge may lie"},
     [](const StabilityLimit& l) {
       return std::isfinite(l.simulation) ? Cell(kLimitTolerance * l.simulation) : Cell();
     },
     Field<StabilityLimit>::In::json},
    {{"damping_at_limit_N_s_per_m", "N s/m", "B at the limit"},
     [](const StabilityLimit& l) -> Cell { return l.damping_at_limit; }},
    {{"lambda_max", "1", "largest eigenvalue of S: stiffness of the springs in units of K"},
     [](const StabilityLimit& l) -> Cell { return l.lambda; }}};

const Field<RootLocusPoint> kRootLocusFields[] = {
    {{"case", "", "what grows"}, [](const RootLocusPoint& p) -> Cell { return std::string(case_name(p.which)); }},
    {{"value", "unit", "its value, in the unit of the case in limits.csv"},
     [](const RootLocusPoint& p) -> Cell { return p.value; }},
    {{"first_real", "1", "real part of an eigenvalue of a step"},
     [](const RootLocusPoint& p) -> Cell { return p.first.real(); }},
    {{"first_imaginary", "1", "its imaginary part"}, [](const RootLocusPoint& p) -> Cell { return p.first.imag(); }},
    {{"second_real", "1", "real part of the other eigenvalue"},
     [](const RootLocusPoint& p) -> Cell { return p.second.real(); }},
    {{"second_imaginary", "1", "its imaginary part"}, [](const RootLocusPoint& p) -> Cell { return p.second.imag(); }},
    {{"spectral_radius", "1", "largest |eigenvalue|; above 1: unstable"},
     [](const RootLocusPoint& p) -> Cell { return spectral_radius(p.first, p.second); }}};

Json limits_json(const LoadedScenario& loaded, const std::vector<StabilityLimit>& limits) {
  Json rows = Json::array();
  for (const StabilityLimit& limit : limits) add_row(rows.emplace_back(Json::object()), kStabilityLimitFields, limit);
  return {{"name", loaded.scenario.name},
          {"algorithm", loaded.scenario.rendering.algorithm},
          {"integrator", loaded.scenario.integrator.type->info.name},
          {"limits", std::move(rows)}};
}

/// Explains why the runs differ from the theory, which assumes a constant stiffness, by more than 1 %; else empty.
std::string disagreement_text(const std::vector<StabilityLimit>& limits) {
  for (const StabilityLimit& limit : limits) {
    if (std::abs(limit.simulation / limit.limit() - 1.0) <= 0.01 || limit.simulation == limit.limit()) continue;
    return "\nThe runs differ from the limit in theory by more than 1 %: this algorithm's stiffness is not constant.\n";
  }
  return "";
}

/// A limit for people; "none" where nothing is unstable. `tolerance`: relative, if not of rounding.
std::string limit_text(double limit, double tolerance = 0.0) {
  return std::isinf(limit) ? "none" : deserved(limit, tolerance * limit, 6);
}

const std::vector<Table::Column> kLimitHeadings = {
    {"limit", false}, {"analytic"},    {"eigenvalues", true, "eigenvalue"},
    {"simulation"},   {"unit", false}, {"B there N s/m", true, "damping_at_limit_N_s_per_m"}};

std::string limits_text(const LoadedScenario& loaded, const std::vector<StabilityLimit>& limits) {
  Table table(kLimitHeadings);
  for (const StabilityLimit& limit : limits) {
    table.add({limit.name, limit_text(limit.analytic.value_or(std::nan(""))), limit_text(limit.eigenvalue),
               limit_text(limit.simulation, kLimitTolerance), limit.unit, significant(limit.damping_at_limit, 5)});
  }
  const RenderingConfig& rendering = loaded.scenario.rendering;
  return fmt::format("{}: {}, {}, M = {} kg, dt = {} s, zeta = {}, lambda_max(S) = {}\n\n{}", loaded.scenario.name,
                     rendering.algorithm, loaded.scenario.integrator.type->info.name, rendering.mass,
                     loaded.scenario.time.step, rendering.damping_ratio, significant(limits.front().lambda, 6),
                     table.text()) +
         disagreement_text(limits);
}

int stability(const StabilityOptions& options) {
  std::vector<LoadedScenario> scenarios;
  for (const std::string& argument : options.scenarios) {
    scenarios.push_back(load_scenario(find_scenario(argument), options.overrides));
  }
  // Everything is computed before anything is written.
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
    FileSet files;
    write_csv(directory / "limits.csv", kStabilityLimitFields, limits, &files);
    write_csv(directory / "root_locus.csv", kRootLocusFields, root_locus(loaded.scenario, limits), &files);
    files.write(directory / "scenario.effective.json", json_text(effective_scenario(loaded.scenario, directory)));
    files.commit();
    text += limits_text(loaded, limits) + fmt::format("\nroot locus in {}\n", (directory / "root_locus.csv").string());
    json.push_back(limits_json(loaded, limits));
  }
  print(options.output, text, json);
  return kSuccess;
}

}  // namespace

std::vector<Table::Column> stability_headings() {
  return kLimitHeadings;
}

std::vector<Column> stability_limit_columns() {
  return columns_of(kStabilityLimitFields);
}

std::vector<Column> root_locus_columns() {
  return columns_of(kRootLocusFields);
}

void add_stability(CommandLine& line) {
  auto [command, options] = line.command("stability", "Find the stability limits of springs (thesis A.3)", stability);
  command.add("scenarios", options.scenarios, "springs scenarios: files, or names of bundled ones").required();
  command.add("--out", options.out, "directory of the results (default: results/out/stability_NAME)");
  add_overrides(command, options.overrides);
  add_output_options(command, options.output);
}

}  // namespace hapbench
