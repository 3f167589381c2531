#include "results/observe/energy.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "sim/tool/motion.hpp"

namespace hapbench {
namespace {

/// Returns the number of elements of the sorted list `a` that are missing in the sorted list `b`.
std::size_t missing(const std::vector<std::uint32_t>& a, const std::vector<std::uint32_t>& b) noexcept {
  const auto is_missing = [&b](std::uint32_t i) { return !std::ranges::binary_search(b, i); };
  return static_cast<std::size_t>(std::ranges::count_if(a, is_missing));
}

}  // namespace

EnergyLedger::EnergyLedger(double mass, double dt, bool position_is_free, std::size_t capacity,
                           const IntegratorEntry& integrator)
    : mass_(mass), dt_(dt), position_is_free_(position_is_free), holds_force_(integrator.holds_force) {
  last_rendered_.reserve(capacity);
  rendered_.reserve(capacity);
}

void EnergyLedger::begin(const TrialParts& trial) {
  const SimulationParts& parts = trial.simulation;
  *this = EnergyLedger(trial.config.mass, trial.config.dt, parts.motion->position_is_free(), parts.source->capacity(),
                       *trial.config.integrator);
}

void EnergyLedger::on_step(const StepRecord& record) noexcept {
  // Sort the indices of the rendered contacts, to compare them with the previous step.
  const auto& index = record.rendered->index;
  rendered_.assign(index.begin(), index.begin() + static_cast<std::ptrdiff_t>(record.rendered->size()));
  std::sort(rendered_.begin(), rendered_.end());
  // Update the kinetic and the stored energy. In every step after the first, also add the works since the previous
  // step.
  balance_.kinetic = record.handle_moves_tool ? 0.0 : 0.5 * mass_ * record.tool.velocity.squaredNorm();
  balance_.stored = record.springs.energy;
  if (has_row_) {
    add_step(record);
  } else {
    kinetic_at_start_ = balance_.kinetic;
    balance_.device = record.device;
  }
  has_row_ = true;
  last_ = record;
  std::swap(last_rendered_, rendered_);
}

EnergyLedger::Works EnergyLedger::works(const Vec3& spring, const Vec3& rendered,
                                        const Vec3& displacement) const noexcept {
  return {.input = last_.hand.input.dot(displacement),
          .hand = last_.hand_force.dot(displacement),
          .actuator = (last_.hand.input - last_.hand_force).dot(displacement),
          .spring = spring.dot(displacement),
          .damping = (rendered - spring).dot(displacement)};
}

EnergyLedger::Works EnergyLedger::works_until(const StepRecord& now) const noexcept {
  const Vec3 velocities = last_.tool.velocity + now.tool.velocity;
  const Vec3 moved = now.tool.pose.position - last_.tool.pose.position;
  if (now.handle_moves_tool) return works(last_.force.spring, last_.force.rendered, moved);
  if (position_is_free_ && holds_force_) return works(last_.force.spring, last_.force.rendered, 0.5 * velocities * dt_);
  Works w =
      works(0.5 * (last_.force.spring + now.force.spring), 0.5 * (last_.force.rendered + now.force.rendered), moved);
  if (!position_is_free_) return w;
  const double kinetic = 0.5 * mass_ * (now.tool.velocity - last_.tool.velocity).dot(velocities);
  w.unexplained = kinetic - w.input - w.spring - w.damping;
  return w;
}

void EnergyLedger::add_step(const StepRecord& now) noexcept {
  // Add the works on the tool. The change of kinetic energy that these works do not explain is assigned to the
  // integrator, the script or rounding.
  EnergyBalance& b = balance_;
  const Works w = works_until(now);
  b.input += w.input;
  b.spring += w.spring;
  b.damping += w.damping;
  b.integration += w.unexplained;
  unexplained_ += w.unexplained;
  const double unexplained = b.kinetic - kinetic_at_start_ - b.input - b.spring - b.damping - unexplained_;
  const bool free = position_is_free_ && !now.handle_moves_tool;
  (free ? b.residual : b.script) = unexplained;
  if (free) residual_max_ = std::max(residual_max_, std::abs(unexplained));
  if (now.device) {
    b.device = now.device;
    b.hand = now.device->hand;
    b.actuator = now.device->actuator;
  } else {
    b.hand += w.hand;
    b.actuator += w.actuator;
  }

  // Compute the energy created in this step. Keep the step as an event if it is among the largest.
  const double created = created_in_step(now, w.spring);
  b.created += created;
  if (created > 0.0) created_sum_ += created;
  created_max_ = std::max(created_max_, created);
  if (created > events_.back().created) add_event(now, created);
}

/// Returns the created energy of a step [J]. Adds the work of the tool's rotation on the springs to
/// EnergyBalance::rotation. Adds the sum of two works to EnergyBalance::integration: the work `spring_work` of f_spring
/// on the tool as the integrator computes it, and the work of the tool's translation on the springs by the trapezoidal
/// rule.
double EnergyLedger::created_in_step(const StepRecord& now, double spring_work) noexcept {
  const Vec3 moved = now.tool.pose.position - last_.tool.pose.position;
  const Vec3 turned = turn(last_.tool.pose, now.tool.pose);
  const double translation = -0.5 * (last_.force.spring + now.force.spring).dot(moved);
  const double rotation = -0.5 * (last_.springs.moment + now.springs.moment).dot(turned);
  balance_.rotation += rotation;
  balance_.integration += spring_work + translation;
  return now.springs.energy - last_.springs.energy - translation - rotation;
}

void EnergyLedger::add_event(const StepRecord& now, double created) noexcept {
  events_.back() = {.step = now.step,
                    .time = now.time,
                    .created = created,
                    .colliding = {last_.colliding, now.colliding},
                    .rendered = {last_rendered_.size(), rendered_.size()},
                    .appeared = missing(rendered_, last_rendered_),
                    .vanished = missing(last_rendered_, rendered_)};
  for (std::size_t i = events_.size() - 1; i > 0 && events_[i].created > events_[i - 1].created; --i) {
    std::swap(events_[i], events_[i - 1]);
  }
}

void EnergyLedger::report(Section& s) const {
  const EnergyBalance& b = balance_;
  s.metric(
      "created_sum_J", "J",
      "sum of the positive changes of the created energy (created_J of energy.csv) over the steps; energy that later "
      "steps remove again is not subtracted",
      created_sum_, Better::less);
  s.metric("created_max_J", "J", "largest created energy of a single step (change of created_J of energy.csv)",
           created_max_, Better::less);
  s.metric(
       "created_J", "J",
       "created energy over the whole run (last created_J of energy.csv): energy stored in the springs at the end, "
       "minus the work that translation "
       "and rotation of the tool did on the springs; it arises when contacts appear, vanish or change their weights",
       b.created)
      .has_either_sign();
  s.metric("input_J", "J", "work of the input force f_in on the tool (last input_J of energy.csv)", b.input)
      .varies_smoothly()
      .has_either_sign();
  s.metric(
       "spring_J", "J",
       "work of the spring force f_spring on the tool (last spring_J of energy.csv); for a prescribed motion by the "
       "trapezoidal rule, with an error "
       "of up to K d^2 / 8 where a contact begins or ends between steps whose depths differ by d",
       b.spring)
      .varies_smoothly()
      .has_either_sign();
  s.metric(
       "damping_J", "J",
       "work of damping, friction and force limit on the tool, i.e. of f - f_spring (last damping_J of energy.csv); "
       "negative: energy is dissipated",
       b.damping)
      .varies_smoothly()
      .has_either_sign();
  s.metric("rotation_J", "J", "work that the tool's rotation did on the springs (last rotation_J of energy.csv)",
           b.rotation)
      .varies_smoothly()
      .has_either_sign();
  s.metric(
       "integration_J", "J",
       "energy created by the numerical integrator (discretisation error; last integration_J of energy.csv); 0 for an "
       "exact integration",
       b.integration)
      .varies_smoothly()
      .has_either_sign();
  s.metric("script_J", "J",
           "work of the scripted motion on the tool (last script_J of energy.csv); 0 for a freely moving tool",
           b.script)
      .varies_smoothly()
      .has_either_sign();
  s.metric("hand_J", "J", "work of the hand on the handle (last hand_J of energy.csv)", b.hand)
      .varies_smoothly()
      .has_either_sign();
  s.metric("actuator_J", "J", "work of the device's actuators (last actuator_J of energy.csv)", b.actuator)
      .varies_smoothly()
      .has_either_sign();
  s.metric("residual_max_J", "J",
           "largest absolute value, over the steps, of the kinetic energy that no other term of the balance explains "
           "(|residual_J| of energy.csv); a correct balance leaves only rounding errors",
           residual_max_, Better::less);
}

void EnergyLedger::add_members(nlohmann::ordered_json& section) const {
  auto& list = section["events"] = nlohmann::ordered_json::array();
  for (const EnergyEvent& e : events()) {
    list.push_back({{"step", e.step},
                    {"time_s", e.time},
                    {"created_J", e.created},
                    {"colliding", e.colliding},
                    {"rendered", e.rendered},
                    {"appeared", e.appeared},
                    {"vanished", e.vanished}});
  }
}

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
  // If the energy is NaN once, the minimum becomes NaN and stays NaN.
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

void PassivityObserver::report(Section& s) const {
  const Extremes e = worst();
  s.metric(
       "energy_min_J", "J",
       "smallest energy that the rendering held: minimum of E over the steps; negative if the rendering returned more "
       "energy than it had received. E is the energy of the springs at the start (stored_J of energy.csv) plus the "
       "work that the tool's translation and rotation did on the rendering. In step k, the translation adds -f_(k-1) . "
       "(v_(k-1) + v_k) dt / 2, with f and v of trajectory.csv. If the handle moves the tool, it adds -f_(k-1) . (p_k "
       "- p_(k-1)) instead, and along a prescribed path -(f_(k-1) + f_k) / 2 . (p_k - p_(k-1)). The rotation adds the "
       "change of rotation_J of energy.csv",
       if_any(e.rows, e.energy_min))
      .has_either_sign();
  s.metric("time_of_min_s", "s", "time_s of the step at which energy_min_J is first reached",
           if_any(e.rows, e.time_of_min));
  s.metric("energy_end_J", "J", "energy that the rendering held at the last step (defined as in energy_min_J)",
           if_any(e.rows, e.energy_end))
      .varies_smoothly()
      .has_either_sign();
  s.metric("net_created_J", "J",
           "net created energy, max(0, -energy_min_J); 0 means that the rendered force shows no violation of passivity "
           "in this run. The rendered force is the force that the law commands. A device that delays or limits this "
           "force can create energy that this metric does not count: actuator_J of energy.csv is the work of the force "
           "that the motors apply",
           if_any(e.rows, e.net_created()), Better::less);
}

}  // namespace hapbench
