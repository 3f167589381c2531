#include "scenarios/run/run_to_end.hpp"

#include "scenarios/run/stop_signal.hpp"

namespace hapbench {

SimulationResult run_to_end(Simulation& simulation) {
  do {
    throw_if_stopped();
  } while (simulation.advance(kAskEvery));
  throw_if_stopped();  // a force law may have ended the run by a force that is none, because the work is to stop
  return simulation.result();
}

}  // namespace hapbench
