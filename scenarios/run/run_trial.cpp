#include "scenarios/run/run_trial.hpp"

#include <sys/resource.h>

#include <chrono>

#include "results/allocations/allocations.hpp"
#include "results/observe/step_times.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/run/drag_course.hpp"
#include "scenarios/run/encounter.hpp"
#include "scenarios/run/open_edges.hpp"
#include "scenarios/run/progress.hpp"
#include "scenarios/run/run_to_end.hpp"
#include "scenarios/run/stop_signal.hpp"

namespace hapbench {
namespace {

/// None where the position is prescribed or a handle moves the tool: no integrator does.
std::optional<double> friction_limit(const Scenario& scenario, const Motion& motion) {
  if (!motion.position_is_free() || handle_moves_tool(scenario.device)) return std::nullopt;
  const RenderingConfig& rendering = scenario.rendering;
  return explicit_friction_limit(*scenario.integrator.type, rendering.mass, scenario.time.step, rendering.mu_s,
                                 rendering.mu_f);
}

MetricsConfig metrics_config(const Scenario& scenario, const SimulationParts& parts) {
  MetricsConfig config;
  config.friction_limit = friction_limit(scenario, *parts.motion);
  config.settling = scenario.metrics;
  if (scenario.rendering.reduction) config.most_reduced = parts.source->capacity();
  return config;
}

/// The force that the rendered one is compared with: ideal, or measured with a stroke; null without.
std::shared_ptr<const ReferenceForce> reference_force(const Scenario& scenario, const NamedFiles& files) {
  if (scenario.reference_force) return std::make_shared<const ReferenceForce>(scenario.reference_force->force);
  if (!std::holds_alternative<RecordedPosition>(scenario.motion.position)) return nullptr;
  auto force = files.recorded_force();
  if (!force && scenario.record.force_reference)
    throw InputError("/record/force_reference: got true; allowed: false, because the stroke has no measured force");
  return force;
}

/// The observers of a trial: only those that the scenario asks for.
class TrialObservers {
 public:
  TrialObservers(const Scenario& scenario, const NamedFiles& files, const SimulationParts& parts, Trial trial)
      : tool_(parts.tool),
        metrics_(scenario.time.step, metrics_config(scenario, parts)),
        passivity_(scenario.time.step),
        sections_({.scenario = scenario,
                   .simulation = parts,
                   .reference = reference_force(scenario, files),
                   .subject = trial.subject,
                   .trial = trial.number}) {
    observers_.push_back(&metrics_);
    observers_.push_back(&passivity_);
    for (const auto& observer : sections_.all()) observers_.push_back(observer.get());
    if (parts.shell && parts.shell->size() > 0) {
      approach_.emplace(parts.shell->bounds());
      observers_.push_back(&*approach_);
      // Needs shell indices; FCL and Bullet contacts have none.
      if (std::holds_alternative<MeshEnvironment>(scenario.environment) &&
          scenario.rendering.contact_source == kOwnContacts && !files.mesh().open_edges().empty()) {
        open_edges_.emplace(*parts.shell, files.mesh().open_edges(), parts.tool->half_width());
        observers_.push_back(&*open_edges_);
      }
    }
    if (const auto* hand = dynamic_cast<const DragHand*>(parts.hand.get())) {
      drag_.emplace(*hand, std::get<DragHandFields>(scenario.hand), parts.tool->half_width());
      observers_.push_back(&*drag_);
    }
  }

  /// Adds recorders for what the scenario asks for. Throws IoError.
  void record(const RecordFields& fields, const RecordTarget& target, std::size_t contact_capacity) {
    recorders_ = make_recorders({fields, contact_capacity, sections_}, target);
    for (const auto& recorder : recorders_) observers_.push_back(recorder.get());
  }

  void add(Observer& observer) { observers_.push_back(&observer); }
  const std::vector<Observer*>& all() const { return observers_; }

  /// Moves the results and the recorders into `out`.
  void finish(const Scenario& scenario, TrialResult& out) {
    out.tool = tool_;
    out.metrics = metrics_.metrics();
    if (approach_ && out.result.outcome == Outcome::completes) {
      Encounter encounter{out.metrics, approach_->approach(), approach_->environment(), *tool_};
      if (drag_) encounter.drag = drag_->course();
      out.result.outcome = outcome_of(scenario, encounter);
      if (auto warning = warning_about(scenario, out.result.outcome, encounter)) out.warnings.push_back(*warning);
    }
    if (drag_) {
      for (std::string& warning : drag_warnings(drag_->course())) out.warnings.push_back(std::move(warning));
    }
    if (approach_) {
      if (auto warning = scale_warning(scenario, *tool_, approach_->environment())) out.warnings.push_back(*warning);
    }
    if (open_edges_ && open_edges_->warning()) out.warnings.push_back(*open_edges_->warning());
    out.passivity = passivity_.metrics();
    out.sections = std::move(sections_);
    out.recorders = std::move(recorders_);
  }

 private:
  std::shared_ptr<const ToolShape> tool_;
  MetricsObserver metrics_;
  PassivityObserver passivity_;
  SectionObservers sections_;
  std::optional<ApproachObserver> approach_;
  std::optional<OpenEdgeObserver> open_edges_;
  std::optional<DragCourseObserver> drag_;
  std::vector<std::unique_ptr<Recorder>> recorders_;
  std::vector<Observer*> observers_;
};

/// As run_to_end, every step timed.
SimulationResult run_timed(Simulation& simulation, StepTimes& times) {
  times.start();
  for (bool more = true; more;) {
    throw_if_stopped();
    for (std::uint64_t i = 0; i < kAskEvery && (more = simulation.step()); ++i) times.lap();
  }
  throw_if_stopped();
  return simulation.result();
}

/// Number of involuntary context switches of this process so far.
std::uint64_t involuntary_context_switches() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_nivcsw);
}

}  // namespace

TrialResult run_trial(const Scenario& scenario, std::shared_ptr<const PointShell> shell, Trial trial,
                      const TrialOptions& options) {
  const NamedFiles files = options.files ? *options.files : NamedFiles(scenario);
  SimulationParts parts = assemble(scenario, files, std::move(shell), trial);
  TrialObservers observers(scenario, files, parts, trial);
  if (options.target) observers.record(scenario.record, *options.target, parts.source->capacity());
  Progress bar(options.label, static_cast<std::uint64_t>(scenario.time.steps), !options.label.empty());
  observers.add(bar);
  StepSampler sampler(static_cast<std::uint64_t>(scenario.time.steps));
  std::vector<Observer*> all = observers.all();
  all.insert(all.begin(), &sampler.first());
  all.push_back(&sampler.last());
  Simulation simulation(simulation_config(scenario), std::move(parts), std::move(all));

  TrialResult out;
  const std::uint64_t allocations_before = heap_allocations();
  const std::uint64_t preemptions_before = involuntary_context_switches();
  const auto start = std::chrono::steady_clock::now();
  out.result = options.times != nullptr ? run_timed(simulation, *options.times) : run_to_end(simulation);
  out.loop_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  out.preemptions = involuntary_context_switches() - preemptions_before;
  out.work.allocations = heap_allocations() - allocations_before;
  out.work.search = simulation.source().work();
  out.work.steps_skipped = out.work.search.skipped;
  out.work.algorithm = simulation.algorithm().work();
  out.work.search += out.work.algorithm.search;
  out.step_nanoseconds.assign(sampler.nanoseconds().begin(), sampler.nanoseconds().end());
  observers.finish(scenario, out);
  return out;
}

}  // namespace hapbench
