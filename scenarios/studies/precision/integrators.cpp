#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <unsupported/Eigen/MatrixFunctions>

#include "algorithms/stages/damping_and_limits.hpp"
#include "results/summary/outcome_names.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/studies/precision/measure.hpp"

namespace hapbench {
namespace {

/// Positions at t = 0, T, 2 T, … of M x'' = -K S x - B S x' - F (I - S) x', the equation of bilateral springs with
/// constant weights; from the matrix exponential, exact to rounding.
std::vector<Vec3> exact_positions(const Scenario& scenario, const Mat3& S, double T, std::size_t samples) {
  const RenderingConfig& r = scenario.rendering;
  const double K = r.stiffness, M = r.mass, B = normal_damping(r);
  Eigen::Matrix<double, 6, 6> A = Eigen::Matrix<double, 6, 6>::Zero();
  A.topRightCorner<3, 3>() = Mat3::Identity();
  A.bottomLeftCorner<3, 3>() = -K / M * S;
  A.bottomRightCorner<3, 3>() = -(B * S + r.mu_s * (Mat3::Identity() - S)) / M;
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
  const RenderingConfig& r = scenario.rendering;
  const bool linear = springs != nullptr && springs->bilateral && springs->signed_depths && r.mu_f == 0.0 &&
                      !r.dry_friction && !r.hunt_crossley && !r.late && !r.max_damping && !r.max_force &&
                      !r.reduction && !r.passivity_controller && std::holds_alternative<NoHandFields>(scenario.hand) &&
                      std::holds_alternative<FreePosition>(scenario.motion.position);
  if (linear) return;
  throw InputError(
      "the study needs a linear scenario: signed bilateral springs and a free position, without hand, reduction, limits, mu_f "
      "and passivity controller");
}

/// The study's time steps are the coarsest one divided by these: three decades.
constexpr int kDivisions[] = {1, 2, 5, 10, 20, 50, 100, 200, 500, 1000};
/// Errors below this share of the largest displacement are rounding errors and say nothing about the order.
constexpr double kRounding = 1e-10;

/// The mechanical energy of a run on springs of constant S, without the contacts: M v^2 / 2 + K p S p / 2.
class SpringEnergy final : public Observer {
 public:
  SpringEnergy(const Scenario& scenario, const Mat3& S)
      : K_(scenario.rendering.stiffness), M_(scenario.rendering.mass), S_(S) {}

  void on_step(const StepRecord& record) noexcept override {
    const Vec3& p = record.tool.pose.position;
    const double energy = 0.5 * (M_ * record.tool.velocity.squaredNorm() + K_ * p.dot(S_ * p));
    if (record.step == 0) first_ = energy;
    last_ = energy;
    largest_ = std::max(largest_, std::abs(energy - first_));
  }
  /// (E_end - E_0) / E_0 and the largest |E - E_0| / E_0; empty for a run that begins without energy.
  std::optional<double> gain() const { return share(last_ - first_); }
  std::optional<double> swing() const { return share(largest_); }

 private:
  std::optional<double> share(double energy) const {
    return first_ > 0.0 ? std::optional(energy / first_) : std::nullopt;
  }

  double K_, M_;
  Mat3 S_;
  double first_ = 0.0, last_ = 0.0, largest_ = 0.0;
};

Scenario undamped(Scenario scenario) {
  scenario.rendering.damping = 0.0;
  scenario.rendering.mu_s = 0.0;
  return scenario;
}

PrecisionRow measure(const Scenario& run, int division, const Mat3& S, const std::vector<Vec3>& exact,
                     int repetitions) {
  const SampledRun sampled = sampled_run(run, nullptr, static_cast<std::uint64_t>(division));
  const TrajectoryDistance d = distance(sampled.positions, exact);
  const auto if_whole = [&](std::optional<double> value) {
    return sampled.positions.size() == exact.size() ? value : std::nullopt;
  };
  SpringEnergy energy(run, S);
  const bool kept = sampled_run(undamped(run), nullptr, 1, {&energy}).result.outcome == Outcome::completes;
  return {fmt::format("{} dt={}", run.integrator.type->info.name, run.time.step),
          std::string(outcome_name(sampled.result.outcome)),
          {run.time.step, if_whole(d.final), if_whole(d.rms), if_whole(d.max), kept ? energy.gain() : std::nullopt,
           kept ? energy.swing() : std::nullopt},
          seconds_per_step(run, nullptr, repetitions)};
}

/// The order of the rows from `begin` on, without those whose error is rounding.
ObservedOrder order_of(const IntegratorEntry& integrator, const PrecisionResult& result, std::size_t begin,
                       double rounding) {
  constexpr std::size_t kStep = 0, kRms = 2;
  std::vector<double> steps, errors;
  for (std::size_t i = begin; i < result.rows.size(); ++i) {
    const double error = result.rows[i].values[kRms].value_or(0.0);
    steps.push_back(*result.rows[i].values[kStep]);
    errors.push_back(error > rounding ? error : 0.0);
  }
  return {integrator.info.name, result.columns[kRms], observed_order(steps, errors)};
}

}  // namespace

static PrecisionResult study_integrators(const Scenario& scenario, const PrecisionOptions& options) {
  check_scenario(scenario);
  Mat3 S = Mat3::Zero();
  OnEachRow first_row([&S](const StepRecord& record) {
    if (record.step == 0) S = record.force.S;
  });
  sampled_run(scenario, nullptr, 1, {&first_row});
  const double T = scenario.time.step;
  const auto samples = static_cast<std::size_t>(scenario.time.steps);
  const std::vector<Vec3> exact = exact_positions(scenario, S, T, samples);

  double reach = 0.0;
  for (const Vec3& position : exact) reach = std::max(reach, position.norm());

  PrecisionResult result;
  result.columns = {"step_s",
                    "error_final_m",
                    "error_rms_m",
                    "error_max_m",
                    "undamped_energy_gain_relative",
                    "undamped_energy_swing_relative"};
  result.timed = "step";
  for (const IntegratorEntry* integrator : kIntegrators) {
    const std::size_t begin = result.rows.size();
    for (const int division : kDivisions) {
      Scenario run = scenario;
      run.integrator.type = integrator;
      run.time.step = T / division;
      run.time.steps = static_cast<std::int64_t>(samples) * division;
      result.add(measure(run, division, S, exact, options.repetitions), options,
                 kIntegrators.size() * std::size(kDivisions));
    }
    result.orders.push_back(order_of(*integrator, result, begin, kRounding * reach));
  }
  return result;
}

const PrecisionStudy kIntegratorsStudy = {
    "integrators", "every integrator on springs against the exact solution, over the time step; energy without damping",
    "springs_oscillation", study_integrators};

}  // namespace hapbench
