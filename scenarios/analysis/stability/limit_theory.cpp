#include "scenarios/analysis/stability/limit_theory.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>

#include "device_model/impedance_device.hpp"
#include "device_model/theory/linear_loops.hpp"
#include "scenarios/run/linear_contact.hpp"
#include "scenarios/run/scene_loop.hpp"
#include "scenarios/scene/environments.hpp"

namespace hapbench {
namespace {

bool is_without_hand(const Scenario& scenario) {
  return std::holds_alternative<NoHandFields>(scenario.hand);
}

using IsTrueOf = std::function<bool(const Scenario&)>;

// An evaluation of the theory costs a thousandth of a run. The scan is therefore finer than the scan by runs, and
// bisection continues down to rounding.
constexpr int kTheoryIntervals = 256;
constexpr double kTheoryResolution = 1e-12;
// Relative resolution for contact_limit(): finer than the relative error of the derivatives of a rendered force, 1e-7.
constexpr double kContactResolution = 1e-9;

/// Returns true if the springs are in permanent contact with the tool, and the loop of tool, hand and device is linear.
bool has_eigenvalues(const Scenario& scenario) {
  if (!has_permanent_springs(scenario) || std::holds_alternative<TrackingHandFields>(scenario.hand)) return false;
  if (has_device(scenario)) return device_loop(scenario, 1.0).no_theory.empty();
  return !std::get<IdealDeviceFields>(scenario.device).force_limit || is_without_hand(scenario);
}

/// Returns true if, for each principal stiffness of the springs, all eigenvalues of the linear map of one time step lie
/// inside the unit circle.
bool step_is_stable(const Scenario& scenario) {
  // A direction with a stiffness below kNoWall, in units of K, has no springs: the handle moves freely along it.
  constexpr double kNoWall = 1e-12;
  const Vec3 lambdas = stiffness_eigenvalues(scenario);
  return std::all_of(lambdas.begin(), lambdas.end(), [&](double lambda) {
    if (!has_device(scenario) && is_without_hand(scenario)) return tool_on_spring(scenario, lambda).is_stable();
    if (!device_acts_on_tool(scenario)) return is_stable_loop({step_matrix_with_hand(scenario, lambda)});
    return lambda < kNoWall || is_stable_step(device_loop(scenario, lambda).state_matrix());
  });
}

/// Returns true if the integrator has a stability inequality that applies to the scenario.
bool has_inequality(const Scenario& scenario) {
  return !has_device(scenario) && is_without_hand(scenario) && has_eigenvalues(scenario) &&
         scenario.integrator.type->stability_margin != nullptr;
}

/// Returns true if the motion along the stiffest direction satisfies the integrator's stability inequality.
bool keeps_inequality(const Scenario& scenario) {
  const double lambda = stiffness_eigenvalues(scenario)[2];
  return scenario.integrator.type->stability_margin(tool_on_spring(scenario, lambda)) >= 0.0;
}

/// Returns the midpoints of the contiguous intervals of stable parameters.
std::vector<double> stable_intervals(const EvaluatedParameters& evaluated) {
  std::vector<double> middles;
  std::optional<double> begin, end;
  const auto close = [&] {
    if (begin) middles.push_back(0.5 * (*begin + *end));
    begin.reset();
  };
  for (const auto& [t, is_stable] : evaluated) {
    if (!is_stable) {
      close();
      continue;
    }
    if (!begin) begin = t;
    end = t;
  }
  close();
  return middles;
}

/// Returns the limit of the condition `stable`. Empty if `applies` is false at an end of the range. `intervals`: number
/// of intervals of the scan.
TheoreticalLimit limit_by(const LimitQuestion& question, const IsTrueOf& applies, const IsTrueOf& stable,
                          int intervals) {
  const auto scenario_at = [&](double t) { return question.at(question.search.value_at(t)).scenario; };
  const auto holds = [&](double t) { return stable(scenario_at(t)); };
  TheoreticalLimit limit;
  if (!applies(scenario_at(0.0)) || !applies(scenario_at(1.0))) return limit;
  EvaluatedParameters evaluated = evaluate_scan(intervals, holds);
  limit.islands = stable_intervals(evaluated);
  limit.has_none = limit.islands.empty();
  IntervalSearchOptions options = question.search;
  options.resolution = kTheoryResolution;
  const StableInterval interval = find_stable_interval(options, evaluated, holds, false);
  if (interval.stable) limit.value = limit_without_transition(true, options.smallest);
  if (interval.beyond) limit.value = options.value_at(*interval.stable);
  return limit;
}

}  // namespace

double limit_without_transition(bool is_stable, bool smallest) {
  return is_stable != smallest ? std::numeric_limits<double>::infinity() : 0.0;
}

TheoreticalLimit eigenvalue_limit(const LimitQuestion& question) {
  return limit_by(question, has_eigenvalues, step_is_stable, kTheoryIntervals);
}

TheoreticalLimit frictionless_limit(const LimitQuestion& question) {
  const auto on_smooth_device = [](bool (*condition)(const Scenario&)) {
    return [condition](Scenario scenario) {
      if (auto* device = std::get_if<ImpedanceDeviceConfig>(&scenario.device))
        device->coulomb = device->encoder_step = device->force_step = 0.0;
      return condition(scenario);
    };
  };
  return limit_by(question, on_smooth_device(has_eigenvalues), on_smooth_device(step_is_stable), kTheoryIntervals);
}

TheoreticalLimit inequality_limit(const LimitQuestion& question) {
  return limit_by(question, has_inequality, keeps_inequality, kScanIntervals);
}

std::optional<double> contact_limit(const LimitQuestion& question, double stable, const ContactState& near) {
  constexpr double kStep = 1.0 / (4 * kScanIntervals);
  IntervalSearchOptions options = question.search;
  options.current = stable;
  options.resolution = kContactResolution;
  ContactLoops loops(near, question.path == kStiffnessPath, /*at_any_pose=*/false);
  LimitWalk walk{.start = *options.current_parameter()};
  walk.next = [](double t, bool up) { return std::clamp(up ? t + kStep : t - kStep, 0.0, 1.0); };
  walk.is_resolved = [&](double a, double b) { return !options.needs_bisection(a, b); };
  const auto limit = limit_along(walk, [&](double t) {
    const CheckedScenario scenario = checked(question.at(options.value_at(t)));
    return loops.is_stable(scenario.scenario(), scenario.files(), make_shell(scenario.scenario(), scenario.files()));
  });
  if (!limit) return std::nullopt;
  if (!std::isinf(*limit)) return options.value_at(*limit);
  return limit_without_transition(*limit > 0.0, options.smallest);
}

WallLimits wall_limits(const LimitQuestion& question) {
  WallLimits limits;
  const Scenario scenario = question.at(question.search.value_at(0.0)).scenario;
  if (question.path != kStiffnessPath || question.search.smallest || !has_permanent_springs(scenario) ||
      !std::holds_alternative<ImpedanceDeviceConfig>(scenario.device))
    return limits;
  // The closed forms assume a damping B that does not depend on K. A damping ratio makes B depend on K.
  if (!scenario.rendering.damping && scenario.rendering.damping_ratio != 0.0) return limits;
  const double lambda = stiffness_eigenvalues(scenario)[2];
  const DeviceLoop start = device_loop(scenario, lambda);
  const auto& sampled = std::get<SampledLoop>(start.loop);
  limits.no_theory = start.no_theory;
  if (start.no_theory.empty()) limits.worst_hand = worst_hand_stability_limit(sampled) / lambda;
  const bool is_known = unmodelled_fields(scenario).empty();
  for (const StiffnessLimit& known : stiffness_limits()) {
    const std::optional<double> K = is_known ? known.largest(sampled) : std::nullopt;
    limits.closed_forms.push_back(K ? std::optional(*K / lambda) : std::nullopt);
  }
  return limits;
}

}  // namespace hapbench
