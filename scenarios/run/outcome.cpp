#include "scenarios/run/outcome.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "scenarios/run/approach.hpp"
#include "scenarios/run/drag_progress.hpp"
#include "scenarios/run/expectations.hpp"
#include "scenarios/run/quantity_text.hpp"
#include "scenarios/run/scene_checks.hpp"
#include "scenarios/run/scene_distances.hpp"
#include "scenarios/run/scene_warnings.hpp"
#include "scenarios/run/standstill.hpp"
#include "scenarios/scene/environments.hpp"

namespace hapbench {
namespace {

class OutcomeObserverImpl final : public OutcomeObserver {
 public:
  OutcomeObserverImpl(const Scenario& scenario, const NamedFiles& files, const SimulationParts& parts,
                      const MetricsObserver* metrics, RunLength length)
      : scenario_(scenario),
        metrics_(metrics),
        tool_(parts.tool),
        drag_(dynamic_cast<const DragHand*>(parts.hand.get())),
        normals_question_(normals_question(scenario.environment, files)) {
    const auto is_unexpected = [&scenario](Outcome outcome) { return !outcome_is_expected(scenario.expect, outcome); };
    const bool may_end = length == RunLength::until_failure && can_fail_early(scenario);
    // After a passage through the surface, the outcome is went_through, or diverges if the run diverges later. The
    // passage ends the run only if the scenario expects neither of these outcomes.
    passage_ends_ = may_end && is_unexpected(Outcome::went_through) && is_unexpected(Outcome::diverges);
    // A loss of contact ends the run only if the scenario expects none of the outcomes lost_contact, no_contact and
    // went_through. The outcome can be went_through, because the tool may have gone through the surface before it left.
    leaving_ends_ = may_end && never_returns(scenario) && is_unexpected(Outcome::went_through) &&
                    is_unexpected(Outcome::lost_contact) && is_unexpected(Outcome::no_contact);
    const auto steps = static_cast<std::uint64_t>(scenario.time.steps);
    // Observe the depth inside the environment's solid, if the environment has a solid.
    if (auto solid = make_solid(scenario, files)) {
      const std::int64_t every = scenario.record.inside ? scenario.record.every : 0;
      inside_.emplace(parts.tool, std::move(solid), metrics, static_cast<std::uint64_t>(every), steps);
    }
    if (parts.shell && parts.shell->size() > 0) approach_.emplace(parts.shell, steps);
    // Observe whether the tool stands still while the target of a drag, a hand spring or a subject moves on.
    const double width = 2.0 * tool_->half_width();
    if (drag_ != nullptr) progress_.emplace(*drag_, width, scenario.time.step * static_cast<double>(steps));
    if (const ImpedanceHandFields* hand = spring_of(scenario.hand);
        hand != nullptr && position_is_free(scenario.motion))
      standstill_.emplace([&to = hand->target](double t) { return vector_at(to, t); }, width);
    if (const auto* hand = dynamic_cast<const TrackingHand*>(parts.hand.get()))
      standstill_.emplace([hand](double) { return hand->intended(); }, width);
  }

  void on_step(const StepRecord& record) noexcept override {
    if (failure_) return;
    time_ = record.time;
    position_ = record.tool.pose.position;
    force_ = record.force.rendered;
    hand_force_ = record.hand_force;
    handle_velocity_ = record.handle.velocity;
    if (record.bears_contact()) last_contact_ = record.time;
    if (inside_) inside_->on_step(record);
    if (approach_) approach_->add(record, !last_contact_);
    if (progress_) progress_->add(record.time, record.tool.pose.position);
    if (standstill_) standstill_->add(record);
    if (passage_ends_ && has_passed()) {
      failure_ = FinalFailure{Outcome::went_through, record.time, record.step};
    } else if (leaving_ends_ && has_left_for_good(record)) {
      failure_ = FinalFailure{last_contact_ ? Outcome::lost_contact : Outcome::no_contact, record.time, record.step};
    }
  }
  const std::optional<FinalFailure>& final_failure() const noexcept override { return failure_; }
  bool has_passed() const noexcept override { return inside_ && inside_->has_passed(); }

  Outcome outcome(Ending ending) override {
    if (!approach_ || ending != Ending::completed) return outcome_of(ending);
    for (const Condition& condition : kConditions)
      if ((this->*condition.holds)()) return condition.outcome;
    return Outcome::completes;
  }

  std::vector<Warning> warnings(Outcome outcome) override {
    std::vector<Warning> warnings;
    if (!approach_) return warnings;
    for (const Condition& condition : kConditions) {
      if (condition.outcome != outcome) continue;
      if (std::string text = (this->*condition.text)(); !text.empty())
        warnings.push_back({std::string(outcome_name(outcome)), "", std::move(text)});
    }
    if (auto missed = missed_depth_warning(outcome)) warnings.push_back(std::move(*missed));
    if (drag_ == nullptr) return warnings;
    if (auto ends = short_path_warning(std::get<DragHandFields>(scenario_.hand), *drag_, time_, *tool_))
      warnings.push_back(std::move(*ends));
    return warnings;
  }

  double longest_step() const override { return approach_ ? approach_->longest_step() : 0.0; }
  OutcomeFacts facts() const override {
    if (!approach_) return {};
    return {inside_ && inside_->passage().began_inside,
            hapbench::scale_question(scenario_, *tool_, approach_->environment()), holding_friction()};
  }
  const InsideObserver* inside() const override { return inside_ ? &*inside_ : nullptr; }
  const InsideDepths* depths() override {
    if (inside_ && !depths_) depths_ = inside_->depths();
    return depths_ ? &*depths_ : nullptr;
  }

 private:
  /// A condition under which a run that made all its steps gets an outcome other than `completes`. `text` returns a
  /// warning that explains what happened and why; it may be empty.
  struct Condition {
    Outcome outcome;
    bool (OutcomeObserverImpl::*holds)();
    std::string (OutcomeObserverImpl::*text)();
  };
  static const Condition kConditions[5];  ///< the first condition that holds determines the outcome

  /// Returns the largest depth of any part of the tool inside the solid that the search after the run finds [m]; 0
  /// without a solid.
  double inside_max() {
    const InsideDepths* inside = depths();
    return inside != nullptr ? inside->searched.value_or(0.0) : 0.0;
  }

  /// Returns a warning if a recorded or measured depth is larger than the half width of the tool, but the search that
  /// decides the outcome found no such depth.
  std::optional<Warning> missed_depth_warning(Outcome outcome) {
    const InsideDepths* inside = depths();
    const double half_width = tool_->half_width();
    if (inside == nullptr || outcome == Outcome::went_through || outcome == Outcome::diverges) return std::nullopt;
    if (!(inside->max.value_or(0.0) > half_width) || inside_max() > half_width) return std::nullopt;
    return Warning{"missed_depth", "",
                   fmt::format("the tool was up to {} deep (inside_max_m), more than its half width of {}, but the "
                               "outcome is {}: the search that decides the outcome, whatever the run records, found "
                               "depths of up to {} only",
                               length_text(*inside->max), length_text(half_width), outcome_name(outcome),
                               length_text(inside->searched.value_or(0.0)))};
  }

  /// Returns true if a dragged tool ended without contact, and its last contact is longer ago than
  /// SettlingRule::time, so that another touch would count as a new landing.
  bool drag_lost() const {
    return drag_ != nullptr && drag_->drag().force(time_) > 0.0 && last_contact_ &&
           time_ - *last_contact_ >= SettlingRule().time;
  }
  std::optional<Stuck> stuck() const {
    if (progress_) return progress_->stuck();
    return standstill_ ? standstill_->stuck() : std::nullopt;
  }

  /// Returns OutcomeFacts::holding_friction.
  std::optional<double> holding_friction() const {
    constexpr double kAtRest = 1e-6;  // speed below which a handle stands still [m/s]
    // Smallest force of the hand that counts as a push, as a fraction of the friction.
    constexpr double kSmallestPush = 0.1;
    const auto* device = std::get_if<ImpedanceDeviceConfig>(&scenario_.device);
    if (device == nullptr || !(device->coulomb > 0.0) || last_contact_) return std::nullopt;
    const double push = hand_force_.cwiseAbs().maxCoeff();
    const bool is_held = push >= kSmallestPush * device->coulomb && push <= device->coulomb;
    return is_held && handle_velocity_.norm() < kAtRest ? std::optional(device->coulomb) : std::nullopt;
  }

  /// Returns true if, at the end, the hand's force points back towards the environment.
  bool hand_pushes_back() const {
    const Box& box = approach_->environment();
    const Vec3 outward = position_ - position_.cwiseMax(box.min).cwiseMin(box.max);
    return hand_force_.dot(outward) < 0.0;
  }
  /// Returns false if the spring of the hand ends before the surface: the target is nearer to the tool than the
  /// surface, at `distance` [m].
  bool can_arrive(double distance) const {
    const ImpedanceHandFields* spring = spring_of(scenario_.hand);
    return spring == nullptr || (vector_at(spring->target, time_) - position_).norm() >= distance;
  }

  /// Returns the most likely reason why the tool lost contact or never had contact. An uncertain reason is phrased as a
  /// question. `time_to_contact`: time in which the tool would reach the surface [s] (Approach::Closest). `distance`:
  /// smallest distance to the surface in the run [m].
  std::string likely_cause(const std::optional<double>& time_to_contact = {}, double distance = 0.0) const {
    constexpr double kMaxTimeToContact = 100.0;  // longest plausible time to contact, in durations of the run
    const double longest = approach_->longest_step();
    if (std::string question = scale_question(scenario_, *tool_, approach_->environment()); !question.empty())
      return question;
    if (longest > tool_->half_width()) {
      return fmt::format(
          "near the surface the tool moved by {} in one time step, more than its half width of {}: is time.step_s too "
          "long?",
          length_text(longest), length_text(tool_->half_width()));
    }
    if (last_contact_) {
      const bool is_constant = std::holds_alternative<ForceHandFields>(scenario_.hand) ||
                               std::holds_alternative<PushHandFields>(scenario_.hand);
      if (is_constant && !hand_pushes_back())
        return "the hand keeps pushing with a constant force where there is no surface";
      if (is_constant)
        return fmt::format("the force threw the tool against the hand's push: the largest force was {:.3g} N",
                           std::sqrt(metrics_->trial().force_max_squared));
      return fmt::format("the largest force was {:.3g} N", std::sqrt(metrics_->trial().force_max_squared));
    }
    if (time_to_contact && can_arrive(distance) &&
        *time_to_contact < kMaxTimeToContact * scenario_.time.step * static_cast<double>(scenario_.time.steps))
      return fmt::format("it was approaching at the end and would touch {:.2g} s later: is time.steps too small?",
                         *time_to_contact);
    if (!position_is_free(scenario_.motion)) return "is motion.position right?";
    if (const auto friction = holding_friction()) {
      return fmt::format(
          "the device's dry friction of {:.3g} N (device.coulomb_N) holds the handle against the hand's {:.3g} N: does "
          "the hand need a larger stiffness or force?",
          *friction, hand_force_.cwiseAbs().maxCoeff());
    }
    if (spring_of(scenario_.hand) != nullptr) return "does hand.target lead to the surface?";
    return std::holds_alternative<NoHandFields>(scenario_.hand)
               ? "nothing pushes the tool: is hand missing?"
               : "are initial.position_m and the hand's direction right?";
  }

  /// Returns true if the run can end before its last step with RunLength::until_failure.
  static bool can_fail_early(const Scenario& scenario) {
    return position_is_free(scenario.motion) && scenario.time.stop_when.empty() &&
           !std::holds_alternative<TrackingHandFields>(scenario.hand);
  }
  /// Returns true if only a constant force acts on a tool without contact. Returns false for a device that is not
  /// ideal, for contacts of a module or a recording, and for multi-rate contacts, force stages and passivity
  /// controllers, whose forces depend on earlier steps.
  static bool never_returns(const Scenario& scenario) {
    const RenderingConfig& rendering = scenario.rendering;
    const bool remembers = has_multi_rate_contacts(scenario) || rendering.force_stage || rendering.passivity_controller;
    if (!std::holds_alternative<IdealDeviceFields>(scenario.device) || has_external_contacts(scenario) || remembers)
      return false;
    if (const auto* force = std::get_if<ForceHandFields>(&scenario.hand))
      return std::ranges::all_of(force->force, &Profile::is_constant);
    if (const auto* push = std::get_if<PushHandFields>(&scenario.hand)) return push->force.is_constant();
    return std::holds_alternative<NoHandFields>(scenario.hand);
  }

  /// Returns true if the tool has left the environment for good. Precondition: never_returns(). A plane separates the
  /// tool from the environment's bounding box, and neither the velocity of the tool nor the force on the tool points
  /// towards this plane. Position and speed must stay far from the bounds at which the run would diverge.
  bool has_left_for_good(const StepRecord& record) const noexcept {
    if (!approach_ || !is_far() || record.colliding > 0 || !record.force.rendered.isZero(0.0)) return false;
    const Box& box = approach_->environment();
    const Vec3 outward = position_ - position_.cwiseMax(box.min).cwiseMin(box.max);
    const Vec3 &velocity = record.tool.velocity, &force = record.hand.input;
    if (velocity.dot(outward) < 0.0 || force.dot(outward) < 0.0) return false;
    constexpr double kFarFromBounds = 0.5;
    const DivergenceBounds& bounds = scenario_.bounds;
    const double rest = scenario_.time.step * static_cast<double>(scenario_.time.steps) - time_;
    const double last_speed = velocity.norm() + force.norm() / scenario_.rendering.mass * rest;
    return last_speed < kFarFromBounds * bounds.speed &&
           position_.norm() + last_speed * rest < kFarFromBounds * bounds.position;
  }
  /// Returns true if the tip centre is further from the environment's bounding box than the sum of the box's diagonal
  /// and the tool's extent.
  bool is_far() const noexcept { return approach_->distance() > diagonal(approach_->environment()) + tool_->reach(); }

  bool went_through() {
    if (has_passed()) return true;
    return inside_ && (inside_->passage().ends_inside || inside_max() > tool_->half_width());
  }
  std::string went_through_text() {
    std::string question = scale_question(scenario_, *tool_, approach_->environment());
    if (question.empty() && inside_->passage().began_inside) question = normals_question_;
    const char* const begins = inside_->passage().began_inside      ? "the tool started inside the environment"
                               : position_is_free(scenario_.motion) ? "the tool passed through the surface"
                                                                    : "the script moved the tool through the surface";
    return fmt::format("{}: {}{}{}", begins, passage_text(), question.empty() ? "" : "; ", question);
  }
  std::string passage_text() {
    const Passage& p = inside_->passage();
    const double half_width = tool_->half_width();
    const std::string end =
        failure_ ? fmt::format("the run ended there (--full continues it)")
        : p.left ? fmt::format("left it on another side at {:.4g} s at {}", p.left->time, position_text(p.left->point))
        : p.last_depth > 0.0 ? fmt::format("at the end it was {} below the surface", length_text(p.last_depth))
                             : std::string("at the end it was not below the surface");
    if (p.deep) {
      return fmt::format(
          "its tip centre was deeper below the surface than the half width of the tool, {}, at {:.4g} s at {}; largest "
          "depth {}; {}",
          length_text(half_width), p.deep->time, position_text(p.deep->point), length_text(p.deepest), end);
    }
    // In the remaining cases, the tip centre was never deeper than half the tool's width.
    if (p.left) return fmt::format("it entered the environment at {} and {}", position_text(p.entered), end);
    if (p.ends_inside) return fmt::format("the core of the tool ended inside the environment; its tip centre: {}", end);
    if (const auto& core = inside_->core_passage().event(); core && (failure_ || inside_max() <= half_width)) {
      return fmt::format("its axis {} at {:.4g} s, from {} to {}",
                         core->at_once ? "crossed the environment from face to face"
                                       : "entered the environment and left it on another side",
                         core->time, position_text(core->entered), position_text(core->left));
    }
    return fmt::format(
        "a part of the tool was {} deep, more than its half width of {}, although its tip centre was not",
        length_text(inside_max()), length_text(half_width));
  }

  bool never_touched() { return !last_contact_; }
  std::string never_touched_text() {
    const auto closest = approach_->closest_to_surface(*tool_);
    return fmt::format(
        "the tool never touched the environment: its smallest distance to the surface was {}{} (at {:.4g} s); "
        "environment {}; {}",
        closest.is_estimate ? "about " : "", length_text(closest.distance), closest.time, environment_text(),
        likely_cause(closest.time_to_contact, closest.distance));
  }

  /// Returns true if a tool that moves freely ended far from the environment (is_far()), or if a dragged tool left the
  /// surface (drag_lost()).
  bool lost_contact() { return (is_far() && position_is_free(scenario_.motion)) || drag_lost(); }
  std::string lost_contact_text() {
    if (drag_lost()) {
      const SurfacePoint foot = drag_->path().at(drag_->nearest());
      const double height = foot.normal.dot(position_ - foot.position);
      return fmt::format("the dragged tool lost contact with the surface at {:.4g} s and ended {} {}", *last_contact_,
                         length_text(std::abs(height)), height < 0.0 ? "below it, past an edge" : "above it");
    }
    const TrialContact& contact = metrics_->trial();
    const double share = static_cast<double>(contact.in_contact) / static_cast<double>(contact.rows);
    return fmt::format(
        "the tool was in contact for {:.3g} % of the run, last at {:.4g} s, and ended {} away from the environment "
        "({}); {}",
        100.0 * share, contact.last.value_or(0.0), length_text(approach_->distance()), environment_text(),
        likely_cause());
  }

  /// Returns true if a dragged tool advanced by less than its width, although it should have advanced by more than two
  /// widths. The metrics of such a run look good but do not describe a drag. If the tool follows the hand, it advances
  /// by more than its width, because the spring between hand and tool stretches by less than the tool's width.
  bool not_dragged() {
    const double width = 2.0 * tool_->half_width();
    return progress_ && progress_->progress() < width &&
           intended_drag_length(std::get<DragHandFields>(scenario_.hand), time_) > 2.0 * width;
  }
  std::string standstill_text() {
    const auto s = stuck();
    if (!s) return "";
    const char* const text =
        progress_
            ? "the tool hardly advanced along its path from {:.4g} s on: it advanced by {} while its target "
              "advanced by {}; at the end it was at {} with a force of {:.3g} N"
            : "the tool hardly moved from {:.4g} s on: it moved by {} while its target moved by {}; at the end it "
              "was at {} with a force of {:.3g} N";
    return fmt::format(fmt::runtime(text), s->since, length_text(s->tool_distance), length_text(s->target_distance),
                       position_text(position_), force_.norm());
  }

  bool is_stuck() { return stuck() || (progress_ && progress_->is_left_behind()); }
  std::string stuck_text() {
    if (stuck()) return standstill_text();
    std::string text = fmt::format(
        "the dragged tool ended {} behind the position to which its hand should have led it, {} along the path, at {}; "
        "a lag of up to {} counts as dragged",
        length_text(progress_->lag()), length_text(progress_->target_progress()), position_text(position_),
        length_text(progress_->tolerated_lag()));
    // If the tool still moves at the end of the run, it may only need more time to reach the target.
    const double speed = handle_velocity_.norm();
    const auto& hand = std::get<DragHandFields>(scenario_.hand);
    if (speed > kMinMovingFraction * hand.drag.speed)
      text += fmt::format(
          "; it still moved, at {:.2g} mm/s: {}", 1e3 * speed,
          hand.path
              ? "with more time after the end of the path (time.steps) it may arrive"
              : "with hand.path_m in place of hand.direction, and more time after the end of the path (time.steps), "
                "it may arrive");
    return text;
  }

  std::string environment_text() const {
    const Box& box = approach_->environment();
    return fmt::format("{}: {}", size_text(box), bounds_text(box));
  }

  const Scenario& scenario_;
  const MetricsObserver* metrics_;
  std::shared_ptr<const ToolShape> tool_;
  std::optional<InsideObserver> inside_;
  std::optional<InsideDepths> depths_;
  std::optional<Approach> approach_;
  std::optional<Standstill> standstill_;
  const DragHand* drag_;                  ///< null unless the hand drags the tool
  std::string normals_question_;          ///< normals_question() of the environment
  std::optional<DragProgress> progress_;  ///< progress of the drag; empty without a drag
  // Values in the last observed step.
  double time_ = 0.0;
  Vec3 position_ = Vec3::Zero(), force_ = Vec3::Zero();  ///< tip position [m]; rendered force [N]
  /// Force of the hand [N]; velocity of the handle [m/s].
  Vec3 hand_force_ = Vec3::Zero(), handle_velocity_ = Vec3::Zero();
  /// True if a passage (passage_ends_) or a loss of contact (leaving_ends_) is a FinalFailure of this run.
  bool passage_ends_ = false, leaving_ends_ = false;
  std::optional<FinalFailure> failure_;
  std::optional<double> last_contact_;  ///< time of the last step in contact [s]; empty before the first contact
};

constinit const OutcomeObserverImpl::Condition OutcomeObserverImpl::kConditions[] = {
    {Outcome::went_through, &OutcomeObserverImpl::went_through, &OutcomeObserverImpl::went_through_text},
    {Outcome::no_contact, &OutcomeObserverImpl::never_touched, &OutcomeObserverImpl::never_touched_text},
    {Outcome::lost_contact, &OutcomeObserverImpl::lost_contact, &OutcomeObserverImpl::lost_contact_text},
    {Outcome::not_dragged, &OutcomeObserverImpl::not_dragged, &OutcomeObserverImpl::standstill_text},
    {Outcome::stuck, &OutcomeObserverImpl::is_stuck, &OutcomeObserverImpl::stuck_text}};

}  // namespace

std::unique_ptr<OutcomeObserver> outcome_observer(const Scenario& scenario, const NamedFiles& files,
                                                  const SimulationParts& parts, const MetricsObserver* metrics,
                                                  RunLength length) {
  return std::make_unique<OutcomeObserverImpl>(scenario, files, parts, metrics, length);
}

}  // namespace hapbench
