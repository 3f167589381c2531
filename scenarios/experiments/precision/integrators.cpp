#include <fmt/format.h>

#include <cmath>
#include <unsupported/Eigen/MatrixFunctions>

#include "results/outcome_names.hpp"
#include "scenarios/codec/input_error.hpp"
#include "scenarios/experiments/precision/measure.hpp"
#include "scenarios/experiments/precision/study.hpp"
#include "scenarios/run/assemble.hpp"

namespace hapbench {
namespace {

/// Keeps the stiffness tensor of the first row.
class FirstTensor final : public Observer {
 public:
  void on_step(const StepRecord& record) noexcept override {
    if (record.step == 0) S = record.force.S;
  }
  Mat3 S = Mat3::Zero();
};

/// Positions at t = 0, T, 2 T, … of M x'' = -K S x - B S x' - F (I - S) x', which is what bilateral springs whose
/// weights are constant obey; from the matrix exponential, exact to rounding.
std::vector<Vec3> exact_positions(const Scenario& scenario, const Mat3& S, double T, std::size_t samples) {
  const RenderingFields& r = scenario.rendering;
  const double K = r.config.stiffness, M = *r.mass;
  const double B = r.config.damping.value_or(2.0 * r.config.damping_ratio * std::sqrt(K * M));
  Eigen::Matrix<double, 6, 6> A = Eigen::Matrix<double, 6, 6>::Zero();
  A.topRightCorner<3, 3>() = Mat3::Identity();
  A.bottomLeftCorner<3, 3>() = -K / M * S;
  A.bottomRightCorner<3, 3>() = -(B * S + *r.mu_s * (Mat3::Identity() - S)) / M;
  const Eigen::Matrix<double, 6, 6> advance = (A * T).exp();
  Eigen::Matrix<double, 6, 1> state;
  state << scenario.initial.position, scenario.initial.velocity;
  std::vector<Vec3> positions;
  for (std::size_t i = 0; i < samples; ++i) {
    positions.emplace_back(state.head<3>());
    state = advance * state;
  }
  return positions;
}

void check_scenario(const Scenario& scenario) {
  const auto* springs = std::get_if<SpringsEnvironment>(&scenario.environment);
  const RenderingFields& r = scenario.rendering;
  const bool linear = springs != nullptr && springs->bilateral && *r.mu_f == 0.0 && !r.config.max_damping &&
                      !r.config.max_force && !*r.reduction && std::holds_alternative<NoHandFields>(scenario.hand);
  if (linear) return;
  throw InputError("the study needs a linear scenario: bilateral springs without hand, reduction, limits and mu_f");
}

/// Coarsest step over the others: three decades.
constexpr int kDivisions[] = {1, 2, 5, 10, 20, 50, 100, 200, 500, 1000};

}  // namespace

PrecisionResult study_integrators(const Scenario& scenario, const PrecisionOptions& options) {
  check_scenario(scenario);
  FirstTensor tensor;
  sampled_run(scenario, nullptr, 1, {&tensor});
  const double T = scenario.time.step;
  const auto samples = static_cast<std::size_t>(*scenario.time.steps);
  const std::vector<Vec3> exact = exact_positions(scenario, tensor.S, T, samples);

  PrecisionResult result;
  result.columns = {"step_s", "error_final_m", "error_rms_m", "error_max_m"};
  result.timed = "step";
  std::vector<double> steps, errors;
  for (const int division : kDivisions) {
    Scenario run = scenario;
    run.time.step = T / division;
    run.time.steps = static_cast<std::int64_t>(samples) * division;
    const SampledRun sampled = sampled_run(run, nullptr, static_cast<std::uint64_t>(division));
    const TrajectoryDistance d = distance(sampled.positions, exact);
    const bool whole = sampled.positions.size() == samples;
    const auto if_whole = [whole](double value) { return whole ? std::optional(value) : std::nullopt; };
    result.rows.push_back({fmt::format("leapfrog dt={}", run.time.step),
                           std::string(outcome_name(sampled.result.outcome)),
                           {run.time.step, if_whole(d.final), if_whole(d.rms), if_whole(d.max)},
                           seconds_per_step(run, nullptr, options.repetitions)});
    steps.push_back(run.time.step);
    errors.push_back(whole ? d.rms : 0.0);
    options.progress(result.rows.size(), std::size(kDivisions));
  }
  result.orders.push_back({"leapfrog", "error_rms_m", fitted_order(steps, errors)});
  return result;
}

}  // namespace hapbench
