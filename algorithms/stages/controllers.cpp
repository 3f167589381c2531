#include "algorithms/stages/controllers.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "algorithms/stages/damping_and_limits.hpp"

namespace hapbench {

constexpr ParameterInfo kTankParameters[] = {
    {parameter::kTankCapacity, "C, largest energy that the tank stores"},
    {parameter::kTankInitial, "energy in the tank at the start, in addition to the energy of the springs"},
};
constexpr ParameterInfo kActuatorParameters[] = {
    {parameter::kActuatorForce, "F_j, largest force of the actuator along each axis; null: no limit"},
    {parameter::kActuatorDamping,
     "b, largest damping; null: M / dt of the virtual tool, which stops it in one time step"},
};
constexpr ParameterInfo kPassivityParameters[] = {
    {parameter::kPassivityController, "switches the controller on; works with any algorithm"},
};

const ModelInfo kEnergyTankInfo = {
    .name = "energy_tank",
    .summary = "force stage: the rendering releases no more energy than its tank holds",
    .formula = "T <- min(C, T + absorbed); f - (<f, v> dt - max(T, 0)) / (|v|^2 dt) v where <f, v> dt > max(T, 0)",
    .source = "Franken, Stramigioli, Misra, Secchi and Macchelli 2011; Ferraguti et al. 2015; along the velocity: ours",
    .known_failure =
        "with a capacity below the energy of the pressed springs, the force with which they push back is reduced; the "
        "tank reduces forces but adds no damping, so that a vibration that creates no energy continues; the tank does "
        "not predict energy that an explicit step of a virtual mass creates within the step",
    .parameters = kTankParameters,
};

const ModelInfo kActuatorLimitedPassivityInfo = {
    .name = "actuator_limited_passivity",
    .summary = "force stage: time-domain passivity control with damping that every actuator can render",
    .formula =
        "W = <f, v> - E / dt > 0 is dissipated by f1 = f - a1 <v, n> n, n = f / |f|, then f2 = f1 - a2 (v - <v, n> n); "
        "a1 = W / <v, n>^2 and a2 = (W - a1 <v, n>^2) / |v - <v, n> n|^2, each at most b and at most the value at "
        "which an actuator reaches |f_j| = F_j; the rest of W is dissipated in later steps",
    .source =
        "Hannaford and Ryu 2002; priority of the force's direction and limits of each actuator after the abstract of "
        "Porcini and Frisoli 2026 (arXiv 2603.26347); the formulas are our derivation",
    .known_failure =
        "predicts the next step by the velocity alone: the energy of a force that accelerates the tool within a step "
        "is dissipated only afterwards, too late if the explicit step of a virtual mass is unstable; dissipated energy "
        "is credit, which may hide a vibration; a rotation of the tool that lifts it counts as created energy",
    .parameters = kActuatorParameters,
};

const ModelInfo kPassivityControllerInfo = {
    .name = "passivity_controller",
    .summary = "adaptive damping with which the algorithm releases no more energy than it received",
    .formula =
        "E = E_spring(0) - sum f_render . (v_k + v_k+1)/2 dt - sum (m_k + m_k+1)/2 . turn_k >= 0; "
        "f_render = s f - alpha (v + f_in dt/2M), alpha = (1 - s) M/dt, largest s in [0, 1]",
    .source =
        "Hannaford and Ryu, 2002 (observer and controller); the look-ahead and the rotation are not from that paper",
    .known_failure =
        "dissipated energy is credit, which may hide a vibration for a while; an algorithm that creates energy feels "
        "weak and sticky when the credit is used up",
    .parameters = kPassivityParameters,
};

Vec3 EnergyTank::force(const StageStep& step) noexcept {
  // Change the level by the energy that the rendering absorbed or released since the last step, up to the capacity.
  level_ = std::min(config_.capacity, begun_ ? level_ + (step.energy - energy_) : config_.initial + step.energy);
  energy_ = step.energy;
  begun_ = true;
  const Vec3 &f = step.force, &v = step.velocity;
  // Reduce the force along the velocity if it would return more energy than the tank holds.
  const double excess = f.dot(v) * dt_ - std::max(level_, 0.0);
  return f.dot(v) > 0.0 && excess > 0.0 ? Vec3(f - excess / (v.squaredNorm() * dt_) * v) : f;
}

void ActuatorLimitedPassivity::prepare(double time_step, double mass) {
  dt_ = time_step;
  max_damping_ = config_.max_damping.value_or(mass / dt_);
}

Vec3 ActuatorLimitedPassivity::force(const StageStep& step) noexcept {
  const Vec3 &f = step.force, &v = step.velocity;
  const double size = f.norm();
  double owed = f.dot(v) - step.energy / dt_;  // power to dissipate [W]
  if (size == 0.0 || !(owed > 0.0)) return f;
  const Vec3 limit = config_.max_force.value_or(Vec3::Constant(std::numeric_limits<double>::infinity()));
  // Returns g - a `part`: the force g, minus the damping a times the velocity component `part`. a is the smallest
  // damping that dissipates the power `owed`. It is at most max_damping_, and at most the damping that keeps the force
  // within the limits, |g - a part|_j <= F_j for each axis j.
  const auto damped = [&](const Vec3& g, const Vec3& part) -> Vec3 {
    double a = std::min(max_damping_, owed / part.squaredNorm());
    for (int j = 0; j < 3; ++j) {
      if (part[j] == 0.0) continue;
      const double room = limit[j] + (part[j] > 0.0 ? g[j] : -g[j]);
      a = std::min(a, std::max(0.0, room / std::abs(part[j])));
    }
    owed -= a * part.squaredNorm();
    return g - a * part;
  };
  const Vec3 n = f / size, along = v.dot(n) * n, across = v - along;
  const Vec3 f1 = along.isZero(0.0) ? f : damped(f, along);
  return across.isZero(0.0) || !(owed > 0.0) ? f1 : damped(f1, across);
}

void StagedRendering::prepare(const Scene& scene) {
  algorithm_->prepare(scene);
  scene_ = scene;
  rendered_energy_ = requested_energy_ = ObservedEnergy(scene.dt, scene.position_is_free);
  const bool has_mass = scene.position_is_free && !scene.handle_moves_tool;
  stage_->prepare(scene.dt, has_mass ? config_.mass : 0.0);
}

void StagedRendering::reset() noexcept {
  algorithm_->reset();
  stage_->reset();
  rendered_energy_.reset();
  requested_energy_.reset();
  row_.reset();
  change_.setZero();
  steps_staged_ = 0;
}

void StagedRendering::compute(const ToolState& tool, ContactBuffer& contacts, RenderedForce& out) noexcept {
  algorithm_->compute(tool, contacts, out);
  // If an integrator evaluates another state within the step, add the change that the stage computed for this step.
  const std::uint64_t row = scene_.row != nullptr ? *scene_.row : row_ ? *row_ + 1 : 0;
  if (row_ == row) {
    if (!change_.isZero(0.0)) out.rendered += change_;
    return;
  }
  const bool first = !row_;
  row_ = row;
  // Update the observed energies for the motion since the last step.
  for (ObservedEnergy* port : {&rendered_energy_, &requested_energy_}) port->move(tool, scene_.handle_moves_tool);
  // At the start of a run, the rendering may return the elastic energy of the springs. The stage observes only the
  // translation of the tool, so the moment is zero.
  const SpringState springs{first ? algorithm_->spring_state(tool, contacts).energy : 0.0, Vec3::Zero()};
  requested_energy_.answer(tool, out.rendered, springs);
  // Call the stage. The observer first gets the force zero, so that the energy for the stage includes no work of the
  // force of this step.
  rendered_energy_.answer(tool, Vec3::Zero(), springs);
  const Vec3 answer =
      limited_to(stage_->force({out.rendered, tool.velocity, rendered_energy_.energy()}), config_.max_force);
  rendered_energy_.answer(tool, answer, springs);
  // Store the change of the force. It is also added at further states that an integrator evaluates within the step.
  if (answer == out.rendered) {
    change_.setZero();
    return;
  }
  ++steps_staged_;
  change_ = answer - out.rendered;
  out.rendered = answer;
}

AlgorithmWork StagedRendering::work() const noexcept {
  AlgorithmWork work = algorithm_->work();
  work.steps_staged = steps_staged_;
  work.energy_staged = rendered_energy_.energy() - requested_energy_.energy();
  return work;
}

/// Returns the largest s in [0, 1] with a s^2 + b s <= c, where a >= 0. If there is no such s, returns the s in [0, 1]
/// with the smallest a s^2 + b s.
static double largest_scale(double a, double b, double c) noexcept {
  if (a + b <= c) return 1.0;
  const double discriminant = std::max(0.0, b * b + 4.0 * a * c);
  // Two forms of the same root, to avoid cancellation for either sign of b.
  const double root = std::sqrt(discriminant);
  const double s = b > 0.0 ? 2.0 * c / (b + root) : a > 0.0 ? (root - b) / (2.0 * a) : 1.0;
  return std::clamp(s, 0.0, 1.0);
}

/// Returns true if there is a force to control: from springs, or from a force stage in free air.
static bool acts(const ContactBuffer& contacts, const RenderedForce& force) noexcept {
  return has_springs(contacts, force) || !force.rendered.isZero(0.0);
}

void PassivityController::prepare(const Scene& scene) {
  algorithm_->prepare(scene);
  dt_ = scene.dt;
  row_ = scene.row;
  input_ = scene.input;
  observed_ = ObservedEnergy(dt_);
}

void PassivityController::reset() noexcept {
  algorithm_->reset();
  observed_.reset();
  steps_controlled_ = 0;
  largest_change_ = 0.0;
  last_turn_.reset();
  last_row_.reset();
}

void PassivityController::compute(const ToolState& tool, ContactBuffer& contacts, RenderedForce& out) noexcept {
  algorithm_->compute(tool, contacts, out);
  if (row_ == nullptr || last_row_ == *row_) {
    // If an integrator evaluates another state within the step, use the scale and the damping of this step, and do not
    // update the observed energy.
    if (acts(contacts, out)) render(tool, out);
    return;
  }

  last_row_ = *row_;
  observed_.move(tool);
  if (!observed_.first()) {
    // Update the largest change of the rotation between two steps. control() keeps energy in reserve for twice this
    // change.
    const Vec3 turn = observed_.turned();
    if (last_turn_) largest_change_ = std::max(largest_change_, (turn - *last_turn_).norm());
    last_turn_ = turn;
  }
  scale_ = 1.0;
  alpha_ = 0.0;
  if (acts(contacts, out)) {
    springs_ = algorithm_->spring_state(tool, contacts);
    control(tool, out.rendered);
    render(tool, out);
  } else {
    springs_ = {};
  }
  observed_.answer(tool, out.rendered, springs_);
}

/// Computes scale and damping for the step, and scales energy and moment of the springs.
void PassivityController::control(const ToolState& tool, const Vec3& force) noexcept {
  // Energy [J] that the scripted rotation draws from the moment: one half for the rotation of the last step, one half
  // for the equal rotation that is predicted for the coming step.
  const double drawn = springs_.moment.dot(observed_.turned());
  const double energy = observed_.energy();
  const double weakened = 0.5 * drawn > energy && drawn > 0.0 ? std::max(0.0, 2.0 * energy / drawn) : 1.0;

  // Find the largest scale for which the observed energy stays >= 0 over the coming step.
  const Vec3 w = tool.velocity + half_kick();
  const Vec3 u = w + force * (weakened * dt_ / mass_);
  const double unforeseen = springs_.moment.norm() * largest_change_;
  const double taken =
      0.5 * drawn + std::max(0.0, 0.5 * drawn + unforeseen) - (observed_.first() ? springs_.energy : 0.0);
  const double s =
      largest_scale(0.5 * mass_ * u.squaredNorm(), weakened * taken, energy + 0.5 * mass_ * w.squaredNorm());
  scale_ = weakened * s;
  alpha_ = (1.0 - s) * mass_ / dt_;
  if (scale_ == 1.0) return;
  ++steps_controlled_;
  double spring_scale = scale_;
  // If the force limit cuts the force, the force absorbs less energy, and less energy is left for the moment.
  const Vec3 whole = scale_ * force - alpha_ * w;
  if (const Vec3 rendered = limited_to(whole, max_force_); rendered != whole && taken > 0.0) {
    const Vec3 after = w + rendered * (dt_ / mass_);
    const double left = energy + 0.5 * mass_ * (w.squaredNorm() - after.squaredNorm());
    spring_scale = std::clamp(left / taken, 0.0, scale_);
  }
  springs_.energy *= spring_scale;
  springs_.moment *= spring_scale;
}

void PassivityController::render(const ToolState& tool, RenderedForce& out) const noexcept {
  if (scale_ == 1.0) return;
  out.spring *= scale_;
  out.S *= scale_;
  out.rendered = limited_to(scale_ * out.rendered - alpha_ * (tool.velocity + half_kick()), max_force_);
}

ForceJacobian PassivityController::jacobian() const noexcept {
  const ForceJacobian inner = algorithm_->jacobian();
  return {scale_ * inner.stiffness, scale_ * inner.damping + alpha_ * Mat3::Identity()};
}

AlgorithmWork PassivityController::work() const noexcept {
  AlgorithmWork work = algorithm_->work();
  work.steps_controlled = steps_controlled_;
  return work;
}

}  // namespace hapbench
