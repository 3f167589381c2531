#include "scenarios/limits/stability/field_limit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <utility>

#include "device_model/theory/linear_loops.hpp"
#include "scenarios/format/text_lines.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/scene_loop.hpp"
#include "sim/core/math.hpp"

namespace hapbench {
double SearchWay::value_at(double part) const {
  const double value = range.value_at(smallest ? 1.0 - part : part);
  return whole ? std::round(value) : value;
}

std::optional<double> SearchWay::own_part() const {
  if (!own) return std::nullopt;
  const auto [from, to, logarithmic] = range;
  const double part = logarithmic ? math::log(*own / from) / math::log(to / from) : (*own - from) / (to - from);
  return smallest ? 1.0 - part : part;
}

bool SearchWay::apart(double a, double b) const {
  const double low = std::min(value_at(a), value_at(b)), high = std::max(value_at(a), value_at(b));
  if (whole) return high - low > 1.0;
  if (range.logarithmic) return high > (1.0 + resolution) * low;
  return high - low > resolution * (range.to - range.from);
}

std::map<double, bool> scanned(int intervals, const std::function<bool(double)>& stable) {
  std::map<double, bool> tried;
  for (int i = 0; i <= intervals; ++i) {
    const double part = static_cast<double>(i) / intervals;
    tried[part] = stable(part);
  }
  return tried;
}

FoundEdge find_edge(const SearchWay& way, std::map<double, bool>& tried, const std::function<bool(double)>& stable,
                    bool beside) {
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

double may_fail_share(std::size_t tried) {
  return 1.0 - math::pow(0.05, 1.0 / static_cast<double>(tried));
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

double near_part(const SearchWay& way, double part) {
  const auto [from, to, logarithmic] = way.range;
  if (logarithmic) return math::log(1.0 + kNear) / math::log(to / from);
  return kNear * std::max(std::abs(way.value_at(part)) / (to - from), way.resolution);
}

FoundEdge find_tried_edge(const SearchWay& way, std::map<double, bool>& tried,
                          const std::function<bool(double)>& stable, bool near,
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
    const double low = std::max(0.0, *edge.stable - near_part(way, *edge.stable));
    const std::vector<double> below = parts_between(*edge.stable, low, kTriedNear);
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

LoadedScenario LimitQuestion::at(double value) const {
  std::vector<std::string> all = overrides;
  all.push_back(whole ? fmt::format("{}={:.0f}", path, value) : fmt::format("{}={}", path, value));
  return load_scenario(*scene, all);
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
  constexpr int kDoublings = 10;
  for (int doublings = kDoublings; doublings > 0; --doublings) {
    const double end = std::ldexp(own, sign * doublings);
    try {
      question.at(end);
      return end;
    } catch (const InputError&) {
      continue;
    }
  }
  return own;
}

[[noreturn]] void refuse(const LoadedScenario& loaded, const char* place, const std::string& problem) {
  throw InputError(InputError::Kind::relation, loaded.file.string() + ": " + place, problem);
}

void check_scene(const LoadedScenario& loaded) {
  const Scenario& scenario = loaded.scenario;
  if (!position_is_free(scenario.motion))
    refuse(loaded, "/motion/position/type", "a prescribed tool cannot become unstable; allowed for limit: \"free\"");
  if (scenario.time.steps < 4)
    refuse(loaded, "/time/steps", fmt::format("got {}; allowed for limit: at least 4", scenario.time.steps));
}

void check_sampling(const LoadedScenario& loaded) {
  if (kVibrationCutoff * loaded.scenario.time.step < 0.5) return;
  refuse(loaded, "/time/step_s",
         fmt::format("got {}; allowed for --vibration, which is what is above {} Hz: below {:.4g}",
                     loaded.scenario.time.step, kVibrationCutoff, 0.5 / kVibrationCutoff));
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
  return *tool_on_spring(scenario, stiffness_eigenvalues(scenario)[2]).margin() >= 0.0;
}

/// The edges of what is stable without a run, along the whole way.
class Theory {
 public:
  using Predicate = std::function<bool(const Scenario&)>;
  /// Empty unless it `applies` to the scene at both ends.
  Theory(const LimitQuestion& question, const Predicate& applies, Predicate stable, int intervals)
      : question_(question), stable_(std::move(stable)) {
    for (const double end : {0.0, 1.0})
      if (!applies(question.at(question.value_at(end)).scenario)) return;
    tried_ = scanned(intervals, [this](double part) { return holds(part); });
  }

  /// The middles of all stretches of stable values, for runs to try: a stretch may lie between the values of a scan.
  std::vector<double> islands() const {
    std::vector<double> middles;
    for (auto from = tried_.begin(); from != tried_.end();) {
      const auto to = std::find_if(from, tried_.end(), [](const auto& tried) { return !tried.second; });
      if (to != from) middles.push_back(0.5 * (from->first + std::prev(to)->first));
      from = to == tried_.end() ? to : std::next(to);
    }
    return middles;
  }
  /// True where no value is stable.
  bool has_none() const { return !tried_.empty() && islands().empty(); }
  std::optional<double> edge() const {
    if (tried_.empty()) return std::nullopt;
    std::map<double, bool> tried = tried_;
    SearchWay way = question_;
    way.resolution = kTheoryResolution;
    const FoundEdge edge = find_edge(
        way, tried, [this](double part) { return holds(part); }, false);
    if (!edge.stable) return std::nullopt;
    if (edge.beyond) return way.value_at(*edge.stable);
    return way.smallest ? 0.0 : std::numeric_limits<double>::infinity();
  }

 private:
  bool holds(double part) const { return stable_(question_.at(question_.value_at(part)).scenario); }

  const LimitQuestion& question_;
  Predicate stable_;
  std::map<double, bool> tried_;
};

/// FieldLimit::linear
std::optional<double> edge_in_contact(const LimitQuestion& question, double lambda) {
  const auto applies = [lambda](const Scenario& scenario) {
    return has_device(scenario) && contact_step(scenario, lambda).size() != 0;
  };
  const auto stable = [lambda](const Scenario& scenario) {
    return std::ranges::all_of(contact_loops(scenario, lambda, false),
                               [](const auto& loop) { return is_stable_step(loop.second); });
  };
  return Theory(question, applies, stable, 2 * kEdgeIntervals).edge();
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

/// True for a value in the interval of stable ones that the limit ends.
bool is_in_interval(double value, const FieldLimit& limit, bool smallest) {
  const auto is_before = [smallest](double a, double b) { return smallest ? a > b : a < b; };
  return (!limit.beyond || is_before(value, limit.beyond->value)) &&
         (!limit.other.beyond || is_before(limit.other.beyond->value, value));
}

/// Adds the runs of the search to the limit, and which of them contradict it.
void add_runs(const LimitQuestion& question, const std::map<double, RunStability>& runs, FieldLimit& limit) {
  for (const auto& [value, run] : runs) {
    limit.runs.push_back({value, run.verdict});
    if (limit.value && question.holds(run.verdict) != is_in_interval(value, limit, question.smallest))
      limit.inconsistent.push_back(limit.runs.back());
    limit.undecided += run.undecided;
  }
  limit.has_effect = std::any_of(runs.begin(), runs.end(),
                                 [&](const auto& run) { return run.second.way != runs.begin()->second.way; });
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
  const Theory theory(question, has_theory, step_is_stable, kTheoryIntervals);
  limit.theory = theory.edge();
  limit.theory_has_none = theory.has_none();
  std::vector<double> first = theory.islands();
  for (int i = 0; i <= kEdgeIntervals; ++i) first.push_back(static_cast<double>(i) / kEdgeIntervals);
  run_ahead(first);
  std::map<double, bool> tried;
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
  limit.closed_form = Theory(question, has_inequality, keeps_inequality, kEdgeIntervals).edge();
  add_closed_forms(question, limit);
  if (!limit.theory && limit.settled.lambda_max > 0.0 && !question.smallest)
    limit.linear = edge_in_contact(question, limit.settled.lambda_max);
  return limit;
}

}  // namespace hapbench
