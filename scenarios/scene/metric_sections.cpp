#include "scenarios/scene/metric_sections.hpp"

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <variant>

#include "results/observe/contact_metrics.hpp"
#include "results/observe/energy.hpp"
#include "results/observe/ideal_trajectory.hpp"
#include "results/observe/target_metrics.hpp"
#include "scenarios/scene/named_files.hpp"
#include "scenarios/scene/six_dof_observer.hpp"

namespace hapbench {
namespace {

/// A section of the summary: its name, the condition under which a run has it, and its observer.
struct SectionKind {
  const char* name;
  const char* condition;  ///< the condition in words, after "only"; empty if every run has the section
  /// Returns the number of target positions, or 1 for a section that has no target positions. Returns 0 if the
  /// scenario does not request the section.
  std::size_t (*parts)(const Scenario& scenario, bool has_reference_force);
  /// Returns the observer of a run of the scenario. If `scenario` is null, returns an observer that is only used to
  /// list the metrics.
  std::unique_ptr<MetricObserver> (*observe)(const Scenario* scenario, std::size_t parts);
  bool merges = false;  ///< true if the section can be computed over several trials
};

template <class Type>
std::unique_ptr<MetricObserver> make(const Scenario*, std::size_t) {
  return std::make_unique<Type>();
}

std::unique_ptr<MetricObserver> observe_ideal_trajectory(const Scenario* scenario, std::size_t) {
  if (scenario == nullptr) return std::make_unique<IdealTrajectoryObserver>();
  return std::make_unique<IdealTrajectoryObserver>(std::get<BlockEnvironment>(scenario->environment).block, Cylinder(),
                                                   static_cast<std::uint64_t>(scenario->record.every));
}

std::unique_ptr<MetricObserver> observe_six_dof(const Scenario* scenario, std::size_t) {
  if (scenario == nullptr) return std::make_unique<SixDofObserver>();
  return std::make_unique<SixDofObserver>(*scenario);
}

std::unique_ptr<MetricObserver> observe_targets(const Scenario*, std::size_t target_positions) {
  return std::make_unique<TargetMetricsObserver>(target_positions);
}

std::size_t target_positions(const Scenario& scenario, bool) {
  const auto* hand = std::get_if<TrackingHandFields>(&scenario.hand);
  return hand == nullptr ? 0 : hand->task.positions.size();
}

/// All sections, in the order of the summary. To add a section, add an entry here and a source file with its
/// observer.
const SectionKind kSections[] = {
    {"passivity", "", [](const Scenario&, bool) { return std::size_t{1}; }, make<PassivityObserver>, true},
    {"energy", "with record.energy", [](const Scenario& s, bool) { return std::size_t{s.record.energy}; },
     make<EnergyLedger>},
    {"ideal_trajectory", "with record.ideal_trajectory",
     [](const Scenario& s, bool) { return std::size_t{s.record.ideal_trajectory}; }, observe_ideal_trajectory},
    {"fidelity", "with reference_force, or with a stroke that has a measured force",
     [](const Scenario&, bool has_reference) { return std::size_t{has_reference}; }, make<ForceFidelityObserver>},
    {"six_dof", "with six_dof", [](const Scenario& s, bool) { return std::size_t{s.six_dof.has_value()}; },
     observe_six_dof},
    {"torque", "with record.torque", [](const Scenario& s, bool) { return std::size_t{s.record.torque}; },
     make<LostTorqueObserver>},
    {"friction", "with rendering.friction of type \"dry\"",
     [](const Scenario& s, bool) { return std::size_t{s.rendering.dry_friction.has_value()}; }, make<FrictionObserver>},
    {"force_stage", "with rendering.force_stage",
     [](const Scenario& s, bool) { return std::size_t{s.rendering.force_stage.has_value()}; },
     make<ForceStageObserver>},
    {"contacts", "with rendering.contacts of several rates (every above 1, a delay or a dropout)",
     [](const Scenario& s, bool) { return std::size_t{has_multi_rate_contacts(s)}; }, make<ContactAgeObserver>},
    {"targets", "with a hand of type \"tracking\" that has this target position", target_positions, observe_targets,
     true}};

/// Adds the metrics that every run has. `inside` is null if the environment has no solid.
void report_common_metrics(const MetricsObserver& metrics, const InsideDepths* inside, MetricList& list) {
  Section section(list, "");
  metrics.report(section);
  (inside != nullptr ? *inside : InsideDepths()).report(section, metrics.has_settled());
  metrics.report_end(section);
}

/// Returns the common metrics and the metrics of the sections, without values. `parts(kind)` returns the number of
/// parts of a section, as defined at SectionKind::parts. A section with 0 parts is skipped.
template <class Parts>
MetricList list_without_values(const Parts& parts) {
  MetricList metrics;
  report_common_metrics(MetricsObserver(1.0), nullptr, metrics);
  for (const SectionKind& kind : kSections) {
    const std::size_t count = parts(kind);
    if (count == 0) continue;
    Section section(metrics, kind.name);
    kind.observe(nullptr, count)->report(section);
  }
  for (Metric& metric : metrics) metric.value = {};
  return metrics;
}

}  // namespace

MetricList metrics_without_values(const Scenario& scenario, bool has_reference_force) {
  const bool is_one_trial = trial_count(scenario.hand) == 1.0;
  return list_without_values([&](const SectionKind& kind) {
    return is_one_trial || kind.merges ? kind.parts(scenario, has_reference_force) : 0;
  });
}

MetricList metrics_without_values(const LoadedScenario& loaded) {
  const Scenario& scenario = loaded.scenario;
  const bool is_recorded = std::holds_alternative<RecordedPosition>(scenario.motion.position);
  return metrics_without_values(
      scenario, scenario.reference_force || (is_recorded && loaded.files.at(kMotionFile).stroke()->force));
}

MetricList metrics_without_values(std::size_t target_positions) {
  return list_without_values([target_positions](const SectionKind&) { return target_positions; });
}

const MetricList& all_metrics() {
  static const MetricList all = metrics_without_values(2);
  return all;
}

std::string condition_of_metric(std::string_view metric) {
  const std::string_view section = metric.substr(0, metric.find('.'));
  for (const SectionKind& kind : kSections)
    if (section != metric && section == kind.name)
      return std::string(kind.condition) + (kind.merges ? "" : ", in a run of a single trial");
  return "";
}

SectionObservers::SectionObservers(const Scenario& scenario, bool has_reference_force) {
  for (std::size_t i = 0; i < std::size(kSections); ++i) {
    const std::size_t parts = kSections[i].parts(scenario, has_reference_force);
    if (parts == 0) continue;
    observers_.push_back(kSections[i].observe(&scenario, parts));
    kinds_.push_back(i);
  }
}

void SectionObservers::begin(const TrialParts& trial) {
  ++trials_;
  for (const auto& observer : observers_) observer->begin(trial);
}

void SectionObservers::report(const MetricsObserver& metrics, const InsideDepths* inside, Result& result) const {
  report_common_metrics(metrics, inside, result.metrics);
  for (std::size_t i = 0; i < observers_.size(); ++i) {
    const SectionKind& kind = kSections[kinds_[i]];
    if (trials_ > 1 && !kind.merges) continue;
    // Add the section's metrics. Then add the section's JSON members that are not metrics.
    Section section(result.metrics, kind.name);
    observers_[i]->report(section);
    observers_[i]->add_members(result.sections[kind.name] = nlohmann::ordered_json::object());
  }
}

}  // namespace hapbench
