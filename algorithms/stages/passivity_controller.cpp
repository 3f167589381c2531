#include "algorithms/stages/passivity_controller.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "algorithms/parameters.hpp"
#include "algorithms/stages/damping_and_limits.hpp"

namespace hapbench {
namespace {

constexpr ParameterInfo kPassivityParameters[] = {
    {parameter::kPassivityController, "switches the controller on, for any algorithm"},
};

}  // namespace

const ModelInfo kPassivityControllerInfo = {
    .name = "passivity_controller",
    .summary = "adaptive damping that lets no algorithm give away more energy than it has taken in",
    .formula =
        "E = E_spring(0) - sum f_render . (v_k + v_k+1)/2 dt - sum (m_k + m_k+1)/2 . turn_k >= 0; "
        "f_render = s f - alpha (v + f_in dt/2M), alpha = (1 - s) M/dt, largest s in [0, 1]",
    .source = "Hannaford and Ryu, 2002 (observer and controller); the look-ahead and the rotation are ours",
    .known_failure =
        "what damping took in is credit, behind which a vibration may hide for a while; a law that creates "
        "energy feels weak and sticky where it has none left",
    .parameters = kPassivityParameters,
};

namespace {

/// The largest s in [0, 1] with a s^2 + b s <= c, a >= 0; if there is none, the s that comes closest.
double largest_share(double a, double b, double c) noexcept {
  if (a + b <= c) return 1.0;
  const double discriminant = std::max(0.0, b * b + 4.0 * a * c);
  // Two forms of the same root, for b of either sign without cancellation.
  const double root = std::sqrt(discriminant);
  const double s = b > 0.0 ? 2.0 * c / (b + root) : a > 0.0 ? (root - b) / (2.0 * a) : 1.0;
  return std::clamp(s, 0.0, 1.0);
}

}  // namespace

/// True where there is something to control: springs, or the force of a force stage in free air.
static bool acts(const ContactBuffer& contacts, const RenderedForce& force) noexcept {
  return has_springs(contacts, force) || !force.rendered.isZero(0.0);
}

PassivityController::PassivityController(std::unique_ptr<ForceAlgorithm> algorithm, const RenderingConfig& config)
    : algorithm_(std::move(algorithm)), mass_(config.mass), max_force_(config.max_force) {}

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
    // A state within the step is not observed and keeps the row's share and damping.
    if (acts(contacts, out)) render(tool, out);
    return;
  }

  last_row_ = *row_;
  observed_.move(tool);
  note_turn();
  share_ = spring_share_ = 1.0;
  alpha_ = 0.0;
  if (acts(contacts, out)) {
    springs_ = algorithm_->spring_state(tool, contacts);
    control(tool, out.rendered);
    springs_.energy *= spring_share_;
    springs_.moment *= spring_share_;
    render(tool, out);
  } else {
    springs_ = {};
  }
  observed_.answer(tool, out.rendered, springs_);
}

/// Keeps the largest change of the turn so far. It predicts how much the hand may change the turn again.
void PassivityController::note_turn() noexcept {
  if (observed_.first()) return;
  const Vec3 turn = observed_.turned();
  if (last_turn_) largest_change_ = std::max(largest_change_, (turn - *last_turn_).norm());
  last_turn_ = turn;
}

/// Computes share and damping for the step.
void PassivityController::control(const ToolState& tool, const Vec3& force) noexcept {
  // Energy that the scripted rotation draws from the moment over the last step and, at the same rate, over the next.
  const double drawn = springs_.moment.dot(observed_.turned());
  const double energy = observed_.energy();
  const double weakened = 0.5 * drawn > energy && drawn > 0.0 ? std::max(0.0, 2.0 * energy / drawn) : 1.0;

  const Vec3 w = tool.velocity + half_kick();
  const Vec3 u = w + force * (weakened * dt_ / mass_);
  const double unforeseen = springs_.moment.norm() * largest_change_;
  const double taken =
      0.5 * drawn + std::max(0.0, 0.5 * drawn + unforeseen) - (observed_.first() ? springs_.energy : 0.0);
  const double s =
      largest_share(0.5 * mass_ * u.squaredNorm(), weakened * taken, energy + 0.5 * mass_ * w.squaredNorm());
  share_ = spring_share_ = weakened * s;
  alpha_ = (1.0 - s) * mass_ / dt_;
  if (share_ == 1.0) return;
  ++steps_controlled_;
  // A force that the limit cuts absorbs less energy, so less is left for the moment.
  const Vec3 whole = share_ * force - alpha_ * w;
  if (const Vec3 rendered = cut_to(whole, max_force_); rendered != whole && taken > 0.0) {
    const Vec3 after = w + rendered * (dt_ / mass_);
    const double left = energy + 0.5 * mass_ * (w.squaredNorm() - after.squaredNorm());
    spring_share_ = std::clamp(left / taken, 0.0, share_);
  }
}

void PassivityController::render(const ToolState& tool, RenderedForce& out) const noexcept {
  if (share_ == 1.0) return;
  out.spring *= share_;
  out.S *= share_;
  out.rendered = cut_to(share_ * out.rendered - alpha_ * (tool.velocity + half_kick()), max_force_);
}

ForceJacobian PassivityController::jacobian() const noexcept {
  const ForceJacobian inner = algorithm_->jacobian();
  return {share_ * inner.stiffness, share_ * inner.damping + alpha_ * Mat3::Identity()};
}

AlgorithmWork PassivityController::work() const noexcept {
  AlgorithmWork work = algorithm_->work();
  work.steps_controlled = steps_controlled_;
  return work;
}

}  // namespace hapbench
