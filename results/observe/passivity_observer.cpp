#include "results/observe/passivity_observer.hpp"

#include <cmath>

#include "sim/loop/simulation.hpp"

namespace hapbench {

void PassivityObserver::begin(const TrialParts& trial) {
  worst_before_ = worst();
  now_ = {};
  observed_ = ObservedEnergy(trial.config.dt, trial.simulation.motion->position_is_free());
}

void PassivityObserver::on_step(const StepRecord& record) noexcept {
  if (observed_.rests(record.force.rendered, record.springs)) return observed_.rest(record.tool);
  observed_.move(record.tool, record.handle_moves_tool);
  observed_.answer(record.tool, record.force.rendered, record.springs);
  const double energy = observed_.energy();
  // The negated comparison keeps a NaN as the minimum.
  if (now_.rows && !(energy < now_.energy_min) && !std::isnan(energy)) return;
  if (std::isnan(now_.energy_min)) return;
  now_.energy_min = energy;
  now_.time_of_min = record.time;
  now_.rows = true;
}

PassivityObserver::Extremes PassivityObserver::worst() const noexcept {
  if (!now_.rows) return worst_before_;
  Extremes now = now_;
  now.energy_end = observed_.energy();
  const Extremes& before = worst_before_;
  const bool is_worse = now.energy_min < before.energy_min || std::isnan(now.energy_min);
  return !before.rows || (is_worse && !std::isnan(before.energy_min)) ? now : before;
}

void PassivityObserver::tell(Section& s) const {
  const Extremes e = worst();
  s.metric("energy_min_J", "J",
           "least observed energy of a row: what translation and rotation have put into the rendering; "
           "negative when it gave more than it had",
           if_any(e.rows, e.energy_min));
  s.metric("time_of_min_s", "s", "time of the first row that has it", if_any(e.rows, e.time_of_min));
  s.metric("energy_end_J", "J", "observed energy of the last row", if_any(e.rows, e.energy_end));
  s.metric("net_created_J", "J", "energy that the rendering created, max(0, -energy_min_J)",
           if_any(e.rows, e.net_created()), Better::less);
}

}  // namespace hapbench
