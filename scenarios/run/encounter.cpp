#include "scenarios/run/encounter.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "scenarios/run/quantity_text.hpp"

namespace hapbench {
namespace {

/// An environment this much smaller than the tool is thick, or larger than it is long, is suspect: scenes are made of
/// tools and places to work on, and millimetres taken for metres change either a thousandfold.
constexpr double kTooSmall = 0.1, kTooLarge = 100.0;

double diagonal(const Box& box) {
  return (box.max - box.min).norm();
}

bool out_of_proportion(const ToolShape& tool, const Box& environment) {
  const double size = diagonal(environment);
  return size < kTooSmall * 2.0 * tool.half_width() || size > kTooLarge * tool.reach();
}

std::string scale_question(const Scenario& scenario) {
  if (std::holds_alternative<MeshToolFields>(scenario.tool)) return "are tool.scale and the environment's size right?";
  if (std::holds_alternative<MeshEnvironment>(scenario.environment)) return "is environment.scale right?";
  if (std::holds_alternative<PointShellEnvironment>(scenario.environment))
    return "are the points of environment.file in metres?";
  return "are the sizes of environment in metres?";
}

/// How close the target of a hand's spring comes to the environment, looked at a thousand times.
double closest_target(const ImpedanceHandFields& hand, const TimeFields& time, const Box& environment) {
  constexpr int kLooks = 1000;
  double closest = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= kLooks; ++i) {
    const double t = time.step * static_cast<double>(time.steps) * i / kLooks;
    const Vec3 target(hand.target[0](t), hand.target[1](t), hand.target[2](t));
    closest = std::min(closest, distance_to(environment, target));
  }
  return closest;
}

/// The likely cause as the end of a sentence, or where to look when none suggests itself.
std::string likely_cause(const Scenario& scenario, Outcome outcome, const Encounter& e) {
  const double size = diagonal(e.environment);
  if (out_of_proportion(e.tool, e.environment)) return "; " + scale_question(scenario);
  const auto* mesh = std::get_if<MeshEnvironment>(&scenario.environment);
  if (outcome == Outcome::no_contact && mesh != nullptr && !mesh->spacing && e.approach.closest == 0.0)
    return "; only the mesh's vertices can be touched: is environment.spacing_m missing?";
  const bool recorded = std::holds_alternative<RecordedPosition>(scenario.motion.position);
  if (recorded && e.approach.closest > kTooLarge * size)
    return "; are the positions of motion.position.file in metres?";
  if (const ImpedanceHandFields* hand = spring_of(scenario.hand)) {
    const double closest = closest_target(*hand, scenario.time, e.environment);
    if (closest > 0.0)
      return fmt::format("; hand.target stays {} away from it: does it lead to the surface?", length_text(closest));
  }
  const bool is_free = std::holds_alternative<FreePosition>(scenario.motion.position);
  if (is_free && std::holds_alternative<NoHandFields>(scenario.hand) && outcome == Outcome::no_contact)
    return "; nothing pushes the tool: is hand missing?";
  if (outcome == Outcome::lost_contact &&
      (std::holds_alternative<ForceHandFields>(scenario.hand) || std::holds_alternative<PushHandFields>(scenario.hand)))
    return "; a hand of constant force goes on pushing where there is no surface";
  if (outcome == Outcome::lost_contact) return fmt::format("; the largest force was {:.3g} N", e.metrics.force_max);
  return is_free ? "; is initial.position_m right?" : "; is motion.position right?";
}

std::string size_and_place(const Box& box) {
  return fmt::format("{}: {}", size_text(box), place_text(box));
}

}  // namespace

Outcome outcome_of(const Scenario& scenario, const Encounter& e) {
  if (e.metrics.steps_in_contact == 0) return Outcome::no_contact;
  const bool is_free = std::holds_alternative<FreePosition>(scenario.motion.position);
  const bool left = e.approach.last > diagonal(e.environment) + e.tool.reach();
  const bool lost = e.drag && e.drag->lost;
  if ((is_free && left) || lost) return Outcome::lost_contact;
  return e.drag && e.drag->not_dragged() ? Outcome::not_dragged : Outcome::completes;
}

std::optional<std::string> scale_warning(const Scenario& scenario, const ToolShape& tool, const Box& environment) {
  if (!std::holds_alternative<MeshToolFields>(scenario.tool) || !out_of_proportion(tool, environment))
    return std::nullopt;
  return fmt::format("the tool is {} thick and reaches {}, the environment is {}: {}",
                     length_text(2.0 * tool.half_width()), length_text(tool.reach()), size_text(environment),
                     scale_question(scenario));
}

std::optional<std::string> warning_about(const Scenario& scenario, Outcome outcome, const Encounter& e) {
  if (outcome == Outcome::no_contact) {
    return fmt::format("never in contact: the tip came as close as {} (at {:.4g} s) to the environment ({}){}",
                       length_text(e.approach.closest), e.approach.closest_time, size_and_place(e.environment),
                       likely_cause(scenario, outcome, e));
  }
  if (outcome != Outcome::lost_contact || (e.drag && e.drag->lost && e.approach.last == 0.0)) return std::nullopt;
  const double share = static_cast<double>(e.metrics.steps_in_contact) / static_cast<double>(e.metrics.rows);
  return fmt::format("in contact for {:.3g} % of the run, last at {:.4g} s; ended {} away from the environment ({}){}",
                     100.0 * share, e.metrics.last_contact.value_or(0.0), length_text(e.approach.last),
                     size_and_place(e.environment), likely_cause(scenario, outcome, e));
}

}  // namespace hapbench
