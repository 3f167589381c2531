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
#include "scenarios/run/drag_course.hpp"
#include "scenarios/run/quantity_text.hpp"
#include "scenarios/run/scene_checks.hpp"
#include "scenarios/run/scene_distances.hpp"
#include "scenarios/run/scene_warnings.hpp"
#include "scenarios/run/standstill.hpp"
#include "scenarios/scene/environments.hpp"

namespace hapbench {
namespace {

std::string millimetres(const Vec3& place) {
  const Vec3 p = 1e3 * place;
  return fmt::format("({:.3g}, {:.3g}, {:.3g}) mm", p.x(), p.y(), p.z());
}

class OutcomeWatch final : public OutcomeObserver {
 public:
  OutcomeWatch(const Scenario& scenario, const NamedFiles& files, const SimulationParts& parts,
               const MetricsObserver* metrics)
      : scenario_(scenario),
        metrics_(metrics),
        tool_(parts.tool),
        drag_(dynamic_cast<const DragHand*>(parts.hand.get())) {
    const auto steps = static_cast<std::uint64_t>(scenario.time.steps);
    if (auto solid = make_solid(scenario, files)) {
      const std::int64_t every = scenario.record.inside ? scenario.record.every : 0;
      inside_.emplace(parts.tool, std::move(solid), metrics, static_cast<std::uint64_t>(every), steps);
    }
    if (parts.shell && parts.shell->size() > 0) approach_.emplace(parts.shell, steps);
    const double width = 2.0 * tool_->half_width();
    if (drag_ != nullptr) course_.emplace(*drag_, width, scenario.time.step * static_cast<double>(steps));
    if (const ImpedanceHandFields* hand = spring_of(scenario.hand);
        hand != nullptr && position_is_free(scenario.motion))
      standstill_.emplace([&to = hand->target](double t) { return Vec3(to[0](t), to[1](t), to[2](t)); }, width);
    if (const auto* hand = dynamic_cast<const TrackingHand*>(parts.hand.get()))
      standstill_.emplace([hand](double) { return hand->intended(); }, width);
  }

  void on_step(const StepRecord& record) noexcept override {
    time_ = record.time;
    place_ = record.tool.pose.position;
    force_ = record.force.rendered;
    if (record.colliding > 0) last_contact_ = record.time;
    if (inside_) inside_->on_step(record);
    if (approach_) approach_->add(record, !last_contact_);
    if (course_) course_->add(record.time);
    if (standstill_) standstill_->add(record);
  }

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
    if (drag_ == nullptr) return warnings;
    if (auto ends = short_path_warning(std::get<DragHandFields>(scenario_.hand), *drag_, time_, *tool_))
      warnings.push_back(std::move(*ends));
    return warnings;
  }

  double longest_step() const override { return approach_ ? approach_->longest_step() : 0.0; }
  const InsideObserver* inside() const override { return inside_ ? &*inside_ : nullptr; }
  const InsideDepths* depths() override {
    if (inside_ && !depths_) depths_ = inside_->depths();
    return depths_ ? &*depths_ : nullptr;
  }

 private:
  /// What makes another outcome of one that completes, and a warning of what happened and why, which may be empty.
  struct Condition {
    Outcome outcome;
    bool (OutcomeWatch::*holds)();
    std::string (OutcomeWatch::*text)();
  };
  static const Condition kConditions[5];  ///< the first that holds counts

  /// How deep any part of the tool was in any row; 0 without a solid [m].
  double inside_max() {
    const InsideDepths* inside = depths();
    return inside != nullptr ? inside->max.value_or(0.0) : 0.0;
  }

  /// True when a dragged tool had no contact in the end for so long that the next touch would be a landing.
  bool drag_lost() const {
    return drag_ != nullptr && drag_->drag().force(time_) > 0.0 && last_contact_ &&
           time_ - *last_contact_ >= SettlingRule().time;
  }
  std::optional<Stuck> stuck() const {
    if (course_) return course_->stuck();
    return standstill_ ? standstill_->stuck() : std::nullopt;
  }

  /// The likely cause, as a question where it is no more than likely, or where to look when none suggests itself.
  /// `rest`: the time to reach the surface that Approach::Closest has [s].
  std::string likely_cause(const std::optional<double>& rest = {}) const {
    constexpr double kMostRest = 100.0;  // times as long as the run
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
      if (is_constant) return "the hand keeps pushing with a constant force where there is no surface";
      return fmt::format("the largest force was {:.3g} N", std::sqrt(metrics_->trial().force_max_squared));
    }
    if (rest && *rest < kMostRest * scenario_.time.step * static_cast<double>(scenario_.time.steps))
      return fmt::format("it was approaching at the end and would touch {:.2g} s later: is time.steps too small?",
                         *rest);
    if (!position_is_free(scenario_.motion)) return "is motion.position right?";
    if (spring_of(scenario_.hand) != nullptr) return "does hand.target lead to the surface?";
    return std::holds_alternative<NoHandFields>(scenario_.hand) ? "nothing pushes the tool: is hand missing?"
                                                                : "is initial.position_m right?";
  }

  bool went_through() {
    return inside_ &&
           (inside_->passage().went_through() || inside_->core_passage().event() || inside_max() > tool_->half_width());
  }
  std::string went_through_text() {
    const bool is_scan = std::holds_alternative<MeshEnvironment>(scenario_.environment) ||
                         std::holds_alternative<PointShellEnvironment>(scenario_.environment);
    std::string question = scale_question(scenario_, *tool_, approach_->environment());
    if (question.empty() && is_scan && inside_->passage().began_inside)
      question = "are the normals of an open scan inverted (environment.flip_normals)?";
    const char* const begins = inside_->passage().began_inside      ? "the tool started inside the environment"
                               : position_is_free(scenario_.motion) ? "the tool passed through the surface"
                                                                    : "the script moved the tool through the surface";
    return fmt::format("{}: {}{}{}", begins, passage_text(), question.empty() ? "" : "; ", question);
  }
  std::string passage_text() {
    const Passage& p = inside_->passage();
    const double half_width = tool_->half_width();
    const std::string end =
        p.left ? fmt::format("left it on another side at {:.4g} s at {}", p.left->time, millimetres(p.left->place))
        : p.last_depth > 0.0 ? fmt::format("at the end it was {} below the surface", length_text(p.last_depth))
                             : std::string("at the end it was not below the surface");
    if (p.deep) {
      return fmt::format(
          "its tip centre was deeper below the surface than its half width, {}, at {:.4g} s at {}; largest depth {}; "
          "{}",
          length_text(half_width), p.deep->time, millimetres(p.deep->place), length_text(p.deepest), end);
    }
    if (p.left) return fmt::format("it entered the environment at {} and {}", millimetres(p.entered), end);
    if (p.ends_inside)
      return fmt::format("the core of the tool ended inside the environment; for the tip centre: {}", end);
    if (const auto& core = inside_->core_passage().event(); core && inside_max() <= half_width) {
      return fmt::format("its axis {} at {:.4g} s, from {} to {}",
                         core->at_once ? "crossed it from face to face" : "entered it and left on another side",
                         core->time, millimetres(core->entered), millimetres(core->left));
    }
    return fmt::format(
        "a part of the tool was {} deep, more than its half width of {}, although its tip centre was not",
        length_text(inside_max()), length_text(half_width));
  }

  bool never_touched() { return !last_contact_; }
  std::string never_touched_text() {
    const auto closest = approach_->closest_to_surface(*tool_);
    return fmt::format(
        "the tool never touched the environment: its smallest distance to the surface was {} (at {:.4g} s); "
        "environment {}; {}",
        length_text(closest.distance), closest.time, environment_text(), likely_cause(closest.rest));
  }

  /// As a tool that was thrown out or pushed past, or a dragged one past an edge.
  bool lost_contact() {
    const bool is_far = approach_->distance() > diagonal(approach_->environment()) + tool_->reach();
    return (is_far && position_is_free(scenario_.motion)) || drag_lost();
  }
  std::string lost_contact_text() {
    if (drag_lost()) {
      const SurfacePoint foot = drag_->path().at(drag_->nearest());
      const double height = foot.normal.dot(place_ - foot.position);
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

  /// Its calm numbers tell nothing of a drag. The spring that leads a tool which follows lags by less.
  bool not_dragged() {
    const double width = 2.0 * tool_->half_width();
    return course_ && course_->way() < width &&
           way_to_cover(std::get<DragHandFields>(scenario_.hand), time_) > 2.0 * width;
  }
  std::string stands_text() {
    const auto s = stuck();
    if (!s) return "";
    return fmt::format(
        "the tool stood still from {:.4g} s on: it moved by {} while its target moved by {}; at the end it was at {} "
        "with a force of {:.3g} N",
        s->since, length_text(s->way), length_text(s->target_way), millimetres(place_), force_.norm());
  }

  bool is_stuck() { return stuck() || (course_ && course_->left_behind()); }
  std::string stuck_text() {
    if (stuck()) return stands_text();
    return fmt::format(
        "the dragged tool ended {} behind the position to which its hand should have led it, {} along the path, at {}",
        length_text(*course_->left_behind()), length_text(course_->asked()), millimetres(place_));
  }

  std::string environment_text() const {
    const Box& box = approach_->environment();
    return fmt::format("{}: {}", size_text(box), place_text(box));
  }

  const Scenario& scenario_;
  const MetricsObserver* metrics_;
  std::shared_ptr<const ToolShape> tool_;
  std::optional<InsideObserver> inside_;
  std::optional<InsideDepths> depths_;
  std::optional<Approach> approach_;
  std::optional<Standstill> standstill_;
  const DragHand* drag_;              ///< null unless one drags the tool
  std::optional<DragCourse> course_;  ///< of that
  // In the last row.
  double time_ = 0.0;
  Vec3 place_ = Vec3::Zero(), force_ = Vec3::Zero();  ///< of the tip [m]; rendered [N]
  std::optional<double> last_contact_;                ///< time of the last row with a colliding point
};

constinit const OutcomeWatch::Condition OutcomeWatch::kConditions[] = {
    {Outcome::went_through, &OutcomeWatch::went_through, &OutcomeWatch::went_through_text},
    {Outcome::no_contact, &OutcomeWatch::never_touched, &OutcomeWatch::never_touched_text},
    {Outcome::lost_contact, &OutcomeWatch::lost_contact, &OutcomeWatch::lost_contact_text},
    {Outcome::not_dragged, &OutcomeWatch::not_dragged, &OutcomeWatch::stands_text},
    {Outcome::stuck, &OutcomeWatch::is_stuck, &OutcomeWatch::stuck_text}};

}  // namespace

std::unique_ptr<OutcomeObserver> outcome_observer(const Scenario& scenario, const NamedFiles& files,
                                                  const SimulationParts& parts, const MetricsObserver* metrics) {
  return std::make_unique<OutcomeWatch>(scenario, files, parts, metrics);
}

}  // namespace hapbench
