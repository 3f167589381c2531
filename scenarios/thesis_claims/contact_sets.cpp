#include "scenarios/thesis_claims/contact_sets.hpp"

#include <cmath>

#include "scenarios/run/assemble.hpp"
#include "scenarios/thesis_claims/evidence.hpp"

namespace hapbench {

Scenario drill_in_hole(Scenario scenario) {
  scenario.device = IdealDeviceFields{input_force_limit(scenario.device)};
  constexpr double kPeriod = 6.0;  // [s], of the tilt of task 2
  const auto rows = static_cast<std::int64_t>(std::llround(kPeriod / scenario.time.step));
  scenario.time.steps = std::min(scenario.time.steps, rows);
  scenario.record = {};
  return scenario;
}

ContactBuffer copy_of(const ContactBuffer& contacts) {
  ContactBuffer copy(contacts.size());
  copy.assign(contacts);
  return copy;
}

std::vector<ContactBuffer> contact_sets(const Scenario& scenario, std::uint64_t stride, Points points) {
  LoadedScenario loaded;
  loaded.scenario = drill_in_hole(scenario);
  if (points == Points::colliding) {
    loaded.scenario.rendering.reduction.reset();
    loaded.scenario.rendering.local_average = false;
  }
  std::vector<ContactBuffer> sets;
  for_each_row(loaded, [&](const StepRecord& row) {
    if (row.step % stride == 0 && !row.rendered->empty()) sets.push_back(copy_of(*row.rendered));
  });
  return sets;
}

ContactBuffer largest_of(const std::vector<ContactBuffer>& sets) {
  return *std::max_element(sets.begin(), sets.end(),
                           [](const ContactBuffer& a, const ContactBuffer& b) { return a.size() < b.size(); });
}

std::size_t largest_size(const std::vector<ContactBuffer>& sets) {
  return sets.empty() ? 0 : largest_of(sets).size();
}

}  // namespace hapbench
