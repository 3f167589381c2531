// Runs a bundled scenario with a user-defined force law: own_law [SCENARIO]. The law is a copy of `mean`, so that the
// state hash shows whether the numbers equal hapbench's numbers to the last bit.
#include <algorithms/laws/force_law.hpp>
#include <algorithms/penalty_rendering.hpp>
#include <cinttypes>
#include <cstdio>
#include <exception>
#include <memory>
#include <results/observe/metrics.hpp>
#include <scenarios/input/bundled_scenarios.hpp>
#include <scenarios/run/assemble.hpp>
#include <scenarios/scene/load_scenario.hpp>
#include <sim/loop/simulation.hpp>

namespace {

/// f = -K/n sum d_i u_i: the mean of the penalty springs.
class MeanOfSprings final : public hapbench::ForceLaw {
 public:
  using ForceLaw::ForceLaw;

  hapbench::LawForce evaluate(hapbench::ContactBuffer& contacts) noexcept override {
    hapbench::set_weights(contacts, 1.0 / static_cast<double>(contacts.size()));
    return hapbench::weighted_force(contacts, K_);
  }
};

}  // namespace

int main(int argc, char** argv) try {
  const auto file = hapbench::find_scenario(argc > 1 ? argv[1] : "peg_in_hole_2d_mean");
  const hapbench::Scenario scenario = hapbench::load_scenario(file).scenario;
  hapbench::SimulationParts parts = hapbench::assemble(scenario);
  parts.algorithm = std::make_unique<hapbench::PenaltyRendering>(
      std::make_unique<MeanOfSprings>(scenario.rendering.stiffness), scenario.rendering);
  hapbench::MetricsObserver metrics(scenario.time.step);
  hapbench::Simulation simulation(hapbench::simulation_config(scenario), std::move(parts), {&metrics});
  simulation.run();
  std::printf("%s\n%016" PRIx64 "\n", file.c_str(), metrics.state_hash());
} catch (const std::exception& error) {
  std::fprintf(stderr, "own_law: %s\n", error.what());
  return 2;
}
