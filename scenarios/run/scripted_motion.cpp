#include "scenarios/run/scripted_motion.hpp"
#include "scenarios/scene/scenario.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <span>
#include <variant>

namespace hapbench {
namespace {

constexpr double kAlways = std::numeric_limits<double>::infinity();

/// Returns the time until which a profile changes [s]; 0 if it is constant, infinite if it never stops.
double moves_until(const Profile& profile) {
  if (profile.is_constant()) return 0.0;
  const auto* waypoints = std::get_if<Profile::Waypoints>(&profile.shape());
  return waypoints != nullptr ? waypoints->points.back().first : kAlways;
}

/// Returns the period of a profile [s]; 0 if it is not periodic.
double period_of(const Profile& profile) {
  const auto* sine = std::get_if<Profile::Sine>(&profile.shape());
  return sine != nullptr && !profile.is_constant() ? sine->period_s : 0.0;
}

/// Returns the scripts that drive the hand; empty without a hand, and for a hand that no script drives.
std::span<const Profile> scripts_of(const HandFields& hand) {
  if (const auto* force = std::get_if<ForceHandFields>(&hand)) return force->force;
  if (const auto* push = std::get_if<PushHandFields>(&hand)) return {&push->force, 1};
  if (const ImpedanceHandFields* spring = spring_of(hand)) return spring->target;
  return {};
}

/// Returns `of` each script of hand and orientation.
std::vector<double> each(const Scenario& scenario, double (*of)(const Profile&)) {
  std::vector<double> results;
  for (const Profile& script : scripts_of(scenario.hand)) results.push_back(of(script));
  const auto& orientation = scenario.motion.orientation;
  if (orientation) results.insert(results.end(), {of(orientation->tilt), of(orientation->azimuth)});
  return results;
}

/// Returns the largest value of `of` over the scripts of hand and orientation; 0 without scripts.
double largest(const Scenario& scenario, double (*of)(const Profile&)) {
  double result = 0.0;
  for (const double value : each(scenario, of)) result = std::max(result, value);
  return result;
}

/// Returns the number of periods of a profile in `duration` [s], or its number of waypoints; 0 for other profiles.
double turns_of(const Profile& profile, double duration) {
  if (const double period = period_of(profile); period > 0.0) return duration / period;
  const auto* waypoints = std::get_if<Profile::Waypoints>(&profile.shape());
  return waypoints != nullptr ? static_cast<double>(waypoints->points.size()) : 0.0;
}

}  // namespace

double script_moves_until(const Scenario& scenario) {
  const HandFields& hand = scenario.hand;
  const bool is_led = scripts_of(hand).empty() && !std::holds_alternative<NoHandFields>(hand);
  return is_led || !scenario.motion.orientation ? kAlways : largest(scenario, moves_until);
}

std::vector<double> script_periods(const Scenario& scenario) {
  std::vector<double> periods = each(scenario, period_of);
  std::erase(periods, 0.0);
  return periods;
}

double script_period(const Scenario& scenario) {
  return largest(scenario, period_of);
}

std::optional<double> scripted_lifts(const Scenario& scenario) {
  const HandFields& hand = scenario.hand;
  const ImpedanceHandFields* spring = spring_of(hand);
  if (std::holds_alternative<TrackingHandFields>(hand) || (spring != nullptr && spring->tremor)) return std::nullopt;
  const double duration = scenario.time.step * static_cast<double>(scenario.time.steps);
  double lifts = 0.0;
  for (const Profile& script : scripts_of(hand)) lifts = std::max(lifts, turns_of(script, duration));
  // A tool that tilts to and fro lands twice in a period, once on each side of its tip.
  if (const auto& orientation = scenario.motion.orientation)
    for (const Profile* script : {&orientation->tilt, &orientation->azimuth})
      lifts = std::max(lifts, 2.0 * turns_of(*script, duration));
  return lifts;
}

bool has_scripted_motion(const Scenario& scenario) {
  const ImpedanceHandFields* hand = spring_of(scenario.hand);
  return script_moves_until(scenario) > 0.0 || (hand != nullptr && hand->tremor);
}

}  // namespace hapbench
