#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdio>
#include <optional>

#include "results/io/atomic_file.hpp"
#include "results/io/json_text.hpp"
#include "results/io/table_writer.hpp"
#include "scenarios/description/bundled_scenarios.hpp"
#include "scenarios/description/load_scenario.hpp"
#include "scenarios/program/command.hpp"
#include "scenarios/program/result_tables.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/progress_bar.hpp"
#include "scenarios/studies/precision/measure.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

struct PrecisionCommandOptions {
  std::vector<std::string> studies;
  std::string scenario;
  std::string out;
  std::vector<std::string> overrides;
  int repetitions = PrecisionOptions{}.repetitions;
  OutputOptions output;
};

std::vector<std::string> study_names() {
  return names_of(kPrecisionStudies, &PrecisionStudy::name);
}

std::vector<const PrecisionStudy*> chosen_studies(const std::vector<std::string>& given) {
  const std::vector<std::string> all = study_names();
  std::vector<const PrecisionStudy*> studies;
  for (const std::string& name : chosen_names("got study", given, all)) {
    const auto study = std::find(all.begin(), all.end(), name) - all.begin();
    studies.push_back(kPrecisionStudies[static_cast<std::size_t>(study)]);
  }
  return studies;
}

/// Writes errors and times into separate files: the errors are the same bytes in every run.
void write_study(const fs::path& directory, const PrecisionStudy& study, const PrecisionResult& result) {
  std::string errors = "setting,outcome", times = fmt::format("setting,seconds_per_{}\n", result.timed);
  for (const std::string& column : result.columns) errors += "," + column;
  errors += "\n";
  for (const PrecisionRow& row : result.rows) {
    errors += row.setting + "," + row.outcome;
    for (const auto& value : row.values) errors += value ? fmt::format(",{}", *value) : ",";
    errors += "\n";
    times += fmt::format("{},{}\n", row.setting, row.seconds);
  }
  FileSet files;
  files.write(directory / fmt::format("precision_{}.csv", study.name), errors);
  files.write(directory / fmt::format("precision_{}_timing.csv", study.name), times);
  files.commit();
}

std::string study_text(const PrecisionStudy& study, const PrecisionResult& result) {
  std::vector<Table::Column> columns = precision_headings(result.timed);
  for (const std::string& column : result.columns) columns.insert(columns.end() - 1, {column});
  Table table(columns);
  for (const PrecisionRow& row : result.rows) {
    std::vector<std::string> cells = {row.setting, row.outcome};
    for (std::size_t i = 0; i < row.values.size(); ++i) {
      const auto& value = row.values[i];
      const bool of_reference = row.tolerance && value && result.columns[i].starts_with("error_");
      cells.push_back(of_reference ? deserved(*value, *row.tolerance * *value) : significant(value));
    }
    cells.push_back(significant(1e6 * row.seconds, 3));
    table.add(std::move(cells));
  }
  std::string text = fmt::format("{}: {}\n\n{}", study.name, study.summary, table.text());
  for (const ObservedOrder& order : result.orders) {
    text += fmt::format("order of {} between the finest two, {}: {} +- {} (change from the two before)\n", order.error,
                        order.series, deserved(order.order.value, 0.1 * order.order.uncertainty, 3),
                        significant(order.order.uncertainty, 2));
  }
  return text + "\n";
}

Json study_json(const PrecisionStudy& study, const PrecisionResult& result) {
  Json rows = Json::array();
  for (const PrecisionRow& row : result.rows) {
    Json json = {{"setting", row.setting}, {"outcome", row.outcome}};
    for (std::size_t i = 0; i < result.columns.size(); ++i) {
      json[result.columns[i]] = or_null(row.values[i]);
    }
    if (row.tolerance) json["error_tolerance_relative"] = *row.tolerance;
    json["seconds_per_" + result.timed] = row.seconds;
    rows.push_back(std::move(json));
  }
  Json orders = Json::array();
  for (const ObservedOrder& order : result.orders) {
    orders.push_back({{"series", order.series},
                      {"error", order.error},
                      {"order", order.order.value},
                      {"uncertainty", order.order.uncertainty}});
  }
  return {{"study", study.name}, {"rows", std::move(rows)}, {"orders", std::move(orders)}};
}

/// The studies are about the rendering: an ideal device with the same force limit takes the place of others, which
/// would add dynamics of their own. That must not be taken for a result about a device that somebody asked for.
void check_device(const LoadedScenario& loaded, bool overridden) {
  const DeviceFields& device = loaded.scenario.device;
  if (std::holds_alternative<IdealDeviceFields>(device)) return;
  if (overridden || handle_moves_tool(device)) {
    const auto limit = input_force_limit(device);
    throw InputError(fmt::format(
        "{}: /device/type: got another device; allowed for the studies: \"ideal\", because they measure the rendering "
        "alone (--set 'device={{\"type\":\"ideal\"{}}}')",
        loaded.file.string(), limit ? fmt::format(",\"force_limit_N\":{}", *limit) : ""));
  }
  print_note(
      fmt::format("{}: the studies measure the rendering alone: an ideal device with the same force limit takes "
                  "the place of the scene's",
                  loaded.scenario.name));
}

int precision(const PrecisionCommandOptions& options) {
  const std::vector<const PrecisionStudy*> studies = chosen_studies(options.studies);
  std::vector<LoadedScenario> scenarios;
  for (const PrecisionStudy* study : studies) {
    const std::string& given = options.scenario;
    scenarios.push_back(load_scenario(find_scenario(given.empty() ? study->scenario : given), options.overrides));
    print_warnings(check_named_files(scenarios.back()));
    if (!given.empty() || overrides_device(options.overrides))
      check_device(scenarios.back(), overrides_device(options.overrides));
  }
  const fs::path out = results_directory(
      options.out, options.scenario.empty() ? "precision" : "precision_" + scenarios.front().file.stem().string());
  require_writable_directory(out);

  std::string text;
  Json json = Json::array();
  for (std::size_t i = 0; i < studies.size(); ++i) {
    PrecisionOptions settings;
    settings.repetitions = options.repetitions;
    // Most of a study's time may pass before its first row, in computing the reference of all rows.
    std::optional<WaitNotice> notice(std::in_place, studies[i]->name, !options.output.quiet);
    std::optional<ProgressBar> bar;
    settings.progress = [&](std::size_t done, std::size_t all) {
      notice.reset();
      if (!bar) bar.emplace(studies[i]->name, all, !options.output.quiet);
      bar->show(done, true);
    };
    const PrecisionResult result =
        with_file(scenarios[i], [&] { return studies[i]->run(scenarios[i].scenario, settings); });
    write_study(out, *studies[i], result);
    text += study_text(*studies[i], result);
    json.push_back(study_json(*studies[i], result));
  }
  print(options.output, text + fmt::format("results in {}\n", out.string()), json);
  return kSuccess;
}

}  // namespace

std::vector<Table::Column> precision_headings(const std::string& timed) {
  return {{"setting", false}, {"outcome", false}, {"us/" + timed, true, "seconds_per_" + timed}};
}

void add_precision(CommandLine& line) {
  auto [command, options] = line.command("precision", "Measure run time against error, one row per setting", precision,
                                         "complete studies are kept");
  std::string studies = "The studies:";
  for (const PrecisionStudy* study : kPrecisionStudies)
    studies += fmt::format("\n  {}: {}", study->name, study->summary);
  command.add("studies", options.studies, "names of studies (below), or all").required();
  command.footer(studies);
  command.add("--scenario", options.scenario,
              "scenario to start from instead of the study's own: any scenario for time_step");
  command.add("--out", options.out,
              "directory of the results (default: results/out/precision, with --scenario results/out/precision_NAME)");
  add_overrides(command, options.overrides);
  command.add("--repetitions", options.repetitions, "repetitions of every timing; the least counts (default: 5)")
      .range(1, 1000);
  add_output_options(command, options.output);
}

}  // namespace hapbench
