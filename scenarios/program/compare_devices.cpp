#include "scenarios/program/compare_devices.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "device_model/device_presets.hpp"
#include "results/io/table_writer.hpp"
#include "results/observe/contact_forces.hpp"
#include "scenarios/description/bundled_scenarios.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/program/limit.hpp"
#include "scenarios/program/result_tables.hpp"
#include "scenarios/program/table.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/studies/stability/device_limits.hpp"
#include "scenarios/studies/stability/judged_run.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

bool is_file(const std::string& name) {
  return name.ends_with(".json");
}

constexpr const char* kNoInterval = "none";    ///< for --friction
constexpr const char* kPresets = "impedance";  ///< stands for all presets, which have that type

/// Finds devices by name or type, or reads their files. Each name may appear once: it alone tells rows apart.
std::vector<ComparedDevice> chosen_devices(const std::vector<std::string>& given) {
  const std::vector<ComparedDevice> all = compared_devices();
  std::vector<std::string> named;
  std::remove_copy_if(given.begin(), given.end(), std::back_inserter(named), is_file);
  if (!named.empty()) {
    const std::vector<std::string> names = device_names();
    chosen_names("--devices: got", named, {names.begin() + 1, names.end()});
  }

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

/// Refuses overrides that replace the device, after which the names of the rows would be wrong.
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

bool asks_for_one_number(const CompareDevicesOptions& options) {
  return options.friction == std::vector<std::string>{kNoInterval};
}

bool asks_over_friction(const CompareDevicesOptions& options) {
  return !options.friction.empty() && !asks_for_one_number(options);
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
  for (const std::string& override : options.overrides) {
    if (asks_over_friction(options) && overridden_path(override) == "device.coulomb_N")
      throw InputError("--friction: got it beside --set device.coulomb_N; allowed: either");
  }
  question.most_vibration = options.vibration.empty() ? kMostVibration : vibration_of(options.vibration);
  if (!options.resolution.empty()) question.resolution = resolution_of(options.resolution);
  return question;
}

/// Loads the scene on the device. Errors name the device, since the overrides hold for all devices.
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

/// Appends a text unless it is there already.
void add_once(std::vector<std::string>& texts, const std::string& text) {
  if (std::find(texts.begin(), texts.end(), text) == texts.end()) texts.push_back(text);
}

/// Prints the warnings of all runs, each once.
void print_all_warnings(const DeviceQuestion& question) {
  std::vector<std::string> warnings;
  for (const ComparedDevice& device : question.devices) {
    for (const ScenarioText& scene : question.scenes) {
      const LoadedScenario loaded = load_on(device, scene, question.overrides);
      for (const std::string& warning : loaded.warnings) add_once(warnings, warning);
      for (const std::string& warning : check_named_files(loaded)) add_once(warnings, warning);
    }
  }
  print_warnings(warnings);
}

constexpr std::size_t kDeviceGap = 1;  // three scenes and two algorithms then fit into kTableWidth

/// As the width of the search allows, or with three digits.
std::string stiffness_text(double K, const std::optional<double>& tolerance = {}) {
  return deserved(K, tolerance ? tolerance : K * 5e-3);
}

std::string limit_text(const FieldLimit& limit, double resolution) {
  if (!limit.value) return "none";
  return fmt::format("{}{}{}{}{}",
                     limit.other_beyond ? stiffness_text(*limit.other_value, limit.other_tolerance()) + "-" : "",
                     limit.beyond ? "" : "> ", stiffness_text(*limit.value, limit.tolerance()),
                     limit.is_beyond_linear(resolution) ? "!" : "", limit.inconsistent.empty() ? "" : " ~");
}

std::string damping_text(const RenderingConfig& rendering) {
  if (rendering.damping) return fmt::format("B = {} N s/m", significant(*rendering.damping));
  if (rendering.damping_ratio == 0.0) return "no damping is rendered (damping_ratio 0): B = 0 at every K";
  return fmt::format("B = 2 zeta sqrt(K m) with damping_ratio zeta = {} and rendering.mass_kg m = {}",
                     significant(rendering.damping_ratio), significant(rendering.mass));
}

/// States the question and how B follows K.
std::string question_text(const DeviceQuestion& question) {
  std::string text =
      fmt::format("largest stable rendering.stiffness_N_per_m, to {:.3g} %\n", 100.0 * question.resolution);
  std::vector<std::string> rules;
  for (const ScenarioText& scene : question.scenes) {
    const Scenario scenario =
        load_scenario(scene, overrides_on(question.devices.front(), scene, question.overrides)).scenario;
    add_once(rules, fmt::format("{} steps of {} s; {}\n", scenario.time.steps, significant(scenario.time.step),
                                damping_text(scenario.rendering)));
  }
  return text + fmt::format("{}", fmt::join(rules, ""));
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

bool has_dry_friction(const DeviceQuestion& question, const ComparedDevice& device) {
  const ScenarioText& scene = question.scenes.front();
  const Scenario scenario = load_scenario(scene, overrides_on(device, scene, question.overrides)).scenario;
  const auto* impedance = std::get_if<ImpedanceDeviceConfig>(&scenario.device);
  return impedance != nullptr && impedance->coulomb > 0.0;
}

/// The delay of each impedance device in the first scene, as "0 of touch; 1 (0.5 ms in steps of 0.5 ms) of mine"; empty
/// when none has one.
std::string delays_text(const DeviceQuestion& question) {
  std::map<std::string, std::vector<std::string>> names;
  for (const ComparedDevice& device : question.devices) {
    const LoadedScenario loaded =
        load_scenario(question.scenes.front(), overrides_on(device, question.scenes.front(), question.overrides));
    if (handle_moves_tool(loaded.scenario.device)) names[delay_text(loaded.scenario)].push_back(device.name);
  }
  std::vector<std::string> parts;
  for (const auto& [delay, having] : names) parts.push_back(fmt::format("{} of {}", delay, fmt::join(having, ", ")));
  if (names.empty() || names.rbegin()->first == "0") return "";
  return wrapped(
      fmt::format("delay_samples: {}; {}; none of a preset is published", fmt::join(parts, "; "), kWhoseSamples), 0);
}

/// A limit over its device's reference; none where either has no value.
struct DeviceRatio {
  std::optional<double> stiffness;  ///< K over that of the reference
  std::optional<double> rendered;   ///< K lambda_max(S), the stiffness that the hand meets, over that of the reference
};

/// The limits of all devices, a row for each, by columns: each scene with each algorithm. The first column is a
/// device's reference.
class Answers {
 public:
  Answers(const DeviceQuestion& question, const std::vector<DeviceLimit>& limits)
      : question_(question), limits_(limits) {}

  const DeviceQuestion& question() const { return question_; }
  std::size_t columns() const { return question_.scenes.size() * question_.algorithms.size(); }
  std::string scene(std::size_t column) const { return scene_name(column / question_.algorithms.size()); }
  const std::string& algorithm(std::size_t column) const {
    return question_.algorithms[column % question_.algorithms.size()];
  }
  std::string title(std::size_t column) const { return scene(column) + "\n" + algorithm(column); }
  /// The name of a scene is that of its file.
  std::string scene_name(std::size_t scene) const { return question_.scenes[scene].file.stem().string(); }
  const FieldLimit& at(std::size_t device, std::size_t column) const {
    return limits_[device * columns() + column].limit;
  }
  DeviceRatio ratio(std::size_t device, const FieldLimit& limit) const {
    const FieldLimit& reference = at(device, 0);
    if (!limit.value || !reference.value) return {};
    const double stiffness = *limit.value / *reference.value, lambda = reference.settled.lambda_max;
    return {stiffness, lambda > 0.0 ? std::optional(stiffness * limit.settled.lambda_max / lambda) : std::nullopt};
  }

  /// `intervals`: text before the table of the devices' own numbers, or empty.
  std::string text(const std::string& intervals) const {
    std::string text = question_text(question_) + "\n" + intervals + stiffness_table().text();
    text += wrapped(rule_text(StabilityRule{.most_vibration = question_.most_vibration}, false), 0);
    text += ends_text();
    text += "published: largest stable stiffness of a wall; \"hapbench describe DEVICE\" names its source\n";
    text += kWhichStiffness;
    if (std::ranges::any_of(question_.devices, [](const auto& device) { return device.name.ends_with('*'); }))
      text += "*: a preset with numbers of --set, of which nothing is published\n";
    text += delays_text(question_);
    if (std::ranges::any_of(question_.devices, [&](const auto& device) { return has_dry_friction(question_, device); }))
      text += approach_text(intervals.empty());
    if (std::ranges::any_of(
            limits_, [&](const DeviceLimit& limit) { return limit.limit.is_beyond_linear(question_.resolution); })) {
      text += wrapped(
          "!: beyond the edge of the loop of device, hand and surface, linear and in contact (linear_N_per_m in "
          "device_limits.csv): bounces below 30 Hz, dry friction or the end of the run hold the tool, and one that rests on "
          "the surface may not be stable",
          0);
    }
    if (std::ranges::any_of(limits_, [](const DeviceLimit& limit) { return !limit.limit.inconsistent.empty(); }))
      text += "~: some values below it are unstable, or some beyond it are stable: device_runs.csv\n";
    if (columns() == 1) return text;
    const std::string reference = fmt::format("{} in {}", algorithm(0), scene(0));
    text += fmt::format("\nover the device's K of {} (in brackets 1 / lambda_max(S), and contacts, at the limit)\n\n",
                        reference);
    text += ratio_table().text();
    if (question_.devices.size() == 1) return text;
    text += fmt::format("\nleast ... largest of the devices, over {}:\n", reference);
    for (std::size_t c = 1; c < columns(); ++c) text += spreads_text(c);
    return text;
  }

 private:
  /// The approach that a K with dry friction belongs to, over all devices.
  std::string approach_text(bool alone) const {
    std::pair touches(kNone, 0.0), presses(kNone, 0.0);
    for (const DeviceLimit& found : limits_) {
      if (!found.limit.value) continue;
      const auto& [vibration, contacts, lambda_max, touch, press] = found.limit.settled;
      touches = {std::min(touches.first, touch), std::max(touches.second, touch)};
      presses = {std::min(presses.first, press), std::max(presses.second, press)};
    }
    const auto between = [](const std::pair<double, double>& ends) {
      const std::string low = significant(ends.first, 2), high = significant(ends.second, 2);
      return low == high ? low : low + " to " + high;
    };
    return wrapped(
        fmt::format("dry friction, ours in every preset, holds a hand that presses slowly: K is that of this approach "
                    "(first touch at {} m/s, pressed with {} N), not of a device{}",
                    between(touches), between(presses),
                    alone ? "; --friction 0,2 prints K as an interval over friction" : ": quote the interval"),
        0);
  }
  static constexpr double kNone = std::numeric_limits<double>::infinity();

  /// The first three names, and how many more there are.
  static std::string first_of(const std::vector<std::string>& names) {
    constexpr std::size_t kMost = 3;
    const std::size_t shown = std::min(kMost, names.size());
    const std::string more =
        names.size() > kMost ? fmt::format(" and {} more (device_limits.csv)", names.size() - kMost) : "";
    return fmt::format("{}{}", fmt::join(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(shown), ", "),
                       more);
  }

  /// Lines that tell for which devices runs below the low end fail, and how, and where no stiffness at all is stable.
  std::string ends_text() const {
    std::map<std::string, std::vector<std::string>> below, none;
    const auto name = [this](const DeviceLimit& limit) {
      return fmt::format("{} with {} in {}", question_.devices[limit.device].name, limit.limit.algorithm,
                         scene_name(limit.scene));
    };
    for (const DeviceLimit& limit : limits_) {
      if (!limit.limit.value) none[none_text(limit.limit)].push_back(name(limit));
      if (limit.limit.other_beyond)
        below[std::string(run_verdict_name(limit.limit.other_beyond->verdict))].push_back(name(limit));
    }
    std::string text;
    for (const auto& [verdict, names] : below)
      text += wrapped(fmt::format("a-b: stable from a on; below, {}: {}", verdict, first_of(names)), 0);
    for (const auto& [why, names] : none) text += wrapped(fmt::format("{}: {}", first_of(names), why), 0);
    return text;
  }

  Table stiffness_table() const {
    std::vector<Table::Column> columns = device_headings();
    for (std::size_t c = 0; c < this->columns(); ++c) columns.push_back({title(c)});
    Table table(columns, kDeviceGap);
    for (std::size_t d = 0; d < question_.devices.size(); ++d) {
      const auto& [name, json, has_place, published] = question_.devices[d];
      std::vector<std::string> cells = {name, published ? stiffness_text(*published) : "-"};
      for (std::size_t c = 0; c < this->columns(); ++c) cells.push_back(limit_text(at(d, c), question_.resolution));
      table.add(std::move(cells));
    }
    return table;
  }

  /// The ratios of all columns but the reference.
  Table ratio_table() const {
    std::vector<Table::Column> columns = {{"device", false}};
    for (std::size_t c = 1; c < this->columns(); ++c) columns.push_back({title(c)});
    Table table(columns);
    for (std::size_t d = 0; d < question_.devices.size(); ++d) {
      std::vector<std::string> cells = {question_.devices[d].name};
      for (std::size_t c = 1; c < this->columns(); ++c) {
        const auto stiffness = ratio(d, at(d, c)).stiffness;
        const double lambda_max = at(d, c).settled.lambda_max, contacts = at(d, c).settled.contacts;
        cells.push_back(stiffness ? fmt::format("{} ({}, {:.0f})", significant(*stiffness, 2),
                                                lambda_max > 0.0 ? significant(1.0 / lambda_max, 2) : "-", contacts)
                                  : "-");
      }
      table.add(std::move(cells));
    }
    return table;
  }

  /// How the ratios of a column spread over the devices, of K and of the rendered stiffness.
  std::string spreads_text(std::size_t column) const {
    std::vector<double> stiffness, rendered;
    for (std::size_t d = 0; d < question_.devices.size(); ++d) {
      const DeviceRatio ratio = this->ratio(d, at(d, column));
      if (ratio.stiffness) stiffness.push_back(*ratio.stiffness);
      if (ratio.rendered) rendered.push_back(*ratio.rendered);
    }
    const std::size_t none = question_.devices.size() - stiffness.size();
    return fmt::format("{} in {}: {}; K lambda_max: {}{}\n", algorithm(column), scene(column), spread_text(stiffness),
                       spread_text(rendered), none > 0 ? fmt::format("; none on {} devices", none) : "");
  }

  const DeviceQuestion& question_;
  const std::vector<DeviceLimit>& limits_;
};

/// A line of device_limits.csv.
struct DeviceLimitRow {
  const Answers& answers;
  const DeviceLimit& found;

  const FieldLimit& limit() const { return found.limit; }
  const ComparedDevice& device() const { return answers.question().devices[found.device]; }
  DeviceRatio ratio() const { return answers.ratio(found.device, found.limit); }
  /// A number of the run at the limit.
  Cell settled(double value) const { return limit().value ? Cell(value) : Cell(); }
};
using DeviceField = Field<DeviceLimitRow>;

constexpr Column kDeviceColumn = {
    "device", "", "ideal, admittance, the preset of an impedance device (* with numbers of --set), or a file's"};
constexpr Column kSceneColumn = {"scenario", "", "name of the scene's file"};
constexpr Column kAlgorithmColumn = {"algorithm", "", "force algorithm"};

const DeviceField kDeviceLimitFields[] = {
    {kDeviceColumn, [](const DeviceLimitRow& r) -> Cell { return r.device().name; }},
    {kSceneColumn, [](const DeviceLimitRow& r) -> Cell { return r.answers.scene_name(r.found.scene); }},
    {kAlgorithmColumn, [](const DeviceLimitRow& r) -> Cell { return r.limit().algorithm; }},
    {{"limit_N_per_m", "N/m", "largest stable K by bisection on runs; empty when no run is stable"},
     [](const DeviceLimitRow& r) { return cell_if(r.limit().value); }},
    {{"beyond_N_per_m", "N/m", "the first unstable K beyond; empty when the range ends stable"},
     [](const DeviceLimitRow& r) { return r.limit().beyond ? Cell(r.limit().beyond->value) : Cell(); }},
    {{"class_beyond", "", "what became of the run there"},
     [](const DeviceLimitRow& r) -> Cell { return beyond_text(r.limit()); }},
    {{"low_N_per_m", "N/m", "smallest stable K of the interval that the limit ends; empty when no run is stable"},
     [](const DeviceLimitRow& r) { return cell_if(r.limit().other_value); }},
    {{"below_N_per_m", "N/m", "the first K below that is not stable; empty when the range begins stable"},
     [](const DeviceLimitRow& r) { return r.limit().other_beyond ? Cell(r.limit().other_beyond->value) : Cell(); }},
    {{"class_below", "", "what became of the run there"},
     [](const DeviceLimitRow& r) -> Cell { return other_beyond_text(r.limit()); }},
    {{"limit_tolerance_N_per_m", "N/m", "how far beyond the limit the edge may lie"},
     [](const DeviceLimitRow& r) { return cell_if(r.limit().tolerance()); },
     DeviceField::In::json},
    {{"low_tolerance_N_per_m", "N/m", "how far below the low end the edge may lie"},
     [](const DeviceLimitRow& r) { return cell_if(r.limit().other_tolerance()); },
     DeviceField::In::json},
    {{"published_N_per_m", "N/m", "published largest stable stiffness of a wall on the device"},
     [](const DeviceLimitRow& r) { return cell_if(r.device().published_stiffness); }},
    {{"vibration_m_per_s", "m/s", "at the limit: rms of the handle's speed above 30 Hz in the last quarter of the run"},
     [](const DeviceLimitRow& r) { return r.limit().value ? cell_if(r.limit().settled.vibration) : Cell(); }},
    {{"contacts", "1", "at the limit: mean number of rendered contacts there"},
     [](const DeviceLimitRow& r) { return r.settled(r.limit().settled.contacts); }},
    {{"lambda_max", "1", "at the limit: largest eigenvalue of the mean S there"},
     [](const DeviceLimitRow& r) { return r.settled(r.limit().settled.lambda_max); }},
    {{"linear_N_per_m", "N/m",
      "largest K at which the loop of device, hand and surface is stable while they touch, without dry friction and "
      "encoder, by its eigenvalues; a limit beyond it is held up by bounces, dry friction or the end of the run"},
     [](const DeviceLimitRow& r) { return cell_if(r.limit().linear); }},
    {{"stiffness_ratio", "1", "K over that of the device in the first scene with the first algorithm"},
     [](const DeviceLimitRow& r) { return cell_if(r.ratio().stiffness); }},
    {{"rendered_ratio", "1", "the same of K lambda_max"},
     [](const DeviceLimitRow& r) { return cell_if(r.ratio().rendered); }},
    {{"unstable_without_contact", "", "true when hand and device alone are unstable beyond the limit"},
     [](const DeviceLimitRow& r) -> Cell { return r.limit().unstable_alone; },
     DeviceField::In::json},
    {{"runs", "1", "runs of the search"}, [](const DeviceLimitRow& r) -> Cell { return r.limit().runs.size(); }},
    {kInconsistentColumn, [](const DeviceLimitRow& r) -> Cell { return r.limit().inconsistent.size(); }},
    {kAstrayColumn, [](const DeviceLimitRow& r) -> Cell { return r.limit().inconsistent.size(); }}};

/// A line of device_runs.csv.
struct DeviceRunRow {
  const DeviceLimitRow& limit;
  const JudgedValue& run;
};

const Field<DeviceRunRow> kDeviceRunFields[] = {
    {kDeviceColumn, [](const DeviceRunRow& r) -> Cell { return r.limit.device().name; }},
    {kSceneColumn, [](const DeviceRunRow& r) -> Cell { return r.limit.answers.scene_name(r.limit.found.scene); }},
    {kAlgorithmColumn, [](const DeviceRunRow& r) -> Cell { return r.limit.limit().algorithm; }},
    {{"rendering.stiffness_N_per_m", "N/m", "K of the run"}, [](const DeviceRunRow& r) -> Cell { return r.run.value; }},
    {{"class", "", "what became of the run"},
     [](const DeviceRunRow& r) -> Cell { return std::string(run_verdict_name(r.run.verdict)); }}};

/// Writes device_limits.csv and device_runs.csv, and returns the content of the first as JSON.
Json write(const fs::path& directory, const DeviceQuestion& question, const std::vector<DeviceLimit>& limits) {
  const Answers answers(question, limits);
  std::vector<DeviceLimitRow> rows;
  for (const DeviceLimit& found : limits) rows.push_back({answers, found});
  std::vector<DeviceRunRow> runs;
  Json json = Json::array();
  for (const DeviceLimitRow& row : rows) {
    add_row(json.emplace_back(), kDeviceLimitFields, row);
    for (const JudgedValue& run : row.limit().runs) runs.push_back({row, run});
  }
  FileSet files;
  write_csv(directory / "device_limits.csv", kDeviceLimitFields, rows, &files);
  write_csv(directory / "device_runs.csv", kDeviceRunFields, runs, &files);
  files.commit();
  return {{"most_vibration_m_per_s", question.most_vibration},
          {"resolution", question.resolution},
          {"reference", {{"scenario", answers.scene_name(0)}, {"algorithm", question.algorithms.front()}}},
          {"limits", std::move(json)}};
}

/// A device in place of one of the question.
struct OtherNumbers {
  std::size_t device;
  ComparedDevice with;
};

/// The devices with other numbers that nobody published: their dry friction times factors, or a preset's both ends.
std::vector<OtherNumbers> others_of(const DeviceQuestion& question, const std::vector<std::string>& factors) {
  std::vector<OtherNumbers> others;
  for (std::size_t d = 0; d < question.devices.size(); ++d) {
    for (const std::string& factor : factors) {
      const double times = number_between("--friction", factor, 0.0, 1e3);
      if (const auto device = with_friction_times(question.devices[d], times)) others.push_back({d, *device});
    }
    if (!factors.empty()) continue;
    for (const ComparedDevice& device : with_unpublished_numbers(question.devices[d])) others.push_back({d, device});
  }
  return others;
}

/// The least and the largest K over the devices' own and other numbers; the text and the JSON.
std::pair<std::string, Json> intervals_over(const std::vector<OtherNumbers>& others, const Answers& answers,
                                            const JobOptions& jobs) {
  const DeviceQuestion& question = answers.question();
  DeviceQuestion asked = question;
  asked.devices.clear();
  for (const OtherNumbers& other : others) asked.devices.push_back(other.with);
  std::map<std::size_t, std::vector<std::pair<double, double>>> ends;  // of each column, by device
  for (const auto& [d, with] : others) {
    if (ends.contains(d)) continue;
    for (std::size_t c = 0; c < answers.columns(); ++c) {
      const double K = answers.at(d, c).value.value_or(0.0);
      ends[d].emplace_back(K, K);
    }
  }
  const std::vector<DeviceLimit> limits = device_limits(asked, jobs);
  for (std::size_t i = 0; i < limits.size(); ++i) {
    auto& [least, largest] = ends[others[i / answers.columns()].device][i % answers.columns()];
    const double K = limits[i].limit.value.value_or(0.0);
    least = std::min(least, K);
    largest = std::max(largest, K);
  }
  std::vector<Table::Column> columns = {{"device", false}};
  for (std::size_t c = 0; c < answers.columns(); ++c) columns.push_back({answers.title(c)});
  Table table(columns, kDeviceGap);
  Json json = Json::array();
  for (const auto& [d, of] : ends) {
    std::vector<std::string> cells = {question.devices[d].name};
    for (std::size_t c = 0; c < of.size(); ++c) {
      const auto& [least, largest] = of[c];
      const auto shown = [](double K) { return K > 0.0 ? stiffness_text(K) : std::string("none"); };
      cells.push_back(shown(least) + "..." + shown(largest));
      json.push_back({{"device", question.devices[d].name},
                      {"scenario", answers.scene(c)},
                      {"algorithm", answers.algorithm(c)},
                      {"least_N_per_m", least},
                      {"largest_N_per_m", largest}});
    }
    table.add(std::move(cells));
  }
  return {table.text(), std::move(json)};
}

}  // namespace

std::vector<std::string> device_names() {
  std::vector<std::string> names = {"all", kPresets};
  for (const ComparedDevice& device : compared_devices()) names.push_back(device.name);
  return names;
}

std::vector<std::string> default_device_scenes() {
  return {"tap_wall", "tap_corner", "tap_hole"};
}

std::vector<Column> device_limit_columns() {
  return columns_of(kDeviceLimitFields);
}

std::vector<Column> device_run_columns() {
  return columns_of(kDeviceRunFields);
}

std::vector<Table::Column> device_headings() {
  return {{"device", false}, {"pub-\nlished", true, "published_N_per_m"}};
}

int compare_devices(const CompareDevicesOptions& options) {
  const DeviceQuestion question = question_of(options);
  print_all_warnings(question);
  const fs::path out = results_directory(options.out, "compare_devices");
  require_writable_directory(out);
  const std::vector<DeviceLimit> limits = device_limits(question, job_options(options.jobs, options.output, "compare"));
  Json json = write(out, question, limits);
  const Answers answers(question, limits);
  const std::string over = options.friction.empty() ? std::string(kPresetRanges)
                                                    : fmt::format("dry friction of 1, {} times the device's",
                                                                  fmt::join(options.friction, ", "));
  std::string intervals;
  if (const auto others =
          asks_for_one_number(options) ? std::vector<OtherNumbers>{} : others_of(question, options.friction);
      !others.empty()) {
    auto [table, rows] = intervals_over(others, answers, job_options(options.jobs, options.output, "interval"));
    intervals =
        wrapped("K over what is not published: " + over, 0) + "\n" + table + "\nK with the numbers of each device\n\n";
    if (options.friction.empty()) {
      json["interval"] = {{"over", over}, {"limits", std::move(rows)}};
    } else {
      json["friction"] = {{"factors", options.friction}, {"limits", std::move(rows)}};
    }
  }
  print(options.output, answers.text(intervals) + fmt::format("\nresults in {}\n", out.string()), json);
  return kSuccess;
}

}  // namespace hapbench
