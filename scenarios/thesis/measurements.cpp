#include "scenarios/thesis/measurements.hpp"

#include <cmath>
#include <numbers>

#include "sim/core/math.hpp"

namespace hapbench {

Scenario drill_in_hole(Scenario scenario) {
  scenario.device = IdealDeviceFields{input_force_limit(scenario.device)};
  constexpr double kPeriod = 6.0;  // [s], of the tilt of task 2
  const auto rows = static_cast<std::int64_t>(std::llround(kPeriod / scenario.time.step));
  scenario.time.steps = std::min(scenario.time.steps, rows);
  scenario.record = {};
  return scenario;
}

std::vector<ContactBuffer> contact_sets(const Scenario& scenario, std::uint64_t stride, Points points) {
  LoadedScenario loaded;
  loaded.scenario = drill_in_hole(scenario);
  if (points == Points::colliding) {
    loaded.scenario.rendering.reduction.reset();
    loaded.scenario.rendering.local_average = false;
  }
  std::vector<ContactBuffer> sets;
  for_each_row(loaded, [&](const StepRecord& row) {
    if (row.step % stride == 0 && !row.rendered->empty()) sets.push_back(copy_of(*row.rendered));
  });
  return sets;
}

MeasuredCase vibration(const std::string& name, const Result& run) {
  const auto number = [&](const char* metric) { return number_of(run.metrics, metric).value_or(0.0); };
  return {name,
          {{"velocity_variation", {number("velocity_total_variation_m_per_s")}},
           {"vibration_power", {number("vibration_power_above_30Hz_m2_per_s2")}},
           {"force_reversals", {number("force_reversals")}}}};
}

Measured vibrations_beside_shaping(const Evidence& e, const std::string& law, const std::string& task,
                                   const std::vector<std::string>& overrides_of_task) {
  Measured measured;
  for (const std::string& scene : {std::string("peg_in_hole_2d_frictionless_shaped_stiffness"), task}) {
    for (const std::string& algorithm : {law, std::string(kProposedLaw)}) {
      std::vector<std::string> overrides = {"rendering.algorithm=" + algorithm, "rendering.reduction=null",
                                            "record.ratio_iterations=[]"};
      if (scene == task) overrides.insert(overrides.end(), overrides_of_task.begin(), overrides_of_task.end());
      const Result run = e.run(scene, overrides);
      measured.push_back(vibration(algorithm + (scene == task ? ", task 2" : ", planar peg"), run));
      measured.back().values["diverges"] = {run.end.outcome == Outcome::diverges ? 1.0 : 0.0};
    }
  }
  return measured;
}

bool vibrates_much_more(const MeasuredCase& a, const MeasuredCase& b, const PublishedNumbers& p) {
  const double more = threshold(p, "vibrates");
  const bool moves = a["velocity_variation"] >= more * b["velocity_variation"] &&
                     a["vibration_power"] >= more * more * b["vibration_power"];
  return moves || (vibrates_more(a, b) && a["force_reversals"] >= more * std::max(1.0, b["force_reversals"]));
}

std::optional<double> damping_ratio_of_swings(std::span<const double> x) {
  constexpr double kSmallest = 1e-6;  // [m]
  std::vector<double> extremes;
  for (std::size_t i = 1; i + 1 < x.size(); ++i) {
    if ((x[i] - x[i - 1]) * (x[i + 1] - x[i]) >= 0.0) continue;
    if (std::abs(x[i]) < kSmallest) break;
    extremes.push_back(std::abs(x[i]));
  }
  if (extremes.size() < 2) return std::nullopt;
  const double q = math::pow(extremes.back() / extremes.front(), 1.0 / static_cast<double>(extremes.size() - 1));
  if (q >= 1.0) return 0.0;
  const double log_q = math::log(q);
  return -log_q / std::sqrt(std::numbers::pi * std::numbers::pi + log_q * log_q);
}

}  // namespace hapbench
