#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <unsupported/Eigen/MatrixFunctions>

#include "algorithms/stages/damping_and_limits.hpp"
#include "results/summary/summary.hpp"
#include "sim/loop/integrators/table.hpp"
#include "tests/bench/accuracy/accuracy.hpp"

namespace hapbench::accuracy {
namespace {

/// The scene's time step is divided by these: three decades.
constexpr int kDivisions[] = {1, 2, 5, 10, 20, 50, 100, 200, 500, 1000};

/// Keeps the tensor of the first row, which springs never change.
class FirstTensor final : public Observer {
 public:
  void on_step(const StepRecord& record) noexcept override {
    if (record.step == 0) S = record.force.S;
  }
  Mat3 S = Mat3::Zero();
};

struct Exact {
  Mat3 S;
  std::vector<Vec3> positions;  ///< at the steps of the scene [m]
};

/// M x'' = -K S x - B S x' - F (I - S) x', the equation of bilateral springs with constant weights, by the matrix
/// exponential: exact to rounding.
Exact exact_solution(const Scenario& scenario) {
  FirstTensor first;
  sampled_run(scenario, nullptr, 1, {&first});
  const Mat3& S = first.S;
  const RenderingConfig& r = scenario.rendering;
  const double K = r.stiffness, M = r.mass, B = normal_damping(r);
  Eigen::Matrix<double, 6, 6> A = Eigen::Matrix<double, 6, 6>::Zero();
  A.topRightCorner<3, 3>() = Mat3::Identity();
  A.bottomLeftCorner<3, 3>() = -K / M * S;
  A.bottomRightCorner<3, 3>() = -(B * S + r.mu_s * (Mat3::Identity() - S)) / M;
  const Eigen::Matrix<double, 6, 6> advance = (A * scenario.time.step).exp();
  Eigen::Matrix<double, 6, 1> state;
  state << scenario.initial.position, scenario.initial.velocity;
  Exact exact{S, {}};
  for (std::int64_t i = 0; i < scenario.time.steps; ++i) {
    exact.positions.emplace_back(state.head<3>());
    state = advance * state;
  }
  return exact;
}

/// The mechanical energy of a run on springs of constant S, without the contacts: M v^2 / 2 + K p S p / 2.
class SpringEnergy final : public Observer {
 public:
  SpringEnergy(const RenderingConfig& rendering, const Mat3& S) : K_(rendering.stiffness), M_(rendering.mass), S_(S) {}
  void on_step(const StepRecord& record) noexcept override {
    const Vec3& p = record.tool.pose.position;
    const double energy = 0.5 * (M_ * record.tool.velocity.squaredNorm() + K_ * p.dot(S_ * p));
    if (record.step == 0) first_ = energy;
    last_ = energy;
    largest_ = std::max(largest_, std::abs(energy - first_));
  }
  /// (E_end - E_0) / E_0 and the largest |E - E_0| / E_0.
  double gain() const { return (last_ - first_) / first_; }
  double swing() const { return largest_ / first_; }

 private:
  double K_, M_;
  Mat3 S_;
  double first_ = 0.0, last_ = 0.0, largest_ = 0.0;
};

Errors errors_of(const Scenario& run, int division, const Exact& exact) {
  const SampledRun sampled = sampled_run(run, nullptr, static_cast<std::uint64_t>(division));
  const Distance d = distance(sampled.positions, exact.positions);
  const bool whole = sampled.positions.size() == exact.positions.size();
  Scenario undamped = run;
  undamped.rendering.damping = undamped.rendering.mu_s = 0.0;
  SpringEnergy energy(run.rendering, exact.S);
  const bool kept = sampled_run(undamped, nullptr, 1, {&energy}).result.outcome == Outcome::completes;
  return {std::string(outcome_name(sampled.result.outcome)),
          {{"step_s", run.time.step},
           {"error_final_m", if_any(whole, d.final)},
           {"error_rms_m", if_any(whole, d.rms)},
           {"error_max_m", if_any(whole, d.max)},
           {"undamped_energy_gain_relative", if_any(kept, energy.gain())},
           {"undamped_energy_swing_relative", if_any(kept, energy.swing())}}};
}

}  // namespace

Panel integrators(const Scenario& springs) {
  const auto exact = once([springs] { return exact_solution(springs); });
  Panel panel;
  for (const IntegratorEntry* integrator : kIntegrators) {
    for (const int division : kDivisions) {
      Scenario run = springs;
      run.integrator.type = integrator;
      run.time.step = springs.time.step / division;
      run.time.steps = springs.time.steps * division;
      panel.push_back({fmt::format("integrators/{} dt={}", integrator->info.name, run.time.step), "step",
                       [=] { return errors_of(run, division, exact()); }, [=] { return bare_run(run, nullptr); }});
    }
  }
  return panel;
}

}  // namespace hapbench::accuracy
