#include "scenarios/scene/scenario.hpp"

#include "algorithms/registry.hpp"

namespace hapbench {

Scenario::Scenario() = default;
Scenario::Scenario(const Scenario&) = default;
Scenario::Scenario(Scenario&&) noexcept = default;
Scenario& Scenario::operator=(const Scenario&) = default;
Scenario& Scenario::operator=(Scenario&&) noexcept = default;
Scenario::~Scenario() = default;

double drag_length(const DragHandFields& hand, double duration) {
  if (!hand.path) return hand.drag.speed * duration;
  double length = 0.0;
  for (std::size_t i = 1; i < hand.path->size(); ++i) length += ((*hand.path)[i] - (*hand.path)[i - 1]).norm();
  return length;
}

bool records_rows(const RecordFields& record) {
  return record.trajectory || !record.ratio_iterations.empty() || record.contacts || record.stiffness_tensor ||
         record.energy || record.ideal_trajectory || record.force_reference || record.six_dof;
}

double trial_count(const HandFields& hand) {
  const auto* tracking = std::get_if<TrackingHandFields>(&hand);
  return tracking == nullptr ? 1.0
                             : static_cast<double>(tracking->subjects.size()) * static_cast<double>(tracking->trials);
}

std::optional<double> input_force_limit(const DeviceFields& device) {
  if (const auto* ideal = std::get_if<IdealDeviceFields>(&device)) return ideal->force_limit;
  const auto* admittance = std::get_if<AdmittanceDeviceConfig>(&device);
  return admittance != nullptr ? admittance->force_limit : std::nullopt;
}

bool has_external_contacts(const Scenario& scenario) {
  return scenario.rendering.contact_source != kComputedContacts;
}

Scenario with_algorithm(Scenario scenario, std::string_view algorithm) {
  scenario.rendering.algorithm = algorithm;
  scenario.rendering = with_fixed_stages(scenario.rendering);
  return scenario;
}

}  // namespace hapbench
