#include "results/observe/force_stages.hpp"

#include "sim/loop/simulation.hpp"

namespace hapbench {

void FrictionObserver::begin(const TrialParts& trial) {
  *this = {};
  dt_ = trial.config.dt;
}

void FrictionObserver::on_step(const StepRecord& record) noexcept {
  const Friction now = record.force.friction;
  ++rows_;
  sticking_ += now == Friction::sticks ? 1 : 0;
  sliding_ += now == Friction::slides ? 1 : 0;
  slips_ += now == Friction::slides && last_ == Friction::sticks ? 1 : 0;
  last_ = now;
}

void FrictionObserver::tell(Section& s) const {
  const std::uint64_t with_load = sticking_ + sliding_;
  s.metric("stick_share", "1", "share of the rows with load in which dry friction sticks",
           if_any(with_load > 0, static_cast<double>(sticking_) / static_cast<double>(with_load)));
  s.metric("slips_per_s", "1/s", "times that a sticking tool began to slide, per second of the run",
           if_any(with_load > 0, static_cast<double>(slips_) / (dt_ * static_cast<double>(rows_))));
}

void ForceStageObserver::begin(const TrialParts& trial) {
  *this = {};
  algorithm_ = trial.simulation.algorithm.get();
}

void ForceStageObserver::tell(Section& s) const {
  s.metric("changed_share", "1", "share of the rows in which the force stage changes the force",
           if_any(rows_ > 0, static_cast<double>(work_.steps_staged) / static_cast<double>(rows_)));
  s.metric("taken_J", "J", "energy that the force stage kept the force from giving to the tool, along the way it went",
           if_any(rows_ > 0, work_.energy_staged));
}

}  // namespace hapbench
