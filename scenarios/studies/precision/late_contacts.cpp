#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "algorithms/stages/damping_and_limits.hpp"
#include "device_model/theory/linear_loops.hpp"
#include "results/observe/metrics.hpp"
#include "results/summary/outcome_names.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/studies/precision/measure.hpp"
#include "scenarios/studies/stability/judged_run.hpp"

/// The cost of finding contacts in some rows only, for every algorithm: how far the tool goes another way, how much it
/// vibrates, and how stiff it may be.
namespace hapbench {
namespace {

constexpr std::int64_t kQueryEvery[] = {1, 2, 4, 8, 16, 32};
constexpr double kLongestRun = 2.0;       ///< [s]
constexpr double kStiffnessWidth = 0.05;  ///< relative, of the interval in which the largest stable K lies
/// Largest rms of the handle's speed above 30 Hz in the last quarter of a stable run [m/s]: what the points of the
/// molar make of a law with fresh contacts stays below, a limit cycle does not.
constexpr double kMostVibrationOfLate = 0.01;
constexpr double kStiffnessRange = 1024.0;  ///< K is looked for between the scene's own over this and times this

Scenario free_scene(Scenario scenario) {
  require_free_position(scenario);
  scenario.device = IdealDeviceFields{input_force_limit(scenario.device)};
  scenario.time.steps = std::min<std::int64_t>(scenario.time.steps, std::llround(kLongestRun / scenario.time.step));
  scenario.record = {};
  return scenario;
}

bool is_stable_at(const Scenario& scenario, double stiffness, const std::shared_ptr<const PointShell>& shell) {
  LoadedScenario loaded;
  loaded.scenario = scenario;
  loaded.scenario.rendering.stiffness = stiffness;
  loaded.files = NamedFiles(loaded.scenario);
  return is_stable(judged_run(loaded, shell, {.most_vibration = kMostVibrationOfLate}).verdict);
}

/// The end of the stable values of K that begin at the scene's own, or if that is not stable, at the first power of two
/// times it that is, upwards first: some laws are too soft for a scene. None where no K is, or the largest is stable.
std::optional<double> largest_stiffness(const Scenario& scenario, const std::shared_ptr<const PointShell>& shell) {
  const double own = scenario.rendering.stiffness, least = own / kStiffnessRange, most = own * kStiffnessRange;
  const auto stable = [&](double K) { return is_stable_at(scenario, K, shell); };
  double from = own;
  while (from <= most && !stable(from)) from *= 2.0;
  if (from > most)
    for (from = own / 2.0; from >= least && !stable(from);) from /= 2.0;
  if (from < least) return std::nullopt;
  const double edge = largest_stable(from, kStiffnessWidth, stable, most);
  return std::isfinite(edge) ? std::optional(edge) : std::nullopt;
}

/// The largest stable K of one contact that lasts.
double held_spring_edge(const Scenario& scenario) {
  RenderingConfig rendering = scenario.rendering;
  const Lateness& late = *rendering.late;
  return first_edge(1.0, 1e12, [&](double K) {
    rendering.stiffness = K;
    const SpringDamper spring{.K = K,
                              .B = normal_damping(rendering),
                              .M = rendering.mass,
                              .dt = scenario.time.step,
                              .integrator = scenario.integrator.type};
    return HeldSpring{spring, late.every, late.delay}.state_matrix();
  });
}

}  // namespace

static PrecisionResult study_late_contacts(const Scenario& given, const PrecisionOptions& options) {
  Scenario scenario = free_scene(given);
  PrecisionResult result;
  result.columns = {"rate_Hz", "error_rms_m", "force_rms_above_30Hz_N", "stiffness_max_N_per_m", "theory_N_per_m"};
  result.timed = "step";
  const auto shell = make_shell(scenario);
  for (const AlgorithmEntry& algorithm : algorithms()) {
    Scenario run = with_algorithm(scenario, algorithm.info->name);
    run.rendering.late.reset();
    const std::vector<Vec3> fresh = sampled_run(run, shell, 1).positions;
    for (const bool linear : {false, true}) {
      for (const std::int64_t every : kQueryEvery) {
        run.rendering.late = given.rendering.late.value_or(Lateness{});
        run.rendering.late->every = every;
        run.rendering.late->linear = linear;
        MetricsObserver metrics(run.time.step, {});
        const SampledRun late = sampled_run(run, shell, 1, {&metrics});
        PrecisionRow row{fmt::format("{} {} {}", algorithm.info->name, linear ? "linear" : "hold", every),
                         std::string(outcome_name(late.result.outcome)),
                         {1.0 / (run.time.step * static_cast<double>(every)), distance(late.positions, fresh).rms,
                          metrics.metrics().contact.rms_above_cutoff(), largest_stiffness(run, shell), std::nullopt},
                         seconds_per_step(run, shell, options.repetitions)};
        if (!linear) row.values.back() = held_spring_edge(run);
        result.add(std::move(row), options, 2 * algorithms().size() * std::size(kQueryEvery));
      }
    }
  }
  return result;
}

const PrecisionStudy kLateContactsStudy = {
    "late_contacts",
    "every algorithm with contacts of 2048 … 64 Hz, held or linear: way, vibration, largest stable stiffness",
    "drag_molar", study_late_contacts};

}  // namespace hapbench
