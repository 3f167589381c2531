#include <algorithm>
#include <cmath>
#include <limits>

#include "algorithms/parameters.hpp"
#include "algorithms/stages/force_stage.hpp"

namespace hapbench {
namespace {

constexpr ParameterInfo kTankParameters[] = {
    {parameter::kTankCapacity, "C, most energy that is kept for later"},
    {parameter::kTankInitial, "energy at the start, besides that of the springs"},
};
constexpr ParameterInfo kActuatorParameters[] = {
    {parameter::kActuatorForce, "F_j, most force of the actuator along each axis; null: no limit"},
    {parameter::kActuatorDamping, "b, most damping; null: M / dt of the virtual tool, which stops it in one step"},
};

}  // namespace

const ModelInfo kEnergyTankInfo = {
    .name = "energy_tank",
    .summary = "a force stage that lets the rendering give away no more energy than its tank holds",
    .formula = "T <- min(C, T + absorbed); f - (<f, v> dt - max(T, 0)) / (|v|^2 dt) v where <f, v> dt > max(T, 0)",
    .source = "Franken, Stramigioli, Misra, Secchi and Macchelli 2011; Ferraguti et al. 2015; along the velocity: ours",
    .known_failure =
        "a capacity below the energy of the springs that are pressed takes their push back; it takes push away and "
        "never damps, so that a vibration that creates no energy goes on; what an explicit step of a virtual mass creates "
        "within the step it does not foresee",
    .parameters = kTankParameters,
};

const ModelInfo kActuatorLimitedPassivityInfo = {
    .name = "actuator_limited_passivity",
    .summary = "a force stage: time-domain passivity whose damping no actuator is too weak for",
    .formula =
        "W = <f, v> - E / dt > 0 is dissipated by f1 = f - a1 <v, n> n, n = f / |f|, then f2 = f1 - a2 (v - <v, n> n); "
        "a1 = W / <v, n>^2 and a2 = (W - a1 <v, n>^2) / |v - <v, n> n|^2, each at most b and such that |f_j| <= F_j; the "
        "rest stays owed",
    .source =
        "Hannaford and Ryu 2002; priority of the force's direction and limits of each actuator after the abstract of "
        "Porcini and Frisoli 2026 (arXiv 2603.26347), formulas ours",
    .known_failure =
        "foresees the coming step by the velocity alone: a force that throws the tool within a step is owed first and "
        "paid afterwards, too late where the explicit step of a virtual mass is unstable; what damping has taken is credit, behind which a vibration may hide; a turn of the tool that "
        "lifts it counts as energy created",
    .parameters = kActuatorParameters,
};

Vec3 EnergyTank::force(const StageStep& step) noexcept {
  level_ = std::min(config_.capacity, begun_ ? level_ + (step.energy - energy_) : config_.initial + step.energy);
  energy_ = step.energy;
  begun_ = true;
  const Vec3 &f = step.force, &v = step.velocity;
  const double excess = f.dot(v) * dt_ - std::max(level_, 0.0);
  return f.dot(v) > 0.0 && excess > 0.0 ? Vec3(f - excess / (v.squaredNorm() * dt_) * v) : f;
}

void ActuatorLimitedPassivity::prepare(double time_step, double mass) {
  dt_ = time_step;
  most_damping_ = config_.max_damping.value_or(mass / dt_);
}

Vec3 ActuatorLimitedPassivity::force(const StageStep& step) noexcept {
  const Vec3 &f = step.force, &v = step.velocity;
  const double size = f.norm();
  double owed = f.dot(v) - step.energy / dt_;  // [W]
  if (size == 0.0 || !(owed > 0.0)) return f;
  const Vec3 most = config_.max_force.value_or(Vec3::Constant(std::numeric_limits<double>::infinity()));
  // The damping a <= b that dissipates what is owed from the velocity `part`, with |g - a part|_j <= F_j for each j.
  const auto damped = [&](const Vec3& g, const Vec3& part) -> Vec3 {
    double a = std::min(most_damping_, owed / part.squaredNorm());
    for (int j = 0; j < 3; ++j) {
      if (part[j] == 0.0) continue;
      const double room = most[j] + (part[j] > 0.0 ? g[j] : -g[j]);
      a = std::min(a, std::max(0.0, room / std::abs(part[j])));
    }
    owed -= a * part.squaredNorm();
    return g - a * part;
  };
  const Vec3 n = f / size, along = v.dot(n) * n, across = v - along;
  const Vec3 f1 = along.isZero(0.0) ? f : damped(f, along);
  return across.isZero(0.0) || !(owed > 0.0) ? f1 : damped(f1, across);
}

}  // namespace hapbench
