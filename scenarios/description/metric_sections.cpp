#include "scenarios/description/metric_sections.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "results/observe/contact_metrics.hpp"
#include "results/observe/energy_ledger.hpp"
#include "results/observe/force_fidelity.hpp"
#include "results/observe/force_stages.hpp"
#include "results/observe/ideal_trajectory.hpp"
#include "results/observe/target_metrics.hpp"

namespace hapbench {
namespace {

using Trials = std::span<const Observer* const>;

/// A section of the summary.
struct SectionKind {
  const char* name;
  /// Number of target places, 1 for sections without places; 0 when the scenario does not ask for the section.
  std::size_t (*parts)(const Scenario& scenario, bool has_reference_force);
  std::unique_ptr<Observer> (*observe)(const TrialParts& parts);
  MetricSection (*summarise)(const char* name, Trials trials);
  MetricList (*without_values)(std::size_t parts);
  bool merges = false;  ///< several trials have it, too
};

/// The section of an observer with `metrics`, of whose type there is a metric_list and, if the section has more than
/// metrics, events_json.
template <class Type>
MetricSection summary_of_one(const char* name, Trials trials) {
  const auto metrics = static_cast<const Type&>(*trials.front()).metrics();
  MetricSection section{name, metric_list(metrics), nlohmann::ordered_json::object()};
  if constexpr (requires { events_json(metrics); }) section.more["events"] = events_json(metrics);
  return section;
}

template <class Type>
MetricList list_without_values(std::size_t) {
  return metric_list(decltype(std::declval<const Type&>().metrics()){});
}

std::unique_ptr<Observer> observe_energy(const TrialParts& p) {
  return std::make_unique<EnergyLedger>(p.scenario.rendering.mass, p.scenario.time.step,
                                        p.simulation.motion->position_is_free(), p.simulation.source->capacity(),
                                        *p.scenario.integrator.type);
}

std::unique_ptr<Observer> observe_ideal_trajectory(const TrialParts& p) {
  return std::make_unique<IdealTrajectoryObserver>(std::get<BlockEnvironment>(p.scenario.environment).block,
                                                   dynamic_cast<const Cylinder&>(*p.simulation.tool),
                                                   static_cast<std::uint64_t>(p.scenario.record.every));
}

std::unique_ptr<Observer> observe_fidelity(const TrialParts& p) {
  return std::make_unique<ForceFidelityObserver>(*p.reference, p.scenario.time.step,
                                                 static_cast<std::uint64_t>(p.scenario.time.steps));
}

std::unique_ptr<Observer> observe_contacts(const TrialParts& p) {
  return std::make_unique<ContactAgeObserver>(dynamic_cast<const LateContacts&>(*p.simulation.source),
                                              p.scenario.time.step, static_cast<std::uint64_t>(p.scenario.time.steps));
}

std::unique_ptr<Observer> observe_targets(const TrialParts& p) {
  return std::make_unique<TargetMetricsObserver>(p.subject, p.trial, *p.simulation.hand->task());
}

std::size_t target_places(const Scenario& scenario, bool) {
  const auto* hand = std::get_if<TrackingHandFields>(&scenario.hand);
  return hand == nullptr ? 0 : hand->task.places.size();
}

MetricSection summary_of_targets(const char* name, Trials trials) {
  std::vector<TargetRow> rows;
  for (const Observer* trial : trials) {
    const auto& more = static_cast<const TargetMetricsObserver&>(*trial).rows();
    rows.insert(rows.end(), more.begin(), more.end());
  }
  return {name, metric_list(place_metrics(rows)), nlohmann::ordered_json::object()};
}

MetricList targets_without_values(std::size_t places) {
  std::vector<PlaceMetrics> metrics(places);
  for (std::size_t place = 0; place < places; ++place) metrics[place].place = place;
  return metric_list(metrics);
}

/// In the order of the summary. A section is a row here and the file of its observer.
const SectionKind kSections[] = {
    {"energy", [](const Scenario& s, bool) { return std::size_t{s.record.energy}; }, observe_energy,
     summary_of_one<EnergyLedger>, list_without_values<EnergyLedger>},
    {"ideal_trajectory", [](const Scenario& s, bool) { return std::size_t{s.record.ideal_trajectory}; },
     observe_ideal_trajectory, summary_of_one<IdealTrajectoryObserver>, list_without_values<IdealTrajectoryObserver>},
    {"fidelity", [](const Scenario&, bool has_reference) { return std::size_t{has_reference}; }, observe_fidelity,
     summary_of_one<ForceFidelityObserver>, list_without_values<ForceFidelityObserver>},
    {"torque", [](const Scenario& s, bool) { return std::size_t{s.record.torque}; },
     [](const TrialParts&) -> std::unique_ptr<Observer> { return std::make_unique<LostTorqueObserver>(); },
     summary_of_one<LostTorqueObserver>, list_without_values<LostTorqueObserver>},
    {"friction", [](const Scenario& s, bool) { return std::size_t{s.rendering.dry_friction.has_value()}; },
     [](const TrialParts& p) -> std::unique_ptr<Observer> {
       return std::make_unique<FrictionObserver>(p.scenario.time.step);
     },
     summary_of_one<FrictionObserver>, list_without_values<FrictionObserver>},
    {"force_stage", [](const Scenario& s, bool) { return std::size_t{s.rendering.force_stage.has_value()}; },
     [](const TrialParts& p) -> std::unique_ptr<Observer> {
       return std::make_unique<ForceStageObserver>(*p.simulation.algorithm);
     },
     summary_of_one<ForceStageObserver>, list_without_values<ForceStageObserver>},
    {"contacts", [](const Scenario& s, bool) { return std::size_t{s.rendering.late && s.rendering.late->any()}; },
     observe_contacts, summary_of_one<ContactAgeObserver>, list_without_values<ContactAgeObserver>},
    {"targets", target_places, observe_targets, summary_of_targets, targets_without_values, true}};

/// The metrics of every run, without values.
MetricList common_metrics() {
  MetricList metrics = metric_list(RunSummary{});
  for (Metric& metric : metrics) metric.value = {};
  return metrics;
}

}  // namespace

SectionParts sections_of(const Scenario& scenario, bool has_reference_force) {
  SectionParts sections;
  for (const SectionKind& kind : kSections) {
    const std::size_t parts = kind.parts(scenario, has_reference_force);
    if (parts > 0 && (kind.merges || trial_count(scenario.hand) == 1.0)) sections.emplace(kind.name, parts);
  }
  return sections;
}

void add_sections(SectionParts& sections, const SectionParts& more) {
  for (const auto& [name, parts] : more) {
    std::size_t& known = sections[name];
    known = std::max(known, parts);
  }
}

MetricList metrics_without_values(const SectionParts& sections) {
  MetricList metrics = common_metrics();
  for (const SectionKind& kind : kSections) {
    const auto section = sections.find(kind.name);
    if (section != sections.end()) append(metrics, kind.name, kind.without_values(section->second));
  }
  return metrics;
}

std::vector<std::string> metric_names() {
  std::vector<std::string> names;
  for (Metric& metric : metrics_without_values()) names.push_back(std::move(metric.name));
  return names;
}

MetricList metrics_without_values(std::size_t places) {
  MetricList metrics = common_metrics();
  for (const SectionKind& kind : kSections) append(metrics, kind.name, kind.without_values(places));
  for (Metric& metric : metrics) metric.value = {};
  return metrics;
}

SectionObservers::SectionObservers(const TrialParts& parts) : reference_(parts.reference) {
  for (std::size_t i = 0; i < std::size(kSections); ++i) {
    if (kSections[i].parts(parts.scenario, parts.reference != nullptr) == 0) continue;
    observers_.push_back(kSections[i].observe(parts));
    kinds_.push_back(i);
  }
}

std::vector<MetricSection> SectionObservers::summarised(std::span<const SectionObservers* const> trials) {
  std::vector<MetricSection> sections;
  for (std::size_t i = 0; i < trials.front()->observers_.size(); ++i) {
    const SectionKind& kind = kSections[trials.front()->kinds_[i]];
    if (trials.size() > 1 && !kind.merges) continue;
    std::vector<const Observer*> observers;
    for (const SectionObservers* trial : trials) observers.push_back(trial->observers_[i].get());
    sections.push_back(kind.summarise(kind.name, observers));
  }
  return sections;
}

}  // namespace hapbench
