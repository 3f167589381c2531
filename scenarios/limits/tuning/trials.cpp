#include "scenarios/limits/tuning/trials.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <span>

#include "scenarios/cases/comparison.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/diagnosis.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/run/scene_loop.hpp"

namespace hapbench {
namespace {

std::vector<FamilyMember> hands_of(const Scenario& scenario) {
  const bool has_mass = std::holds_alternative<MassSpringDamperHandFields>(scenario.hand);
  if (!has_mass && spring_of(scenario.hand) == nullptr && !std::holds_alternative<DragHandFields>(scenario.hand))
    return {};
  const auto family = hand_family().subspan(1);  // the first is not a hand
  const auto [soft, stiff] = std::ranges::minmax(family, {}, &AttachedHand::stiffness);
  const auto [light, heavy] = std::ranges::minmax(family, {}, &AttachedHand::mass);
  std::vector<FamilyMember> hands;
  for (const double k : {soft.stiffness, stiff.stiffness}) {
    const std::string spring = fmt::format("hand.stiffness_N_per_m={}", k);
    if (!has_mass) hands.push_back({fmt::format("a hand of {} N/m", k), {spring}});
    for (const double m : {light.mass, heavy.mass})
      if (has_mass)
        hands.push_back({fmt::format("a hand of {} kg and {} N/m", m, k), {spring, fmt::format("hand.mass_kg={}", m)}});
  }
  return hands;
}

std::vector<FamilyMember> seeds_of(const LoadedScenario& loaded) {
  constexpr std::size_t kSeeds = 5;    // the scene's own among them
  constexpr double kSeedShift = 1e-5;  // [m]
  const Axis axis = seed_axis(loaded.scenario, kSeeds, kSeedShift);
  std::vector<FamilyMember> seeds;
  for (std::size_t k = 1; k < kSeeds; ++k)
    seeds.push_back({"seed " + axis.values[k], {"seed=" + axis.values[k], axis.along[k].overrides.front()}});
  return seeds;
}

/// Makes everything in the JSON of a hand or a motion so many times as fast.
void hasten(Json& json, double times) {
  if (!json.is_structured()) return;
  for (auto& [key, value] : json.items()) {
    if (value.is_number() && (key == "speed_m_per_s" || key == "rate_per_s")) value = value.get<double>() * times;
    if (value.is_number() && key == "period_s") value = value.get<double>() / times;
    if (key == "points" && value.is_array()) {
      for (Json& point : value) point[0] = point[0].get<double>() / times;
    } else {
      hasten(value, times);
    }
  }
}

std::vector<FamilyMember> speeds_of(const LoadedScenario& loaded) {
  std::vector<FamilyMember> speeds;
  const Json own = effective_scenario(loaded.scenario, loaded.scenario.directory);
  for (const double times : {0.5, 2.0}) {
    FamilyMember member{times < 1.0 ? "half the speed" : "twice the speed"};
    for (const char* section : {"hand", "motion"}) {
      Json json = own.value(section, Json());
      hasten(json, times);
      if (json != own.value(section, Json())) member.overrides.push_back(fmt::format("{}={}", section, json.dump()));
    }
    if (member.overrides.empty()) return {};
    member.overrides.push_back(
        fmt::format("time.steps={:.0f}", static_cast<double>(loaded.scenario.time.steps) / times));
    speeds.push_back(std::move(member));
  }
  return speeds;
}

std::string with(const FamilyMember& member) {
  return member.overrides.empty() ? "" : fmt::format(" ({})", member.name);
}

std::string verdict_with(const RunStability& run, const FamilyMember& member) {
  return std::string(run_verdict_name(run.verdict)) + with(member);
}

/// The hand with which the loop is unstable at some stiffness from K to `most`, if there is one.
std::optional<std::string> unstable_loop(Scenario scenario, double lambda, double K, double most, bool over_hands) {
  constexpr double kStride = 1.1;
  for (double at = most; lambda > 0.0 && at * kStride > K; at /= kStride) {
    scenario.rendering.stiffness = at;
    for (const auto& [hand, step] : contact_loops(scenario, lambda, over_hands))
      if (!is_stable_step(step)) return hand;
  }
  return std::nullopt;
}

/// Notes the worst value of a limited metric over the family; empty where it has none in some run.
void note_worst(TuneTrial& trial, const std::string& name, const MetricBound& bound,
                std::span<const TuneMetrics> metrics, std::span<const FamilyMember> family) {
  for (std::size_t i = 0; i < metrics.size(); ++i) {
    const auto value = value_in(metrics[i], name);
    if (!value) {
      trial.worst.erase(name);
      trial.worst_text[name] = name + " has no value" + with(family[i]);
      return;
    }
    const auto [worst, is_first] = trial.worst.try_emplace(name, *value);
    const bool is_worse = bound.max ? *value > worst->second : *value < worst->second;
    if (!is_first && !is_worse) continue;
    worst->second = *value;
    trial.worst_text[name] = fmt::format("{} {:.4g}{}", name, *value, with(family[i]));
  }
}

}  // namespace

std::vector<FamilyMember> family_of(const LoadedScenario& loaded, const std::string& family) {
  if (family == "hands") return hands_of(loaded.scenario);
  return family == "seeds" ? seeds_of(loaded) : speeds_of(loaded);
}

Trials::Trials(const TuneQuestion& asked, const std::string& law)
    : question(asked),
      algorithm(law),
      ranges(tune_ranges(asked, law)),
      over_hands(std::ranges::find(asked.families, "hands") != asked.families.end()),
      is_quiet(asked.limits.empty()),
      limits(asked.limits),
      cap(ranges.stiffness.to) {
  const LoadedScenario own = load({}, ranges.stiffness.from, {});
  shell = make_shell(own.scenario, own.files);
  for (const std::string& of : question.families)
    for (FamilyMember& member : family_of(own, of)) family.push_back(std::move(member));
  if (springs_stay(own.scenario)) springs_lambda = stiffness_eigenvalues(own.scenario)[2];
  for (const DiagnosisRule& rule : diagnosis_rules())
    if (is_quiet && rule.quiet) limits[rule.name].max = rule.threshold;
  end.fail("range", "the end of the range that was searched");
}

// ---- Runs

std::vector<std::string> Trials::overrides(const TuneSetting& setting, double stiffness) const {
  std::vector<std::string> words = question.overrides;
  words.push_back("rendering.algorithm=" + algorithm);
  if (setting.damping_ratio) {
    words.push_back("rendering.damping_N_s_per_m=null");
    words.push_back(fmt::format("rendering.damping_ratio={}", *setting.damping_ratio));
  }
  if (setting.mass) words.push_back(fmt::format("rendering.mass_kg={}", *setting.mass));
  if (!setting.filter.empty()) words.push_back("device.velocity_filter=" + setting.filter);
  words.push_back(fmt::format("{}={}", kStiffnessPath, stiffness));
  return words;
}

LoadedScenario Trials::load(const TuneSetting& setting, double stiffness, const FamilyMember& member,
                            const std::string& more) const {
  std::vector<std::string> fields = overrides(setting, stiffness);
  fields.insert(fields.end(), member.overrides.begin(), member.overrides.end());
  if (!more.empty()) fields.push_back(more);
  return load_scenario(question.scenario, fields);
}

void Trials::in_parallel(std::size_t count, const std::function<void(std::size_t)>& job) {
  runs += count;
  for_each_job(count, {question.threads, ""}, job);
  if (question.on_runs) question.on_runs(runs);
}

TuneMetrics Trials::metrics_of(const Result& run) const {
  TuneMetrics metrics;
  const auto add = [&](const std::string& name) {
    if (const auto value = number_of(run.metrics, name)) metrics[name] = *value;
  };
  for (const char* name : kTuneMetrics) add(name);
  for (const auto& [name, bound] : question.limits) add(name);
  return metrics;
}

void Trials::measure(TuneTrial& trial) {
  if (!trial.metrics.empty()) return;
  in_parallel(1, [&](std::size_t) {
    trial.metrics = metrics_of(run_with_shell(load(trial, trial.stiffness, family[0]), shell));
  });
}

std::optional<Failing> Trials::first_failing(const TuneTrial& trial, std::size_t count,
                                             const std::function<std::string(std::size_t)>& more) {
  const double lambda = springs_lambda.value_or(trial.lambda_max), K = trial.stiffness;
  std::vector<std::string> why(count);
  in_parallel(count, [&](std::size_t i) {
    const FamilyMember& member = family[i % family.size()];
    const LoadedScenario loaded = load(trial, K, member, more(i));
    if (unstable_loop(loaded.scenario, lambda, K, loaded.scenario.rendering.stiffness, over_hands)) {
      why[i] = "unstable in contact" + with(member);
      return;
    }
    const RunStability run = stability_of(loaded, shell, rule_of(loaded.scenario));
    if (!is_stable(run.verdict)) why[i] = verdict_with(run, member);
  });
  for (std::size_t i = 0; i < count; ++i)
    if (!why[i].empty()) return Failing{i, why[i]};
  return std::nullopt;
}

// ---- Trials

TuneTrial& Trials::tried(const TuneSetting& setting, double stiffness) {
  const auto [place, is_new] = all.try_emplace({setting, stiffness});
  TuneTrial& trial = place->second;
  if (!is_new) return trial;
  static_cast<TuneSetting&>(trial) = setting;
  trial.algorithm = algorithm;
  trial.stiffness = stiffness;
  if (springs_lambda && !judge_loop(trial, 0, *springs_lambda, "the device alone")) return trial;
  if (runs >= kMostTuneRuns) {
    trial.fail("runs", fmt::format("the search ended after {} runs", runs));
    return trial;
  }
  judge_motion(trial, 0, 1);
  if (trial.feasible() && family.size() > 1) judge_motion(trial, 1, family.size());
  if (trial.feasible()) judge_limits(trial);
  return trial;
}

/// Finds the first of the members from `first` on that is not settled with the margin.
void Trials::judge_motion(TuneTrial& trial, std::size_t first, std::size_t last) {
  std::vector<RunStability> judged(2 * (last - first));  // of each member at K and at G K
  in_parallel(judged.size(), [&](std::size_t job) {
    const double gain = job % 2 != 0 ? question.margin : 1.0;
    const LoadedScenario loaded = load(trial, gain * trial.stiffness, family[first + job / 2]);
    judged[job] = stability_of(loaded, shell, rule_of(loaded.scenario));
  });
  if (first == 0) trial.lambda_max = judged[0].settled.lambda_max;
  for (std::size_t i = first; i < last; ++i) {
    const RunStability &at_K = judged[2 * (i - first)], &at_GK = judged[2 * (i - first) + 1];
    if (!is_stable(at_K.verdict)) {
      trial.too_soft = at_K.verdict >= RunVerdict::thrown_out && at_K.verdict <= RunVerdict::went_through;
      return trial.fail("settled", verdict_with(at_K, family[i]));
    }
    trial.settled = true;
    if (!is_stable(at_GK.verdict))
      return trial.fail("margin", fmt::format("at {:g} K {}", question.margin, verdict_with(at_GK, family[i])));
    // Of springs it was asked before the runs.
    if (!springs_lambda && !judge_loop(trial, i, at_K.settled.lambda_max, family[i].name)) return;
  }
}

/// False where the loop in contact of a member is unstable up to the margin.
bool Trials::judge_loop(TuneTrial& trial, std::size_t member, double lambda, const std::string& own_hand) const {
  const Scenario scenario = load(trial, trial.stiffness, family[member]).scenario;
  const double K = trial.stiffness;
  const auto hand = unstable_loop(scenario, lambda, K, question.margin * K, over_hands);
  if (!hand) return true;
  trial.fail("margin", fmt::format("below {:g} K the loop in contact is unstable with {}", question.margin,
                                   hand->empty() ? own_hand : *hand));
  return false;
}

// ---- Limits

void Trials::judge_limits(TuneTrial& trial) {
  // What is quiet is asked of the scene's own run, a user's metrics of all.
  std::vector<TuneMetrics> metrics(is_quiet ? 1 : family.size());
  in_parallel(metrics.size(), [&](std::size_t i) {
    const LoadedScenario loaded = load(trial, trial.stiffness, family[i]);
    const Result run = run_with_shell(loaded, shell);
    metrics[i] = metrics_of(run);
    if (!is_quiet) return;
    for (const Diagnosed& number : quiet_numbers(loaded, run)) {
      trial.worst[number.rule] = number.value;
      trial.worst_text[number.rule] = number.says;
    }
  });
  trial.metrics = metrics[0];
  for (const auto& [name, bound] : question.limits) note_worst(trial, name, bound, metrics, family);
  judge_worst(trial);
}

void Trials::judge_worst(TuneTrial& trial) const {
  trial.binding.clear();
  trial.too_soft = false;
  const auto broken = std::ranges::find_if(
      limits, [&](const auto& limit) { return times_limit(trial, limit.first, limit.second) > 1.0; });
  trial.limits_alone = broken != limits.end();
  if (!trial.limits_alone) return;
  const auto& [name, bound] = *broken;
  trial.too_soft = bound.max && trial.worst.contains(name) && (name.starts_with("inside") || name.starts_with("depth"));
  trial.fail(name, trial.worst_text.at(name));
}

double Trials::times_limit(const TuneTrial& trial, const std::string& name, const MetricBound& bound) const {
  constexpr double kBeyond = std::numeric_limits<double>::infinity();
  const auto value = value_in(trial.worst, name);
  if (!value) return is_quiet ? 0.0 : kBeyond;
  const auto times = [](double far, double near) { return far > 0.0 && near > 0.0 ? far / near : kBeyond; };
  if (bound.max && *value > *bound.max) return std::max(times(*value, *bound.max), std::nextafter(1.0, 2.0));
  if (bound.min && *value < *bound.min) return std::max(times(*bound.min, *value), std::nextafter(1.0, 2.0));
  return 1.0;
}

std::pair<int, double> Trials::excess(const TuneTrial& trial) const {
  std::pair<int, double> found{0, 0.0};
  for (const auto& [name, bound] : limits) {
    const double times = times_limit(trial, name, bound);
    found.first += times > 1.0;
    found.second = std::max(found.second, times);
  }
  return found;
}

const TuneTrial* Trials::nearest() const {
  const TuneTrial* nearest = nullptr;
  for (const auto& [key, trial] : all)
    if (trial.limits_alone && (nearest == nullptr || excess(trial) < excess(*nearest))) nearest = &trial;
  return nearest;
}

}  // namespace hapbench
