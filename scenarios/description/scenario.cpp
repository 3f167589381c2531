#include "scenarios/description/scenario.hpp"

#include "algorithms/registry.hpp"
#include "scenarios/description/parts.hpp"
#include "sim/core/random.hpp"

namespace hapbench {

bool records_rows(const RecordFields& record) {
  return record.trajectory || !record.ratio_iterations.empty() || record.contacts || record.stiffness_tensor ||
         record.energy || record.ideal_trajectory || record.force_reference;
}

double trial_count(const HandFields& hand) {
  const auto* tracking = std::get_if<TrackingHandFields>(&hand);
  return tracking == nullptr ? 1.0
                             : static_cast<double>(tracking->subjects.size()) * static_cast<double>(tracking->trials);
}

const ImpedanceHandFields* spring_of(const HandFields& hand) {
  const auto* passive = std::get_if<MassSpringDamperHandFields>(&hand);
  return passive != nullptr ? &passive->spring : std::get_if<ImpedanceHandFields>(&hand);
}

bool position_is_free(const MotionFields& motion) {
  return std::holds_alternative<FreePosition>(motion.position);
}

bool handle_moves_tool(const DeviceFields& device) {
  return std::holds_alternative<ImpedanceDeviceConfig>(device);
}

std::optional<double> input_force_limit(const DeviceFields& device) {
  if (const auto* ideal = std::get_if<IdealDeviceFields>(&device)) return ideal->force_limit;
  const auto* admittance = std::get_if<AdmittanceDeviceConfig>(&device);
  return admittance != nullptr ? admittance->force_limit : std::nullopt;
}

std::filesystem::path resolve_path(const Scenario& scenario, const std::string& file) {
  return scenario.directory / file;  // an absolute `file` replaces the directory
}

std::uint64_t derived_seed(const Scenario& scenario, Trial trial, RandomUse use) {
  std::uint64_t seed = static_cast<std::uint64_t>(scenario.seed);
  for (const std::uint64_t part :
       {static_cast<std::uint64_t>(use), std::uint64_t{trial.subject}, std::uint64_t{trial.number}}) {
    seed = Random::derive(seed ^ (seed >> 29), part);
  }
  return seed;
}

Scenario with_algorithm(Scenario scenario, std::string_view algorithm) {
  scenario.rendering.algorithm = algorithm;
  scenario.rendering = with_fixed_stages(scenario.rendering);
  return scenario;
}

}  // namespace hapbench
