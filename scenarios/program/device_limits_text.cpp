#include "scenarios/program/device_limits_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "results/io/csv_writer.hpp"
#include "results/observe/contact_forces.hpp"
#include "scenarios/program/result_tables.hpp"
#include "scenarios/program/table.hpp"

namespace hapbench {
namespace {

constexpr std::size_t kNarrowGap = 1;  // with it three scenes and two algorithms fit into kTableWidth

/// Three digits, without an exponent.
std::string stiffness_text(double K) {
  const double unit = std::pow(10.0, std::floor(std::log10(K)) - 2.0);
  return unit < 1.0 ? significant(K, 3) : fmt::format("{:.0f}", std::round(K / unit) * unit);
}

std::string limit_text(const FieldLimit& limit) {
  if (!limit.value) return "none";
  return fmt::format("{}{}{}", limit.beyond ? "" : "> ", stiffness_text(*limit.value),
                     limit.inconsistent.empty() ? "" : " ~");
}

std::string damping_text(const RenderingConfig& rendering) {
  if (rendering.damping) return fmt::format("B = {} N s/m", significant(*rendering.damping));
  if (rendering.damping_ratio == 0.0) return "no damping is rendered (damping_ratio 0): B = 0 at every K";
  return fmt::format("B = 2 zeta sqrt(K m) with damping_ratio zeta = {} and rendering.mass_kg m = {}",
                     significant(rendering.damping_ratio), significant(rendering.mass));
}

/// What is asked, what "stable" means here, and how B follows K.
std::string question_text(const DeviceQuestion& question) {
  std::string text = fmt::format(
      "largest stable rendering.stiffness_N_per_m, to {:.3g} %\n"
      "stable: at most {} m/s rms above {:.0f} Hz at the handle in the last quarter of a run, and not diverged, "
      "thrown_out or no_contact\n",
      100.0 * question.resolution, significant(question.most_vibration), kVibrationCutoff);
  std::vector<std::string> rules;
  for (const ScenarioText& scene : question.scenes) {
    const LoadedScenario loaded =
        load_scenario(scene, overrides_on(question.devices.front(), scene, question.overrides));
    std::string rule = fmt::format("{} steps of {} s; {}\n", loaded.scenario.time.steps,
                                   significant(loaded.scenario.time.step), damping_text(loaded.scenario.rendering));
    if (std::find(rules.begin(), rules.end(), rule) == rules.end()) rules.push_back(std::move(rule));
  }
  for (const std::string& rule : rules) text += rule;
  return text;
}

std::size_t columns_of(const DeviceQuestion& question) {
  return question.scenes.size() * question.algorithms.size();
}

std::string title(const DeviceQuestion& question, std::size_t column) {
  return scene_name(question, column / question.algorithms.size()) + "\n" +
         question.algorithms[column % question.algorithms.size()];
}

Table stiffness_table(const DeviceQuestion& question, const std::vector<DeviceLimit>& limits) {
  std::vector<Table::Column> columns = {{"device", false}, {"pub-\nlished"}};
  for (std::size_t c = 0; c < columns_of(question); ++c) columns.push_back({title(question, c)});
  Table table(columns, kNarrowGap);
  for (std::size_t d = 0; d < question.devices.size(); ++d) {
    const ComparedDevice& device = question.devices[d];
    std::vector<std::string> cells = {device.name,
                                      device.published_stiffness ? stiffness_text(*device.published_stiffness) : "-"};
    for (std::size_t c = 0; c < columns_of(question); ++c)
      cells.push_back(limit_text(limits[d * columns_of(question) + c].limit));
    table.add(std::move(cells));
  }
  return table;
}

std::string ratio_text(const DeviceLimit& limit, const DeviceLimit& reference) {
  const auto ratio = ratio_of(limit, reference).stiffness;
  if (!ratio) return "-";
  const SettledState& settled = limit.limit.settled;
  return fmt::format("{} ({}, {:.0f})", significant(*ratio, 2),
                     settled.lambda_max > 0.0 ? significant(1.0 / settled.lambda_max, 2) : "-", settled.contacts);
}

/// Without the column of the reference.
Table ratio_table(const DeviceQuestion& question, const std::vector<DeviceLimit>& limits) {
  std::vector<Table::Column> columns = {{"device", false}};
  for (std::size_t c = 1; c < columns_of(question); ++c) columns.push_back({title(question, c)});
  Table table(columns);
  for (std::size_t d = 0; d < question.devices.size(); ++d) {
    std::vector<std::string> cells = {question.devices[d].name};
    for (std::size_t c = 1; c < columns_of(question); ++c) {
      cells.push_back(ratio_text(limits[d * columns_of(question) + c], limits[reference_of(question, d)]));
    }
    table.add(std::move(cells));
  }
  return table;
}

/// "0.8 ... 1.2, median 1"
std::string spread_text(std::vector<double> values) {
  if (values.empty()) return "none";
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  const double median = values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
  return fmt::format("{} ... {}, median {}", significant(values.front(), 2), significant(values.back(), 2),
                     significant(median, 2));
}

/// A line for each column: how the ratios spread over the devices, of K and of what is rendered with it.
std::string spreads_text(const DeviceQuestion& question, const std::vector<DeviceLimit>& limits) {
  std::string text;
  for (std::size_t c = 1; c < columns_of(question); ++c) {
    std::vector<double> stiffness, rendered;
    for (std::size_t d = 0; d < question.devices.size(); ++d) {
      const DeviceRatio ratio = ratio_of(limits[d * columns_of(question) + c], limits[reference_of(question, d)]);
      if (ratio.stiffness) stiffness.push_back(*ratio.stiffness);
      if (ratio.rendered) rendered.push_back(*ratio.rendered);
    }
    const std::size_t none = question.devices.size() - stiffness.size();
    text += fmt::format("{} in {}: {}; K lambda_max: {}{}\n", question.algorithms[c % question.algorithms.size()],
                        scene_name(question, c / question.algorithms.size()), spread_text(stiffness),
                        spread_text(rendered), none > 0 ? fmt::format("; none on {} devices", none) : "");
  }
  return text;
}

/// Which delay the force of each impedance device has, if they differ: "0 of touch, omega.3; 1 of mine". Empty
/// otherwise.
std::string delays_text(const DeviceQuestion& question) {
  std::map<double, std::vector<std::string>> names;
  for (const ComparedDevice& device : question.devices) {
    const LoadedScenario loaded =
        load_scenario(question.scenes.front(), overrides_on(device, question.scenes.front(), question.overrides));
    if (const auto* impedance = std::get_if<ImpedanceDeviceConfig>(&loaded.scenario.device))
      names[impedance->delay_samples].push_back(device.name);
  }
  if (names.size() < 2) return "";
  std::vector<std::string> parts;
  for (const auto& [delay, having] : names)
    parts.push_back(fmt::format("{} of {}", significant(delay), fmt::join(having, ", ")));
  return wrapped(fmt::format("delay_samples: {}; none of a preset is published", fmt::join(parts, "; ")), 0);
}

/// A line of device_limits.csv.
struct DeviceLimitRow {
  const DeviceQuestion& question;
  const DeviceLimit& found;
  DeviceRatio ratio;

  const FieldLimit& limit() const { return found.limit; }
  /// A number of the run at the limit.
  Cell settled(double value) const { return limit().value ? Cell(value) : Cell(); }
};
using DeviceField = Field<DeviceLimitRow>;

constexpr Column kDeviceColumn = {
    "device", "", "ideal, admittance, the preset of an impedance device (* with numbers of --set), or a file's"};
constexpr Column kSceneColumn = {"scenario", "", "name of the scene's file"};
constexpr Column kAlgorithmColumn = {"algorithm", "", "force algorithm"};

const DeviceField kDeviceLimitFields[] = {
    {kDeviceColumn, [](const DeviceLimitRow& r) -> Cell { return r.question.devices[r.found.device].name; }},
    {kSceneColumn, [](const DeviceLimitRow& r) -> Cell { return scene_name(r.question, r.found.scene); }},
    {kAlgorithmColumn, [](const DeviceLimitRow& r) -> Cell { return r.limit().algorithm; }},
    {{"limit_N_per_m", "N/m", "largest stable K by bisection on runs; empty when no run is stable"},
     [](const DeviceLimitRow& r) { return cell_if(r.limit().value); }},
    {{"beyond_N_per_m", "N/m", "the first unstable K beyond; empty when the range ends stable"},
     [](const DeviceLimitRow& r) { return r.limit().beyond ? Cell(r.limit().beyond->value) : Cell(); }},
    {{"class_beyond", "", "what became of the run there"},
     [](const DeviceLimitRow& r) -> Cell { return beyond_text(r.limit()); }},
    {{"published_N_per_m", "N/m", "published largest stable stiffness of a wall on the device"},
     [](const DeviceLimitRow& r) { return cell_if(r.question.devices[r.found.device].published_stiffness); }},
    {{"vibration_m_per_s", "m/s", "at the limit: rms of the handle's speed above 30 Hz in the last quarter of the run"},
     [](const DeviceLimitRow& r) { return r.limit().value ? cell_if(r.limit().settled.vibration) : Cell(); }},
    {{"contacts", "1", "at the limit: mean number of rendered contacts there"},
     [](const DeviceLimitRow& r) { return r.settled(r.limit().settled.contacts); }},
    {{"lambda_max", "1", "at the limit: largest eigenvalue of the mean S there"},
     [](const DeviceLimitRow& r) { return r.settled(r.limit().settled.lambda_max); }},
    {{"stiffness_ratio", "1", "K over that of the device in the first scene with the first algorithm"},
     [](const DeviceLimitRow& r) { return cell_if(r.ratio.stiffness); }},
    {{"rendered_ratio", "1", "the same of K lambda_max"},
     [](const DeviceLimitRow& r) { return cell_if(r.ratio.rendered); }},
    {{"unstable_without_contact", "", "true when hand and device alone are unstable beyond the limit"},
     [](const DeviceLimitRow& r) -> Cell { return r.limit().unstable_alone; },
     DeviceField::In::json},
    {{"runs", "1", "runs of the search"}, [](const DeviceLimitRow& r) -> Cell { return r.limit().runs.size(); }},
    {kInconsistentColumn, [](const DeviceLimitRow& r) -> Cell { return r.limit().inconsistent.size(); }}};

/// A line of device_runs.csv.
struct DeviceRunRow {
  const DeviceQuestion& question;
  const DeviceLimit& found;
  const JudgedValue& run;
};

const Field<DeviceRunRow> kDeviceRunFields[] = {
    {kDeviceColumn, [](const DeviceRunRow& r) -> Cell { return r.question.devices[r.found.device].name; }},
    {kSceneColumn, [](const DeviceRunRow& r) -> Cell { return scene_name(r.question, r.found.scene); }},
    {kAlgorithmColumn, [](const DeviceRunRow& r) -> Cell { return r.found.limit.algorithm; }},
    {{"rendering.stiffness_N_per_m", "N/m", "K of the run"}, [](const DeviceRunRow& r) -> Cell { return r.run.value; }},
    {{"class", "", "what became of the run"},
     [](const DeviceRunRow& r) -> Cell { return std::string(run_verdict_name(r.run.verdict)); }}};

std::vector<DeviceLimitRow> limit_rows(const DeviceQuestion& question, const std::vector<DeviceLimit>& limits) {
  std::vector<DeviceLimitRow> rows;
  for (const DeviceLimit& found : limits)
    rows.push_back({question, found, ratio_of(found, limits.at(reference_of(question, found.device)))});
  return rows;
}

}  // namespace

std::vector<std::string> default_device_scenes() {
  return {"tap_wall", "tap_corner", "tap_hole"};
}

std::string scene_name(const DeviceQuestion& question, std::size_t scene) {
  return question.scenes[scene].file.stem().string();
}

std::size_t reference_of(const DeviceQuestion& question, std::size_t device) {
  return device * columns_of(question);
}

DeviceRatio ratio_of(const DeviceLimit& limit, const DeviceLimit& reference) {
  if (!limit.limit.value || !reference.limit.value) return {};
  const double stiffness = *limit.limit.value / *reference.limit.value;
  const double lambda = reference.limit.settled.lambda_max;
  return {stiffness, lambda > 0.0 ? std::optional(stiffness * limit.limit.settled.lambda_max / lambda) : std::nullopt};
}

std::string beyond_text(const FieldLimit& limit) {
  if (limit.beyond) return std::string(run_verdict_name(limit.beyond->verdict));
  return limit.value ? "end of the range" : std::string(run_verdict_name(limit.runs.front().verdict));
}

std::string device_limits_text(const DeviceQuestion& question, const std::vector<DeviceLimit>& limits) {
  std::string text = question_text(question) + "\n" + stiffness_table(question, limits).text();
  text += "published: largest stable stiffness of a wall; \"hapbench describe DEVICE\" names its source\n";
  if (std::any_of(question.devices.begin(), question.devices.end(),
                  [](const ComparedDevice& device) { return device.name.ends_with('*'); }))
    text += "*: a preset with numbers of --set, of which nothing is published\n";
  text += delays_text(question);
  if (std::any_of(limits.begin(), limits.end(),
                  [](const DeviceLimit& limit) { return !limit.limit.inconsistent.empty(); }))
    text += "~: some values below it are unstable, or some beyond it are stable: device_runs.csv\n";
  if (columns_of(question) == 1) return text;
  const std::string reference = fmt::format("{} in {}", question.algorithms.front(), scene_name(question, 0));
  text += fmt::format("\nover the device's K of {} (in brackets 1 / lambda_max(S), and contacts, at the limit)\n\n",
                      reference);
  text += ratio_table(question, limits).text();
  text += fmt::format("\nleast ... largest of the devices, over {}:\n", reference);
  return text + spreads_text(question, limits);
}

std::vector<Column> device_limit_columns() {
  return columns_of(kDeviceLimitFields);
}

std::vector<Column> device_run_columns() {
  return columns_of(kDeviceRunFields);
}

void write_device_limits(const std::filesystem::path& directory, const DeviceQuestion& question,
                         const std::vector<DeviceLimit>& limits) {
  std::vector<DeviceRunRow> runs;
  for (const DeviceLimit& found : limits) {
    for (const JudgedValue& run : found.limit.runs) runs.push_back({question, found, run});
  }
  write_csv(directory / "device_limits.csv", kDeviceLimitFields, limit_rows(question, limits));
  write_csv(directory / "device_runs.csv", kDeviceRunFields, runs);
}

Json device_limits_json(const DeviceQuestion& question, const std::vector<DeviceLimit>& limits) {
  Json rows = Json::array();
  for (const DeviceLimitRow& row : limit_rows(question, limits)) add_row(rows.emplace_back(), kDeviceLimitFields, row);
  return {{"most_vibration_m_per_s", question.most_vibration},
          {"resolution", question.resolution},
          {"reference", {{"scenario", scene_name(question, 0)}, {"algorithm", question.algorithms.front()}}},
          {"limits", std::move(rows)}};
}

}  // namespace hapbench
