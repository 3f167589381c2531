#include "scenarios/thesis_claims/contact_sets.hpp"

#include <cmath>

#include "results/observe/ideal_trajectory.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/stop_signal.hpp"
#include "sim/loop/simulation.hpp"

namespace hapbench {
namespace {

constexpr double kPeriod = 6.0;  // [s], of the tilt of task 2

/// Keeps the contacts of every `stride`-th row that has some.
class ContactSets final : public Observer {
 public:
  explicit ContactSets(std::uint64_t stride) : stride_(stride) {}
  void on_step(const StepRecord& record) noexcept override {
    const ContactBuffer& seen = *record.rendered;
    if (record.step % stride_ == 0 && !seen.empty()) sets.emplace_back(seen.size()).assign(seen);
  }
  std::vector<ContactBuffer> sets;

 private:
  std::uint64_t stride_;
};

}  // namespace

Scenario drill_in_hole(Scenario scenario) {
  if (!std::holds_alternative<BlockEnvironment>(scenario.environment)) {
    throw InputError(InputError::Kind::relation, "/environment/type",
                     "got another environment; allowed here: block_with_hole, the hole its drill is measured in");
  }
  make_cylinder(scenario.tool);  // refuses other tools
  if (!has_ideal_trajectory(scenario)) {
    throw InputError(InputError::Kind::relation, "/tool/tip",
                     "got \"round\"; allowed here: \"flat\", whose ideal trajectory is known");
  }
  scenario.device = IdealDeviceFields{input_force_limit(scenario.device)};
  const auto rows = static_cast<std::int64_t>(std::llround(kPeriod / scenario.time.step));
  scenario.time.steps = std::min(scenario.time.steps, rows);
  scenario.record = {};
  return scenario;
}

std::vector<ContactBuffer> contact_sets(Scenario scenario, std::uint64_t stride) {
  scenario.rendering.reduction.reset();
  scenario.rendering.local_average = false;
  return rendered_contact_sets(scenario, stride);
}

std::vector<ContactBuffer> rendered_contact_sets(const Scenario& scenario, std::uint64_t stride) {
  ContactSets seen(stride);
  Simulation simulation(simulation_config(scenario), assemble(scenario, make_shell(scenario), {}), {&seen});
  run_to_end(simulation);
  return std::move(seen.sets);
}

std::size_t largest_size(const std::vector<ContactBuffer>& sets) {
  std::size_t largest = 0;
  for (const ContactBuffer& set : sets) largest = std::max(largest, set.size());
  return largest;
}

}  // namespace hapbench
