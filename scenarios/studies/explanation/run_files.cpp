#include "scenarios/studies/explanation/run_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "scenarios/input/json_file.hpp"
#include "scenarios/input/text_lines.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

Json read_json(const fs::path& file) {
  try {
    return parse_json(read_text_file(file, kLargestJsonFile));
  } catch (const InputError& error) {
    rethrow_with_file(error, file);
  }
}

void collect(const Json& json, const std::string& name, RunFiles& run) {
  if (json.is_number()) run.metrics[name] = json.get<double>();
  if (!json.is_object()) return;
  for (const auto& [key, value] : json.items()) collect(value, name.empty() ? key : name + "." + key, run);
}

std::vector<ReadRow> read_rows(const fs::path& file) {
  const std::string text = read_text_file(file, kLargestTable);
  CsvReader csv(LineReader(text), file);
  constexpr std::array kNames = {"time_s",  "px_m",      "py_m",      "pz_m",      "fx_N",     "fy_N",
                                 "fz_N",    "fmeas_x_N", "fmeas_y_N", "fmeas_z_N", "fin_x_N",  "fin_y_N",
                                 "fin_z_N", "hx_m",      "hy_m",      "hz_m",      "colliding"};
  std::array<std::size_t, kNames.size()> places{};
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    const auto found = std::ranges::find(csv.columns(), std::string_view(kNames[i]));
    if (found == csv.columns().end()) throw InputError(fmt::format("{}: has no column {}", file.string(), kNames[i]));
    places[i] = static_cast<std::size_t>(found - csv.columns().begin());
  }
  std::vector<ReadRow> rows;
  while (csv.next_not_blank()) {
    std::array<double, kNames.size()> n{};
    for (std::size_t i = 0; i < n.size(); ++i) n[i] = finite_number(csv.cells()[places[i]]).value_or(0.0);
    rows.push_back({n[0],
                    {n[1], n[2], n[3]},
                    {n[4], n[5], n[6]},
                    {n[7], n[8], n[9]},
                    {n[10], n[11], n[12]},
                    {n[13], n[14], n[15]},
                    n[16] > 0.0});
  }
  return rows;
}

}  // namespace

std::optional<double> RunFiles::metric(std::string_view name) const {
  const auto found = metrics.find(name);
  return found == metrics.end() ? std::nullopt : std::optional(found->second);
}

RunFiles read_run(const fs::path& folder) {
  RunFiles run;
  run.loaded = load_scenario(folder / "scenario.effective.json");
  const fs::path file = folder / "summary.json";
  const Json summary = read_json(file);
  if (!summary.is_object() || !summary.contains("outcome") || !summary.contains("metrics"))
    throw InputError(file.string() + ": is not what a run writes");
  run.outcome = summary["outcome"].get<std::string>();
  collect(summary["metrics"], "", run);
  for (const char* section : {"passivity", "steps", "duration_s"})
    if (summary.contains(section)) collect(summary[section], section, run);
  if (const Json left = summary.value("divergence", Json()); left.is_object())
    run.ending = fmt::format("{} in step {}", left.value("quantity", ""), left.value("step", 0));
  else if (const Json warnings = summary.value("warnings", Json()); run.outcome != "completes" && !warnings.empty())
    run.ending = warnings[0].is_string() ? warnings[0].get<std::string>() : "";
  if (fs::exists(folder / "trajectory.csv")) run.rows = read_rows(folder / "trajectory.csv");
  if (fs::exists(folder / "timing.json")) {
    const Json timing = read_json(folder / "timing.json");
    for (const char* name : {"/step_latency/p99_s", "/step_p99_s"}) {
      const Json::json_pointer at(name);
      if (!run.step_time && timing.contains(at) && timing[at].is_number()) run.step_time = timing[at].get<double>();
    }
  }
  return run;
}

}  // namespace hapbench
