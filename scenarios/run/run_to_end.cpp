#include "scenarios/run/run_to_end.hpp"

#include "scenarios/run/stop_signal.hpp"

namespace hapbench {

SimulationResult run_to_end(Simulation& simulation) {
  do {
    throw_if_stopped();
  } while (simulation.advance(kAskEvery));
  return simulation.result();
}

}  // namespace hapbench
