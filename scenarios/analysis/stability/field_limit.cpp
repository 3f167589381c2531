#include "scenarios/analysis/stability/field_limit.hpp"

#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <utility>

#include "device_model/impedance_device.hpp"
#include "device_model/theory/linear_loops.hpp"
#include "scenarios/batch/jobs.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/input/writer.hpp"
#include "scenarios/run/scene_loop.hpp"
#include "scenarios/scene/parts.hpp"

namespace hapbench {

TriedParts scanned(int intervals, const IsStable& stable) {
  TriedParts tried;
  for (int i = 0; i <= intervals; ++i) {
    const double part = static_cast<double>(i) / intervals;
    tried[part] = stable(part);
  }
  return tried;
}

FoundEdge find_edge(const SearchWay& way, TriedParts& tried, const IsStable& stable, bool beside) {
  constexpr int kBeside = 3;  // values tried on either side of the edge, up to an interval away
  constexpr int kRounds = 6;  // of bisection, each towards an edge that values beside the last one showed
  const auto holds = [&](double part) { return tried[part] = stable(part); };
  const std::optional<double> own = way.own_part();
  const double start = own && holds(*own) ? *own : 0.0;
  const auto narrow = [&](double& good, double& bad) {
    while (way.apart(good, bad)) {
      const double middle = 0.5 * (good + bad);
      (holds(middle) ? good : bad) = middle;
    }
  };
  const auto with_other_end = [&](FoundEdge edge) {
    if (!beside) return edge;
    auto first = tried.find(*edge.stable);
    while (first != tried.begin() && std::prev(first)->second) --first;
    edge.first = first->first;
    if (first == tried.begin()) return edge;
    edge.before = std::prev(first)->first;
    narrow(*edge.first, *edge.before);
    return edge;
  };
  FoundEdge edge;
  for (int round = 0; round < kRounds; ++round) {
    const auto is = [](bool wanted) { return [wanted](const auto& value) { return value.second == wanted; }; };
    const auto first = std::find_if(tried.lower_bound(start), tried.end(), is(true));
    if (first == tried.end()) return {};
    const auto end = std::find_if(first, tried.end(), is(false));
    if (end == tried.end()) return with_other_end({.stable = tried.rbegin()->first});
    double low = std::prev(end)->first, high = end->first;
    if (edge.stable == low) return with_other_end(edge);
    narrow(low, high);
    edge = {.stable = low, .beyond = high};
    if (!beside) return edge;
    const double before = std::max(first->first, low - 1.0 / kEdgeIntervals),
                 behind = std::min(1.0, high + 1.0 / kEdgeIntervals);
    for (int i = 1; i <= kBeside; ++i) {
      const double share = static_cast<double>(i) / (kBeside + 1);
      holds(before + share * (low - before));
      holds(high + share * (behind - high));
    }
  }
  return with_other_end(edge);
}

std::vector<double> parts_between(double from, double to, std::size_t count) {
  constexpr double kGolden = std::numbers::phi - 1.0;
  std::vector<double> parts;
  double share = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    share += kGolden;
    share -= std::floor(share);
    parts.push_back(from + share * (to - from));
  }
  return parts;
}

std::vector<double> parts_below(const SearchWay& way, double part) {
  const auto [from, to, logarithmic] = way.range;
  const double near = logarithmic ? math::log(1.0 + kNear) / math::log(to / from)
                                  : kNear * std::max(std::abs(way.value_at(part)) / (to - from), way.resolution);
  return parts_between(part, std::max(0.0, part - near), kTriedNear);
}

FoundEdge find_tried_edge(const SearchWay& way, TriedParts& tried, const IsStable& stable, bool near,
                          const std::function<void(std::span<const double>)>& ahead) {
  bool scattered = false;
  double begin = -1.0;  // up to here stable values are scattered
  const auto beyond_those = [&](double part) { return part > begin && stable(part); };
  const auto fails = [&](double part) { return !(tried[part] = beyond_those(part)); };
  while (true) {
    const FoundEdge edge = find_edge(way, tried, beyond_those, true);
    if (!edge.stable) return {.scattered = scattered};
    const auto first = edge.first.value_or(*edge.stable);
    const std::vector<double> between = parts_between(first, *edge.stable, kTriedBetween);
    ahead(between);
    if (std::ranges::any_of(between, fails)) continue;
    if (!near || way.whole || !edge.beyond) return edge;
    const std::vector<double> below = parts_below(way, *edge.stable);
    ahead(below);
    const auto failing = std::ranges::find_if(below, fails);
    if (failing == below.end()) return edge;
    if (*failing > first) continue;
    scattered = true;
    const std::optional<double> own = way.own_part();
    if (own && first <= *own && *own <= *edge.stable) return {.scattered = true};
    begin = *edge.stable;
    for (auto& [part, is_stable] : tried) is_stable = is_stable && part > begin;
  }
}

Json own_value(const Scenario& scenario, const std::string& path) {
  const Json effective = effective_scenario(scenario, scenario.directory);
  Json::json_pointer at;
  for (const std::string_view key : parts_of(path, '.')) at /= std::string(key);
  return effective.contains(at) ? effective.at(at) : Json();
}

namespace {

// ---- The question

/// The end nearest to 2^10 or 2^-10 times the own value that the field allows.
double allowed_end(const LimitQuestion& question, double own, int sign) {
  for (int doublings = 10; doublings > 0; --doublings) {
    const double end = std::ldexp(own, sign * doublings);
    try {
      question.at(end);
      return end;
    } catch (const InputError&) {  // a nearer one
    }
  }
  return own;
}

void check_scene(const LoadedScenario& loaded) {
  const Scenario& scenario = loaded.scenario;
  if (!position_is_free(scenario.motion))
    fail_at(loaded.file.string() + ": /motion/position/type",
            "a prescribed tool cannot become unstable; allowed for limit: \"free\"");
  if (scenario.time.steps < 4)
    fail_at(loaded.file.string() + ": /time/steps",
            fmt::format("got {}; allowed for limit: at least 4", scenario.time.steps));
}

void check_sampling(const LoadedScenario& loaded) {
  const double step = loaded.scenario.time.step;
  if (kVibrationCutoff * step < 0.5) return;
  fail_at(loaded.file.string() + ": /time/step_s",
          fmt::format("got {}; allowed for --vibration, which is what is above {} Hz: below {:.4g}", step,
                      kVibrationCutoff, 0.5 / kVibrationCutoff));
}

// ---- Theory, which costs a thousandth of a run: it is scanned so much finer, and bisected to rounding whatever the
// runs' resolution.

constexpr int kTheoryIntervals = 256;
constexpr double kTheoryResolution = 1e-12;

/// True for springs that stay in contact, with a tool that is alone or a device whose loop is linear.
bool has_theory(const Scenario& scenario) {
  return springs_stay(scenario) && (has_device(scenario) ? device_loop(scenario, 1.0).no_theory.empty()
                                                         : std::holds_alternative<NoHandFields>(scenario.hand));
}

/// True when no mode of the springs leaves the unit circle, alone or in the loop of the device.
bool step_is_stable(const Scenario& scenario) {
  const Vec3 lambdas = stiffness_eigenvalues(scenario);
  return std::all_of(lambdas.begin(), lambdas.end(), [&](double lambda) {
    constexpr double kNoWall = 1e-12;  // a direction without springs: the handle is free to go
    if (!has_device(scenario)) return tool_on_spring(scenario, lambda).is_stable();
    return lambda < kNoWall || is_stable_step(device_loop(scenario, lambda).state_matrix());
  });
}

/// True where the integrator's inequality tells whether a step is stable.
bool has_inequality(const Scenario& scenario) {
  return !has_device(scenario) && has_theory(scenario) && scenario.integrator.type->stability_margin != nullptr;
}
bool keeps_inequality(const Scenario& scenario) {
  return scenario.integrator.type->stability_margin(tool_on_spring(scenario, stiffness_eigenvalues(scenario)[2])) >=
         0.0;
}

/// What is stable without a run, along the whole way.
struct Theory {
  std::optional<double> edge = {};  ///< as FieldLimit::theory
  /// The middles of all stretches of stable values, for runs to try: a stretch may lie between the values of a scan.
  std::vector<double> islands = {};
  bool has_none = false;  ///< no value is stable
};

/// Empty unless it `applies` to the scene at both ends.
Theory theory_of(const LimitQuestion& question, const std::function<bool(const Scenario&)>& applies,
                 const std::function<bool(const Scenario&)>& stable, int intervals) {
  const auto scenario_at = [&](double part) { return question.at(question.value_at(part)).scenario; };
  const auto holds = [&](double part) { return stable(scenario_at(part)); };
  Theory theory;
  if (!applies(scenario_at(0.0)) || !applies(scenario_at(1.0))) return theory;
  TriedParts tried = scanned(intervals, holds);
  for (auto from = tried.begin(); from != tried.end();) {
    const auto to = std::find_if(from, tried.end(), [](const auto& value) { return !value.second; });
    if (to != from) theory.islands.push_back(0.5 * (from->first + std::prev(to)->first));
    from = to == tried.end() ? to : std::next(to);
  }
  theory.has_none = theory.islands.empty();
  SearchWay way = question;
  way.resolution = kTheoryResolution;
  const FoundEdge edge = find_edge(way, tried, holds, false);
  if (edge.stable) theory.edge = way.smallest ? 0.0 : std::numeric_limits<double>::infinity();
  if (edge.beyond) theory.edge = way.value_at(*edge.stable);
  return theory;
}

/// FieldLimit::linear
std::optional<double> edge_in_contact(const LimitQuestion& question, double lambda) {
  const auto applies = [lambda](const Scenario& scenario) {
    return has_device(scenario) && contact_step(scenario, lambda).size() != 0;
  };
  const auto stable = [lambda](const Scenario& scenario) {
    return std::ranges::all_of(contact_loops(scenario, lambda, false),
                               [](const auto& loop) { return is_stable_step(loop.second); });
  };
  return theory_of(question, applies, stable, 2 * kEdgeIntervals).edge;
}

/// FieldLimit::closed_forms and worst_hand
void add_closed_forms(const LimitQuestion& question, FieldLimit& limit) {
  const Scenario scenario = question.at(question.value_at(0.0)).scenario;
  if (question.path != kStiffnessPath || question.smallest || !springs_stay(scenario) ||
      !std::holds_alternative<ImpedanceDeviceConfig>(scenario.device))
    return;
  if (!scenario.rendering.damping && scenario.rendering.damping_ratio != 0.0) return;  // B is not that of any K
  const double lambda = stiffness_eigenvalues(scenario)[2];
  const DeviceLoop start = device_loop(scenario, lambda);
  const auto& sampled = std::get<SampledLoop>(start.loop);
  limit.no_theory = start.no_theory;
  if (start.no_theory.empty()) limit.worst_hand = worst_hand_edge(sampled) / lambda;
  const bool is_known = unknown_to_theory(scenario).empty();
  for (const StiffnessLimit& known : stiffness_limits()) {
    const std::optional<double> K = is_known ? known.largest(sampled) : std::nullopt;
    limit.closed_forms.push_back(K ? std::optional(*K / lambda) : std::nullopt);
  }
}

// ---- The search

/// Adds the runs of the search to the limit, and which of them contradict it.
void add_runs(const LimitQuestion& question, const std::map<double, RunStability>& runs, FieldLimit& limit) {
  const auto is_before = [&](double a, double b) { return question.smallest ? a > b : a < b; };
  for (const auto& [value, run] : runs) {
    limit.runs.push_back({value, run.verdict});
    const bool in_interval = (!limit.beyond || is_before(value, limit.beyond->value)) &&
                             (!limit.other.beyond || is_before(limit.other.beyond->value, value));
    if (limit.value && question.holds(run.verdict) != in_interval) limit.inconsistent.push_back(limit.runs.back());
    limit.undecided += run.undecided;
  }
  limit.has_effect = std::any_of(runs.begin(), runs.end(),
                                 [&](const auto& run) { return run.second.way != runs.begin()->second.way; });
}

/// The device of a file that is one, or of a scenario, of which nothing else is looked at.
DeviceFields read_device(const Json& file) {
  const bool is_scenario = file.contains("device");
  if (!is_scenario && !file.contains("type"))
    throw InputError(
        R"(got no device; allowed: an object such as {"type": "impedance", "handle_mass_kg": 0.1}, or a scenario with "device")");
  DeviceFields device;
  read_value(is_scenario ? file["device"] : file, is_scenario ? "/device" : "",
             [&device](Fields& f) { describe(f, device); });
  return device;
}

/// The scene's hand without its mass; null when it has none.
Json massless_hand(const ScenarioText& scene) {
  const auto hand = scene.json.find("hand");
  if (hand == scene.json.end() || !hand->is_object() || hand->value("type", Json()) != "mass_spring_damper") return {};
  Json massless = *hand;
  massless["type"] = "impedance";
  massless.erase("mass_kg");
  return massless;
}

}  // namespace

LimitQuestion limit_question(const ScenarioText& scenario, const std::vector<std::string>& overrides,
                             const std::string& path, std::optional<Range> range) {
  const LoadedScenario loaded = load_scenario(scenario, overrides);
  check_scene(loaded);
  const Json own = own_value(loaded.scenario, path);
  LimitQuestion question;
  question.scene = &scenario;
  question.overrides = overrides;
  question.path = path;
  question.whole = own.is_number_integer();
  if (!range) {
    // A field that does not exist, or takes no number, says so itself.
    if (!own.is_number()) question.at(1.0);
    if (!own.is_number() || !(own.get<double>() > 0.0))
      throw InputError(fmt::format("--vary {}: {} in the scenario; allowed without --between: a number > 0", path,
                                   own.is_null() ? "not given" : own.dump()));
    const double value = own.get<double>();
    range = Range{allowed_end(question, value, -1), allowed_end(question, value, 1)};
  }
  question.at(range->from);
  const LoadedScenario last = question.at(range->to);
  question.warnings = with_files(last, last.warnings);
  question.range = {range->from, range->to, range->from > 0.0};
  if (own.is_number() && own.get<double>() >= range->from && own.get<double>() <= range->to)
    question.own = own.get<double>();
  return question;
}

FieldLimit field_limit(const LimitQuestion& question) {
  if (question.most_vibration) check_sampling(load_scenario(*question.scene, question.overrides));
  std::map<double, RunStability> runs;  // by value
  const auto run_ahead = [&](std::span<const double> parts) {
    std::vector<double> values;
    for (const double part : parts)
      if (const double value = question.value_at(part); runs.try_emplace(value).second) values.push_back(value);
    for_each_job(values.size(), {question.threads, ""}, [&](std::size_t i) {
      const LoadedScenario loaded = question.at(values[i]);
      const auto judged = [&] { return stability_of(loaded, make_shell(loaded.scenario, loaded.files), question); };
      runs.at(values[i]) = with_file(loaded, judged);
    });
  };
  const auto at_part = [&](double part) {
    return JudgedValue{question.value_at(part), runs.at(question.value_at(part)).verdict};
  };
  const auto judge = [&](double part) {
    run_ahead({&part, 1});
    return question.holds(at_part(part).verdict);
  };
  FieldLimit limit;
  Theory theory = theory_of(question, has_theory, step_is_stable, kTheoryIntervals);
  limit.theory = theory.edge;
  limit.theory_has_none = theory.has_none;
  std::vector<double> first = std::move(theory.islands);
  for (int i = 0; i <= kEdgeIntervals; ++i) first.push_back(static_cast<double>(i) / kEdgeIntervals);
  run_ahead(first);
  TriedParts tried;
  for (const double part : first) tried[part] = judge(part);
  const FoundEdge edge = question.between ? find_tried_edge(question, tried, judge, !limit.theory, run_ahead)
                                          : find_edge(question, tried, judge, true);
  limit.scattered = edge.scattered;
  if (edge.stable) {
    limit.tried_between = question.between ? kTriedBetween : 0;
    limit.value = question.value_at(*edge.stable);
    limit.settled = runs.at(*limit.value).settled;
  }
  if (edge.beyond) limit.beyond = at_part(*edge.beyond);
  if (edge.first) limit.other.value = question.value_at(*edge.first);
  if (edge.before) limit.other.beyond = at_part(*edge.before);
  if (question.own_part()) limit.own = at_part(*question.own_part());
  add_runs(question, runs, limit);
  const JudgedValue suspect = limit.beyond ? *limit.beyond : limit.runs.front();
  limit.unstable_alone =
      !question.holds(suspect.verdict) && unstable_without_contact(question.at(suspect.value), question.most_vibration);
  limit.closed_form = theory_of(question, has_inequality, keeps_inequality, kEdgeIntervals).edge;
  add_closed_forms(question, limit);
  if (!limit.theory && limit.settled.lambda_max > 0.0 && !question.smallest)
    limit.linear = edge_in_contact(question, limit.settled.lambda_max);
  return limit;
}

// ---- Devices

std::string delay_note(const Scenario& scenario) {
  const auto* device = std::get_if<ImpedanceDeviceConfig>(&scenario.device);
  if (device == nullptr || device->delay || device->delay_samples == 0.0) return "";
  const double delay = device->delay_samples, step = 1e3 * scenario.time.step;
  return fmt::format(
      "delay_samples: {:.4g} ({:.3g} ms in steps of {:.3g} ms); samples are time steps of the scene, not of the log that "
      "a device was identified from",
      delay, delay * step, step);
}

std::vector<ComparedDevice> compared_devices() {
  std::vector<ComparedDevice> devices = {{"ideal", {{"type", "ideal"}}}, {"admittance", {{"type", "admittance"}}}};
  for (const DevicePreset& preset : device_presets())
    devices.push_back(
        {preset.name, {{"type", "impedance"}, {"preset", preset.name}}, true, preset.max_stiffness.value});
  return devices;
}

ComparedDevice device_of_file(const std::filesystem::path& file) {
  const ScenarioText text = read_scenario_text(file);
  LoadedScenario place;
  place.file = file;
  place.layers = text.layers;
  const DeviceFields device = with_file(place, [&text] { return read_device(text.json); });
  return {file.stem().string(), written(device), handle_moves_tool(device)};
}

std::optional<ComparedDevice> with_friction_times(ComparedDevice device, double factor) {
  DeviceFields fields = read_device(device.json);
  auto* impedance = std::get_if<ImpedanceDeviceConfig>(&fields);
  if (impedance == nullptr || impedance->coulomb == 0.0) return std::nullopt;
  impedance->coulomb *= factor;
  device.json = written(fields);
  device.name += fmt::format("[friction*{:g}]", factor);
  return device;
}

std::vector<ComparedDevice> with_unpublished_numbers(const ComparedDevice& device) {
  std::vector<ComparedDevice> ends;
  const DevicePreset* preset = find_device_preset(device.json.value("preset", ""));
  if (preset == nullptr) return ends;
  for (const auto& [end, mark] : {std::pair(PresetEnd::soft, "[soft]"), {PresetEnd::stiff, "[stiff]"}}) {
    ends.push_back(device);
    ends.back().json = written(DeviceFields(config_of(*preset, end)));
    ends.back().name += mark;
  }
  return ends;
}

std::vector<std::string> overrides_on(const ComparedDevice& device, const ScenarioText& scene,
                                      const std::vector<std::string>& overrides) {
  std::vector<std::string> all = {"device=" + device.json.dump()};
  const Json hand = device.has_place_for_mass ? Json() : massless_hand(scene);
  if (!hand.is_null()) all.push_back("hand=" + hand.dump());
  for (const std::string& override : overrides)
    if (hand.is_null() || overridden_path(override) != "hand.mass_kg") all.push_back(override);
  return all;
}

}  // namespace hapbench
