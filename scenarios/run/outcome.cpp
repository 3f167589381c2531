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

#include "device_model/hands/drag_hand.hpp"
#include "device_model/hands/tracking_hand.hpp"
#include "results/observe/contact_forces.hpp"
#include "scenarios/run/scene_checks.hpp"
#include "sim/contact/grid_index.hpp"

namespace hapbench {
namespace {

std::string millimetres(const Vec3& place) {
  const Vec3 p = 1e3 * place;
  return fmt::format("({:.3g}, {:.3g}, {:.3g}) mm", p.x(), p.y(), p.z());
}

/// Notes when the tool touches an open mesh where it ends. Beyond such an edge there is nothing to touch, and a tool
/// that reaches past it is held by too few points or by none.
class OpenEdges {
 public:
  /// A point of the shell counts as near an edge if it lies within `reach` [m] of one of `edges`, the middles of the
  /// boundary edges, along each coordinate. O(n) and the points near edges.
  OpenEdges(const PointShell& shell, const std::vector<Vec3>& edges, double reach)
      : reach_(reach), is_near_edge_(shell.size(), false) {
    const GridIndex grid(shell);
    const Vec3 half = Vec3::Constant(reach);
    for (const Vec3& edge : edges) {
      const Box box{edge - half, edge + half};
      grid.for_each_run(box, [&](std::uint32_t first, std::uint32_t last) {
        for (std::uint32_t i = first; i < last; ++i) {
          const Vec3 point(grid.x()[i], grid.y()[i], grid.z()[i]);
          if (distance_to(box, point) == 0.0) is_near_edge_[grid.shell_index(i)] = true;
        }
      });
    }
  }

  void add(const StepRecord& record) noexcept {
    const ContactBuffer& contacts = *record.rendered;
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      if (!is_near_edge_[contacts.index[i]]) continue;
      if (rows_++ == 0) first_ = {record.time, contacts.point(i)};
      return;
    }
  }

  /// With the first contact at such a point; none when there was none.
  std::optional<Warning> warning() const {
    if (rows_ == 0) return std::nullopt;
    return Warning{
        "open_edge", "",
        fmt::format("touched the mesh within {} of where it is open in {} rows, first at {:.4g} s near {}: beyond "
                    "the edge there is no surface",
                    length_text(reach_), rows_, first_.time, millimetres(first_.place))};
  }

 private:
  double reach_;
  std::vector<bool> is_near_edge_;  ///< of each point of the shell
  std::uint64_t rows_ = 0;          ///< with such a contact
  Passage::Event first_{};
};

Vec3 target_at(const ImpedanceHandFields& hand, double time) {
  return {hand.target[0](time), hand.target[1](time), hand.target[2](time)};
}

/// The least distance of the target of a hand's spring from the environment, at a thousand and one times of the run.
double closest_target(const ImpedanceHandFields& hand, const TimeFields& time, const Box& environment) {
  constexpr int kLooks = 1000;
  double closest = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= kLooks; ++i) {
    const double t = time.step * static_cast<double>(time.steps) * i / kLooks;
    closest = std::min(closest, distance_to(environment, target_at(hand, t)));
  }
  return closest;
}

/// The way of the tip centre near the environment, and how close a tool came that touches nothing. A row costs some
/// nanoseconds; the distances from the surface itself are looked up after the run.
class Approach {
 public:
  /// The shell has points; the run has at most so many steps.
  Approach(std::shared_ptr<const PointShell> shell, std::uint64_t steps)
      : shell_(std::move(shell)), environment_(shell_->bounds()), every_(steps / kLooks + 1) {
    looks_.reserve(kLooks);
  }

  /// `looks`: the tool has touched nothing yet.
  void add(const StepRecord& record, bool looks) noexcept {
    const Vec3& place = record.tool.pose.position;
    const double way = (place - place_).norm();
    if (distance_ <= way && std::isfinite(way)) longest_step_ = std::max(longest_step_, way);
    place_ = place;
    distance_ = distance_to(environment_, place);
    if (!looks) return;
    const Look look{record.time, distance_, record.tool.pose};
    if (record.step % every_ == 0) {
      looks_.push_back(look);
    } else if (look.from_box <= looks_.back().from_box) {
      looks_.back() = look;
    }
  }

  double longest_step() const { return longest_step_; }  ///< OutcomeObserver::longest_step [m]
  double distance() const { return distance_; }          ///< in the last row from the box; 0 within it [m]
  const Box& environment() const { return environment_; }
  /// Of the tip centre to the environment's box before the first contact; 0 within it [m].
  double closest_to_box() const { return std::ranges::min(looks_, {}, &Look::from_box).from_box; }

  struct Closest {
    double distance, time;  ///< of the tool from the nearest point [m], and when [s]
  };
  /// In up to 256 rows before the first contact, of as many parts of the run those closest to the environment's box;
  /// within a hundredth of the distance in these.
  Closest closest_to_surface(const ToolShape& tool) const {
    constexpr double kWithin = 0.99;
    Closest closest{std::numeric_limits<double>::infinity(), 0.0};
    const Look* before = nullptr;
    double gap = 0.0;
    for (const Look& look : looks_) {
      // No point of the tool comes closer than it moves.
      if (before != nullptr && gap - tool.moved_at_most(before->pose, look.pose) > kWithin * closest.distance) continue;
      before = &look;
      gap = gap_between(tool, look.pose, *shell_).distance;
      if (gap < closest.distance) closest = {gap, look.time};
    }
    return closest;
  }

 private:
  static constexpr std::size_t kLooks = 256;
  struct Look {
    double time, from_box;
    ToolPose pose;
  };
  std::shared_ptr<const PointShell> shell_;
  Box environment_;
  Vec3 place_ = Vec3::Zero();  ///< in the last row
  double distance_ = std::numeric_limits<double>::infinity(), longest_step_ = 0.0;
  std::uint64_t every_;
  std::vector<Look> looks_;
};

/// A tool stands while it comes less than this share of the way that its target goes.
constexpr double kMovingShare = 0.1;

/// A tool that stood still to the end while the target of its hand went on.
struct Stuck {
  double since = 0.0;                  ///< [s]
  double way = 0.0, target_way = 0.0;  ///< of tool and target from then on [m]
};

/// Follows a dragged tool on the path along which it is led.
class DragCourse {
 public:
  /// The hand must outlive it. `width`: the tool's [m]; `duration`: of the run [s].
  DragCourse(const DragHand& hand, double width, double duration)
      : hand_(hand), width_(width), half_way_(0.5 * std::min(hand.drag().speed * duration, hand.path().length())) {}

  void add(double time) noexcept {
    now_ = {time, std::min(hand_.drag().speed * time, hand_.path().length()), std::max(now_.way, hand_.nearest())};
    behind_ = now_.asked - hand_.nearest();
    if (now_.asked <= half_way_) behind_at_half_way_ = behind_;
    if (now_.asked < static_cast<double>(stand_) * width_ / kStands) return;
    const Stand before = std::exchange(stands_[stand_ % kStands], now_);
    if (stand_++ < kStands) return;
    if (now_.way - before.way >= kMovingShare * (now_.asked - before.asked)) {
      stuck_.reset();
    } else if (!stuck_) {
      stuck_ = before;
    }
  }

  /// From when on the tool came less than a tenth of the way of the point that leads it, over every width of its own
  /// that the point went on.
  std::optional<Stuck> stuck() const {
    if (!stuck_) return std::nullopt;
    return Stuck{stuck_->time, now_.way - stuck_->way, now_.asked - stuck_->asked};
  }
  double way() const { return now_.way; }      ///< furthest that the tool came on the path [m]
  double asked() const { return now_.asked; }  ///< how far its hand led it [m]
  /// How far the tool ended behind where its hand led it [m], if that is further than a tenth of the way and than the
  /// tool's half width. None where it had been half as far behind at half way: friction holds a tool back by as much as
  /// the hand's spring gives, and it comes along.
  std::optional<double> left_behind() const {
    const double most = std::max({kMovingShare * now_.asked, 0.5 * width_, 2.0 * behind_at_half_way_});
    return behind_ > most ? std::optional(behind_) : std::nullopt;
  }

 private:
  /// The point's and the tool's way at a time.
  struct Stand {
    double time = 0.0, asked = 0.0, way = 0.0;
  };
  static constexpr std::size_t kStands = 4;
  const DragHand& hand_;
  double width_, half_way_;                         ///< [m]
  double behind_ = 0.0, behind_at_half_way_ = 0.0;  ///< the point that leads it [m]
  Stand now_;
  std::array<Stand, kStands> stands_{};  ///< a quarter of the tool's width of the point's way apart
  std::size_t stand_ = 0;                ///< how many there were
  std::optional<Stand> stuck_;           ///< where it came to stand for good
};

/// Finds a tool that the spring of a hand, or of a subject that aims at an intended position, cannot move. A spring
/// whose target goes into the surface only presses the tool on it. The tool is therefore stuck only if the target came
/// away from it by more than its width across the direction in which the springs of the contacts push.
class Standstill {
 public:
  /// `target`: of the spring, at the time of the row that was the last [s]. `width`: the tool's [m].
  Standstill(std::function<Vec3(double)> target, double width) : target_(std::move(target)), width_(width) {}

  void add(const StepRecord& record) noexcept {
    constexpr double kRows = 1 / 32.0;  // of a mean over some rows, which chatter does not turn
    const Vec3& place = record.tool.pose.position;
    const Vec3 target = target_(record.time);
    // Before the first touch nothing tells the direction of the push: how far away the target was then does not count.
    if (push_.isZero(0.0)) across_ = 0.0;
    push_ += kRows * (record.force.spring - push_);
    const auto extend = [](Box& box, const Vec3& p) {
      box = {box.min.cwiseMin(p), box.max.cwiseMax(p)};
      return diagonal(box);
    };
    stuck_.way = extend(ways_, place);
    stuck_.target_way = extend(target_ways_, target);
    if (!began_ || stuck_.way > kMovingShare * std::max(width_, stuck_.target_way)) {
      began_ = true;
      ways_ = {place, place};
      target_ways_ = {target, target};
      across_ = stuck_.way = stuck_.target_way = 0.0;
      stuck_.since = record.time;
    }
    Vec3 across = target - place;
    if (const double push2 = push_.squaredNorm(); push2 > 0.0) across -= across.dot(push_) / push2 * push_;
    across_ = std::max(across_, across.norm());
  }

  /// None where the tool moves in the end, or its target does not.
  std::optional<Stuck> stuck() const {
    return stuck_.target_way > width_ && across_ > width_ ? std::optional(stuck_) : std::nullopt;
  }

 private:
  std::function<Vec3(double)> target_;
  double width_;
  Vec3 push_ = Vec3::Zero();  ///< spring force, its mean over the last rows [N]
  Box ways_, target_ways_;    ///< around the places of tool and target since it stands
  double across_ = 0.0;       ///< furthest that the target was from the tool across the push since then [m]
  bool began_ = false;
  Stuck stuck_;
};

/// How a tool passed the surface, as one sentence.
std::string passage_text(const InsideObserver& inside, double half_width, double inside_max, bool is_led) {
  const Passage& p = inside.passage();
  const char* const begins = p.began_inside ? "the tool began inside the environment"
                             : is_led       ? "the script led the tool through the surface"
                                            : "the tool went through the surface";
  const std::string end =
      p.left ? fmt::format("left on another side at {:.4g} s at {}", p.left->time, millimetres(p.left->place))
      : p.last_depth > 0.0 ? fmt::format("{} below it in the end", length_text(p.last_depth))
                           : std::string("not below it in the end");
  if (p.deep) {
    return fmt::format(
        "{}: its tip centre was more than its half width, {}, below it at {:.4g} s at {}, {} at most, and {}", begins,
        length_text(half_width), p.deep->time, millimetres(p.deep->place), length_text(p.deepest), end);
  }
  if (p.left) {
    return fmt::format("{}: it entered at {} and left on another side, at {:.4g} s at {}", begins,
                       millimetres(p.entered), p.left->time, millimetres(p.left->place));
  }
  if (p.ends_inside) return fmt::format("{}: its core ended inside, its tip centre {}", begins, end);
  if (const auto& core = inside.core_passage().event(); core && inside_max <= half_width) {
    return fmt::format("{}: its axis {} at {:.4g} s, from {} to {}", begins,
                       core->at_once ? "crossed it from face to face" : "entered it and left on another side",
                       core->time, millimetres(core->entered), millimetres(core->left));
  }
  return fmt::format("{}: a part of it was {} inside, more than its half width of {}, though its tip centre was not",
                     begins, length_text(inside_max), length_text(half_width));
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
    if (metrics != nullptr && approach_ && std::holds_alternative<MeshEnvironment>(scenario.environment) &&
        scenario.rendering.contact_source == kOwnContacts) {
      if (const auto& edges = files.at(kEnvironmentFile).mesh().open_edges(); !edges.empty())
        open_edges_.emplace(*parts.shell, edges, tool_->half_width());
    }
    const double width = 2.0 * tool_->half_width();
    if (drag_ != nullptr) course_.emplace(*drag_, width, scenario.time.step * static_cast<double>(steps));
    if (const ImpedanceHandFields* hand = spring_of(scenario.hand);
        hand != nullptr && position_is_free(scenario.motion))
      standstill_.emplace([hand](double time) { return target_at(*hand, time); }, width);
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
    if (open_edges_) open_edges_->add(record);
  }

  Outcome outcome(Outcome outcome) override {
    if (!approach_ || outcome != Outcome::completes) return outcome;
    for (const Condition& condition : kConditions) {
      if ((this->*condition.holds)()) return condition.outcome;
    }
    return outcome;
  }

  std::vector<Warning> warnings(Outcome outcome) override {
    std::vector<Warning> warnings;
    const auto add = [&warnings](std::optional<Warning> warning) {
      if (warning) warnings.push_back(std::move(*warning));
    };
    if (const InsideDepths* inside = depths(); inside != nullptr && inside->at_most) {
      add(Warning{"inside_bound", "",
                  fmt::format("inside_max_m, {}, may be too low: no row is deeper than {}; record.inside=true looks "
                              "at every row",
                              length_text(inside_max()), length_text(*inside->at_most))});
    }
    if (!approach_) return warnings;
    for (const Condition& condition : kConditions) {
      if (condition.outcome != outcome) continue;
      auto warning = (this->*condition.warning)();
      if (warning)
        warning->kind = std::string(outcome_name(outcome)) + (warning->kind.empty() ? "" : " ") + warning->kind;
      add(std::move(warning));
    }
    if (drag_lost() && outcome != Outcome::went_through) add(drag_lost_warning());
    if (drag_ != nullptr) add(drag_short_warning());
    if (std::holds_alternative<MeshToolFields>(scenario_.tool))
      add(scale_warning(scenario_, *tool_, approach_->environment()));
    if (open_edges_) add(open_edges_->warning());
    return warnings;
  }

  double longest_step() const override { return approach_ ? approach_->longest_step() : 0.0; }
  const InsideObserver* inside() const override { return inside_ ? &*inside_ : nullptr; }
  const InsideDepths* depths() override {
    if (inside_ && !depths_) depths_ = inside_->depths();
    return depths_ ? &*depths_ : nullptr;
  }

 private:
  /// What makes another outcome of one that completes, and a warning that says what happened and the likely cause. The
  /// kind of that is the outcome and what the warning has as its kind. The diagnosis says what to try.
  struct Condition {
    Outcome outcome;
    bool (OutcomeWatch::*holds)();
    std::optional<Warning> (OutcomeWatch::*warning)();
  };
  static const Condition kConditions[5];  ///< the first that holds counts

  /// How deep any part of the tool was in any row; 0 without a solid [m].
  double inside_max() {
    const InsideDepths* inside = depths();
    return inside != nullptr ? inside->max.value_or(0.0) : 0.0;
  }

  /// The way along which the hand has led the tool by the last row [m].
  double drag_way_asked() const { return way_to_cover(std::get<DragHandFields>(scenario_.hand), time_); }
  /// True when a dragged tool had no contact in the end for so long that the next touch would be a landing.
  bool drag_lost() const {
    return drag_ != nullptr && drag_->drag().force(time_) > 0.0 && last_contact_ &&
           time_ - *last_contact_ >= SettlingRule().time;
  }
  Warning drag_lost_warning() const {
    const SurfacePoint foot = drag_->path().at(drag_->nearest());
    const double height = foot.normal.dot(place_ - foot.position);
    return {"drag_lost", "",
            fmt::format("the dragged tool lost the surface at {:.4g} s and ended {} {}", *last_contact_,
                        length_text(std::abs(height)), height < 0.0 ? "below it, past an edge" : "above it")};
  }
  /// Of a path that ends early.
  std::optional<Warning> drag_short_warning() const {
    auto ends = short_path_warning(std::get<DragHandFields>(scenario_.hand), drag_->path().length(), drag_way_asked(),
                                   2.0 * tool_->half_width());
    if (ends)
      ends->text +=
          fmt::format("; the tool was at [{:.4g}, {:.4g}, {:.4g}] m in the end", place_.x(), place_.y(), place_.z());
    return ends;
  }

  std::optional<Stuck> stuck() const {
    if (course_) return course_->stuck();
    return standstill_ ? standstill_->stuck() : std::nullopt;
  }

  /// A likely cause, or where to look when none suggests itself: its kind, and the end of a sentence.
  std::pair<const char*, std::string> likely_cause(Outcome outcome) const {
    const Box& environment = approach_->environment();
    const double longest = approach_->longest_step();
    if (std::string question = scale_question(scenario_, *tool_, environment); !question.empty())
      return {"scale", std::move(question)};
    if (longest > tool_->half_width()) {
      return {"step",
              fmt::format("near it the tool moved {} in one step, more than its half width of {}: is time.step_s "
                          "too long?",
                          length_text(longest), length_text(tool_->half_width()))};
    }
    const auto* mesh = std::get_if<MeshEnvironment>(&scenario_.environment);
    if (outcome == Outcome::no_contact && mesh != nullptr && !mesh->spacing && approach_->closest_to_box() == 0.0)
      return {"spacing", "only the mesh's vertices can be touched: is environment.spacing_m missing?"};
    const bool recorded = std::holds_alternative<RecordedPosition>(scenario_.motion.position);
    if (recorded && outcome == Outcome::no_contact && approach_->closest_to_box() > kUnitsApart * diagonal(environment))
      return {"recording", "are the positions of motion.position.file in metres?"};
    if (const ImpedanceHandFields* hand = spring_of(scenario_.hand)) {
      const double closest = closest_target(*hand, scenario_.time, environment);
      if (closest > 0.0)
        return {"target",
                fmt::format("hand.target stays {} away from it: does it lead to the surface?", length_text(closest))};
    }
    const bool is_free = position_is_free(scenario_.motion);
    if (is_free && std::holds_alternative<NoHandFields>(scenario_.hand) && outcome == Outcome::no_contact)
      return {"no_hand", "nothing pushes the tool: is hand missing?"};
    if (outcome == Outcome::lost_contact && (std::holds_alternative<ForceHandFields>(scenario_.hand) ||
                                             std::holds_alternative<PushHandFields>(scenario_.hand)))
      return {"constant_force", "a hand of constant force goes on pushing where there is no surface"};
    if (outcome == Outcome::lost_contact)
      return {"force", fmt::format("the largest force was {:.3g} N", std::sqrt(metrics_->trial().force_max_squared))};
    return {"start", is_free ? "is initial.position_m right?" : "is motion.position right?"};
  }

  bool went_through() {
    return inside_ &&
           (inside_->passage().went_through() || inside_->core_passage().event() || inside_max() > tool_->half_width());
  }
  std::optional<Warning> went_through_warning() {
    const std::string question = scale_question(scenario_, *tool_, approach_->environment());
    return Warning{"", "",
                   passage_text(*inside_, tool_->half_width(), inside_max(), !position_is_free(scenario_.motion)) +
                       (question.empty() ? "" : "; " + question)};
  }

  bool never_touched() { return !last_contact_; }
  std::optional<Warning> never_touched_warning() {
    const auto closest = approach_->closest_to_surface(*tool_);
    const auto [cause, question] = likely_cause(Outcome::no_contact);
    return Warning{cause, "",
                   fmt::format("never in contact: the tool came as close as {} (at {:.4g} s) to the surface of the "
                               "environment ({}); {}",
                               length_text(closest.distance), closest.time, environment_text(), question)};
  }

  /// As a tool that was thrown out or pushed past, or a dragged one past an edge.
  bool lost_contact() {
    const bool is_far = approach_->distance() > diagonal(approach_->environment()) + tool_->reach();
    return (is_far && position_is_free(scenario_.motion)) || drag_lost();
  }
  std::optional<Warning> lost_contact_warning() {
    const double away = approach_->distance();
    if (drag_lost() && away == 0.0) return std::nullopt;  // drag_lost_warning says all
    const TrialContact& contact = metrics_->trial();
    const double share = static_cast<double>(contact.in_contact) / static_cast<double>(contact.rows);
    const auto [cause, question] = likely_cause(Outcome::lost_contact);
    return Warning{
        cause, "",
        fmt::format("in contact for {:.3g} % of the run, last at {:.4g} s; ended {} away from the "
                    "environment ({}); {}",
                    100.0 * share, contact.last.value_or(0.0), length_text(away), environment_text(), question)};
  }

  /// It was pressed on the surface, and its calm numbers tell nothing of a drag. The spring that leads a tool which
  /// follows lags by less.
  bool not_dragged() {
    const double width = 2.0 * tool_->half_width();
    return course_ && course_->way() < width && drag_way_asked() > 2.0 * width;
  }
  std::optional<Warning> stands_warning() {
    const auto s = stuck();
    if (!s) return std::nullopt;
    return Warning{
        "", "",
        fmt::format("the tool stood still since {:.4g} s, coming {} further while its target went on by {}; "
                    "it was at {} under a force of {:.3g} N in the end",
                    s->since, length_text(s->way), length_text(s->target_way), millimetres(place_), force_.norm())};
  }

  bool is_stuck() { return stuck() || (course_ && course_->left_behind()); }
  std::optional<Warning> stuck_warning() {
    if (stuck()) return stands_warning();
    return Warning{
        "", "",
        fmt::format("the dragged tool ended {} behind where its hand led it, {} along the path, at {}",
                    length_text(*course_->left_behind()), length_text(course_->asked()), millimetres(place_))};
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
  std::optional<OpenEdges> open_edges_;  ///< where contacts are numbered as the points of an open mesh
  const DragHand* drag_;                 ///< null unless one drags the tool
  std::optional<DragCourse> course_;     ///< of that
  // In the last row.
  double time_ = 0.0;
  Vec3 place_ = Vec3::Zero(), force_ = Vec3::Zero();  ///< of the tip [m]; rendered [N]
  std::optional<double> last_contact_;                ///< time of the last row with a colliding point
};

constinit const OutcomeWatch::Condition OutcomeWatch::kConditions[] = {
    {Outcome::went_through, &OutcomeWatch::went_through, &OutcomeWatch::went_through_warning},
    {Outcome::no_contact, &OutcomeWatch::never_touched, &OutcomeWatch::never_touched_warning},
    {Outcome::lost_contact, &OutcomeWatch::lost_contact, &OutcomeWatch::lost_contact_warning},
    {Outcome::not_dragged, &OutcomeWatch::not_dragged, &OutcomeWatch::stands_warning},
    {Outcome::stuck, &OutcomeWatch::is_stuck, &OutcomeWatch::stuck_warning}};

}  // namespace

std::unique_ptr<OutcomeObserver> outcome_observer(const Scenario& scenario, const NamedFiles& files,
                                                  const SimulationParts& parts, const MetricsObserver* metrics) {
  return std::make_unique<OutcomeWatch>(scenario, files, parts, metrics);
}

}  // namespace hapbench
