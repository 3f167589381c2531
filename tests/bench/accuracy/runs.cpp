#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <unsupported/Eigen/MatrixFunctions>

#include "algorithms/registry.hpp"
#include "algorithms/stages/damping_and_limits.hpp"
#include "results/observe/ideal_trajectory.hpp"
#include "results/observe/metrics.hpp"
#include "results/summary/summary.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/scene/environments.hpp"
#include "scenarios/scene/tools.hpp"
#include "scenarios/thesis/claims.hpp"
#include "scenarios/thesis/measurements.hpp"
#include "sim/loop/integrators/table.hpp"
#include "tests/bench/accuracy/accuracy.hpp"
#include "tests/results/observing.hpp"

/// Panels whose settings are runs of a scene.
namespace hapbench::accuracy {
namespace {

/// Divisors of the scene's time step, over three decades.
constexpr int kDivisions[] = {1, 2, 5, 10, 20, 50, 100, 200, 500, 1000};

/// Keeps the stiffness tensor of the first step. For springs, the tensor is constant.
class FirstTensor final : public Observer {
 public:
  void on_step(const StepRecord& record) noexcept override {
    if (record.step == 0) S = record.force.S;
  }
  Mat3 S = Mat3::Zero();
};

struct Exact {
  Mat3 S;
  std::vector<Vec3> positions;  ///< positions at the steps of the scene [m]
};

/// Solves M x'' = -K S x - B S x' - mu_s (I - S) x', the equation of bilateral springs with constant weights, by the
/// matrix exponential: exact to rounding.
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

/// Mechanical energy of a run on springs with constant S, kinetic energy plus spring energy: M v^2 / 2 + K p S p / 2.
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
  /// Return (E_end - E_0) / E_0 and the largest |E - E_0| / E_0.
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
  const bool kept = sampled_run(undamped, nullptr, 1, {&energy}).result.ending == Ending::completed;
  return {std::string(outcome_name(outcome_of(sampled.result.ending))),
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

// Panels of a drill that a hand presses into a hole while the drill rotates.

namespace {

constexpr double kShellSpacings[] = {0.0004, 0.0002, 0.0001, 0.00005, 0.000025};
constexpr std::pair<const char*, Density> kDensities[] = {{"signed_distance", Density::signed_distance},
                                                          {"binary", Density::binary}};

/// Algorithms of the thesis whose angular damping is compared with damping of the tip's velocity alone.
constexpr const char* kAngularlyDamped[] = {"original_averaging", "shaped_stiffness"};

/// Algorithms that create energy while a peg sticks in a hole. The passivity controller does not change other
/// algorithms.
constexpr const char* kCreateEnergy[] = {"original_averaging", "summation", "tandpasta", "normal_projection",
                                         "mcneely"};

/// Returns the deviation from the ideal trajectory and the largest change of the force in a step. The deviation is
/// computed over the steps with a gentle hand force, or over the steps with a firm hand force if no step has a gentle
/// hand force.
Errors off_the_ideal(const Scenario& scenario, std::shared_ptr<const PointShell> shell) {
  IdealTrajectoryObserver ideal(std::get<BlockEnvironment>(scenario.environment).block, make_cylinder(scenario.tool));
  MetricsObserver motion(scenario.time.step);
  const SampledRun run = sampled_run(scenario, std::move(shell), 1, {&ideal, &motion});
  const MetricList metrics = reported(ideal);
  const std::string hand = number_of(metrics, "gentle.rows") > 0.0 ? "gentle." : "firm.";
  const auto error = [&](const char* name) { return number_of(metrics, hand + name).value_or(0.0); };
  return {std::string(outcome_name(outcome_of(run.result.ending))),
          {{"ideal_height_error_rms_m", error("height_error_rms_m")},
           {"ideal_height_error_max_m", std::max(-error("height_error_min_m"), error("height_error_max_m"))},
           {"ideal_lateral_error_rms_m", error("lateral_error_rms_m")},
           {"interpenetration_max_m", error("interpenetration_max_m")},
           {"force_step_max_N", reported(motion, "force_step_max_N").value_or(0.0)}}};
}

}  // namespace

Panel spacing(const Scenario& drill) {
  Panel panel;
  for (const auto& [name, density] : kDensities) {
    for (const double grid : kShellSpacings) {
      Scenario run = drill_in_hole(drill);
      auto& block = std::get<BlockEnvironment>(run.environment);
      block.density = density;
      block.grid = grid;
      const auto shell = once([run] { return make_shell(run); });
      const auto errors = [=] {
        Errors off = off_the_ideal(run, shell());
        off.values.insert(off.values.begin(),
                          {{"spacing_m", grid},
                           {"points", static_cast<double>(shell()->size())},
                           {"shell_bytes", static_cast<double>(shell()->padded_size() * 6 * sizeof(double))}});
        return off;
      };
      panel.push_back(
          {fmt::format("spacing/{} {}", name, grid), "step", errors, [=] { return bare_run(run, shell()); }});
    }
  }
  return panel;
}

Panel algorithms(const Scenario& drill) {
  const Scenario scenario = drill_in_hole(drill);
  const auto shell = once([scenario] { return make_shell(scenario); });
  Panel panel;
  const auto add = [&](const std::string& setting, const RenderingConfig& config) {
    Scenario run = scenario;
    run.rendering = with_fixed_stages(config);
    panel.push_back({"algorithms/" + setting, "step", [=] { return off_the_ideal(run, shell()); },
                     [=] { return bare_run(run, shell()); }});
  };
  RenderingConfig config = scenario.rendering;
  // Angular damping and the passivity controller are off, except in the settings that name them.
  config.angular_damping = config.passivity_controller = false;
  for (const AlgorithmEntry& algorithm : hapbench::algorithms()) {
    config.algorithm = algorithm.info->name;
    add(config.algorithm, config);
  }
  for (const char* algorithm : kAngularlyDamped) {
    config.algorithm = algorithm;
    config.angular_damping = true;
    add(config.algorithm + " + angular_damping", config);
  }
  config.angular_damping = false;
  for (const char* algorithm : kCreateEnergy) {
    config.algorithm = algorithm;
    config.passivity_controller = true;
    add(config.algorithm + " + passivity_controller", config);
  }
  return panel;
}

// Panels of a free tool whose contacts are found too late, either because contacts are searched only in some steps, or
// because a contact begins at a time between two steps.

namespace {

constexpr std::int64_t kQueryEvery[] = {1, 2, 4, 8, 16, 32};
/// Two runs are compared from their start up to this time [s]. Later, the runs differ because the scene is chaotic.
constexpr double kTogether = 0.2;

/// Time steps of the bounce, in units of the scene's time step.
constexpr double kStepFactors[] = {4.0, 2.0, 1.0, 0.5, 0.25, 0.125};

Scenario briefly_free(Scenario scenario) {
  scenario.device = IdealDeviceFields{input_force_limit(scenario.device)};
  scenario.time.steps = std::min<std::int64_t>(scenario.time.steps, std::llround(kTogether / scenario.time.step));
  scenario.record = {};
  return scenario;
}

Errors off_the_fresh(const Scenario& run, const std::shared_ptr<const PointShell>& shell,
                     const std::vector<Vec3>& fresh) {
  MetricsObserver metrics(run.time.step, {});
  const SampledRun late = sampled_run(run, shell, 1, {&metrics});
  const double every = run.rendering.multi_rate ? static_cast<double>(run.rendering.multi_rate->every) : 1.0;
  return {std::string(outcome_name(outcome_of(late.result.ending))),
          {{"rate_Hz", 1.0 / (run.time.step * every)},
           {"error_rms_m", distance(late.positions, fresh).rms},
           {"force_rms_above_30Hz_N", reported(metrics, "force_rms_above_30Hz_N")}}};
}

/// Computes M v^2 / 2 plus the energy stored in the springs in the first and the last step [J], and counts how often
/// contact began or ended.
class MechanicalEnergy final : public Observer {
 public:
  explicit MechanicalEnergy(double mass) : mass_(mass) {}
  bool wants_springs() const noexcept override { return true; }
  void on_step(const StepRecord& record) noexcept override {
    last_ = 0.5 * mass_ * record.tool.velocity.squaredNorm() + record.springs.energy;
    if (record.step == 0) first_ = last_;
    const bool touches = record.colliding > 0;
    switches_ += record.step > 0 && touches != touched_ ? 1 : 0;
    touched_ = touches;
  }
  double first() const { return first_; }
  double created() const { return last_ - first_; }
  double switches() const { return switches_; }

 private:
  double mass_, first_ = 0.0, last_ = 0.0, switches_ = 0.0;
  bool touched_ = false;
};

/// Returns the scenario of a free tool without hand, damping and friction. The tool's energy is constant, unless the
/// law or the sampling changes it.
Scenario bouncing(Scenario scenario) {
  scenario.hand = NoHandFields{};
  scenario.device = IdealDeviceFields{};
  RenderingConfig& r = scenario.rendering;
  r.damping = 0.0;
  r.mu_s = r.mu_f = 0.0;
  r.dry_friction.reset();
  r.hunt_crossley.reset();
  r.passivity_controller = false;
  scenario.record = {};
  return scenario;
}

Scenario with(const Scenario& scenario, const IntegratorEntry& integrator, double factor) {
  Scenario run = with_step(scenario, factor);
  run.integrator.type = &integrator;
  return run;
}

}  // namespace

Panel multi_rate_contacts(const Scenario& free) {
  const Scenario scenario = briefly_free(free);
  const auto shell = once([scenario] { return make_shell(scenario); });
  Panel panel;
  for (const AlgorithmEntry& algorithm : hapbench::algorithms()) {
    Scenario run = with_algorithm(scenario, algorithm.info->name);
    run.rendering.multi_rate.reset();
    const auto fresh = once([=] { return sampled_run(run, shell(), 1).positions; });
    for (const bool linear : {false, true}) {
      for (const std::int64_t every : kQueryEvery) {
        run.rendering.multi_rate = MultiRateSchedule{};
        run.rendering.multi_rate->every = every;
        run.rendering.multi_rate->linear = linear;
        panel.push_back(
            {fmt::format("multi_rate_contacts/{} {} {}", algorithm.info->name, linear ? "linear" : "hold", every),
             "step", [=] { return off_the_fresh(run, shell(), fresh()); }, [=] { return bare_run(run, shell()); }});
      }
    }
  }
  return panel;
}

Panel skips(const Scenario& free) {
  Scenario scenario = briefly_free(free);
  const auto shell = once([scenario] { return make_shell(scenario); });
  const auto fresh = once([=] { return sampled_run(scenario, shell(), 1).positions; });
  Panel panel;
  for (const Skips skips : {Skips::on, Skips::off}) {
    scenario.rendering.skips = skips;
    panel.push_back({skips == Skips::on ? "skips/taken" : "skips/off", "step",
                     [=] { return off_the_fresh(scenario, shell(), fresh()); },
                     [=] { return bare_run(scenario, shell()); }});
  }
  return panel;
}

Panel events(const Scenario& thrown) {
  const Scenario scenario = bouncing(thrown);
  const auto shell = once([scenario] { return make_shell(scenario); });
  const auto measured = [shell](const Scenario& run) {
    MechanicalEnergy energy(run.rendering.mass);
    const Outcome outcome = outcome_of(sampled_run(run, shell(), 1, {&energy}).result.ending);
    return std::pair(outcome, energy);
  };
  // Compute the energy change that the law itself causes, with the integrator that locates events within a step.
  const auto reference =
      once([=] { return measured(with(scenario, kEvent, kStepFactors[std::size(kStepFactors) - 1])).second; });
  Panel panel;
  for (const IntegratorEntry* integrator : kIntegrators) {
    for (const double factor : kStepFactors) {
      const Scenario run = with(scenario, *integrator, factor);
      const auto errors = [=]() -> Errors {
        const auto [outcome, energy] = measured(run);
        const bool complete = outcome != Outcome::diverges;
        return {std::string(outcome_name(outcome)),
                {{"step_s", run.time.step},
                 {"created_J", if_any(complete, energy.created())},
                 {"created_by_sampling_J", if_any(complete, energy.created() - reference().created())},
                 {"created_share", if_any(complete, energy.created() / reference().first())},
                 {"contact_on_off", energy.switches()}}};
      };
      panel.push_back({fmt::format("events/{} dt={}", integrator->info.name, run.time.step), "step", errors,
                       [=] { return bare_run(run, shell()); }});
    }
  }
  return panel;
}

}  // namespace hapbench::accuracy
