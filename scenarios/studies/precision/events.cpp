#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "results/summary/outcome_names.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/studies/precision/measure.hpp"

/// The energy that a run makes because contacts begin and end between its samples, apart from what the law makes: a
/// free tool without hand, damping and friction against springs keeps its energy, unless law or sampling change it.
/// The law's part is that of the integrator which finds the events inside a step.
namespace hapbench {
namespace {

/// Steps of the rows, in steps of the scene.
constexpr double kStepFactors[] = {4.0, 2.0, 1.0, 0.5, 0.25, 0.125};

/// M v^2 / 2 and what the springs store, at the first and the last row [J], and how often contact began or ended.
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
  std::uint64_t switches() const { return switches_; }

 private:
  double mass_, first_ = 0.0, last_ = 0.0;
  bool touched_ = false;
  std::uint64_t switches_ = 0;
};

Scenario bouncing(Scenario scenario) {
  require_free_position(scenario);
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

static PrecisionResult study_events(const Scenario& given, const PrecisionOptions& options) {
  const Scenario scenario = bouncing(given);
  const auto shell = make_shell(scenario);
  const auto measured = [&](const Scenario& run) {
    MechanicalEnergy energy(run.rendering.mass);
    const SampledRun sampled = sampled_run(run, shell, 1, {&energy});
    return std::pair(sampled, energy);
  };
  const auto [reference_run, reference] = measured(with(scenario, kEvent, kStepFactors[std::size(kStepFactors) - 1]));
  if (!(reference.first() > 0.0))
    throw InputError(InputError::Kind::relation, "/initial/velocity_m_per_s",
                     "the tool is at rest; the study needs one that is thrown at the surface");
  if (!reference_run.in_contact)
    throw InputError("the tool of this scenario touches nothing; the study needs contacts");
  PrecisionResult result;
  result.columns = {"step_s", "created_J", "created_by_sampling_J", "created_share", "contact_on_off"};
  result.timed = "step";
  for (const IntegratorEntry* integrator : kIntegrators) {
    std::vector<double> steps, errors;
    for (const double factor : kStepFactors) {
      const Scenario run = with(scenario, *integrator, factor);
      const auto [sampled, energy] = measured(run);
      const bool complete = sampled.result.outcome != Outcome::diverges;
      const double by_sampling = energy.created() - reference.created();
      const auto if_complete = [&](double value) { return if_any(complete, value); };
      result.add({fmt::format("{} dt={}", integrator->info.name, run.time.step),
                  std::string(outcome_name(sampled.result.outcome)),
                  {run.time.step, if_complete(energy.created()), if_complete(by_sampling),
                   if_complete(energy.created() / reference.first()), static_cast<double>(energy.switches())},
                  seconds_per_step(run, shell, options.repetitions)},
                 options, kIntegrators.size() * std::size(kStepFactors));
      steps.push_back(run.time.step);
      errors.push_back(complete ? std::abs(by_sampling) : 0.0);
    }
    result.orders.push_back({std::string(integrator->info.name), result.columns[2], observed_order(steps, errors)});
  }
  return result;
}

const PrecisionStudy kEventsStudy = {
    "events", "energy that a bounce gains by sampling, beside what its law makes: every integrator, six steps",
    "bounce_plane", study_events};

}  // namespace hapbench
