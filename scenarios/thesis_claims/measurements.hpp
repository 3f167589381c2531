#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "algorithms/registry.hpp"
#include "results/summary/summary.hpp"
#include "scenarios/thesis_claims/claims.hpp"
#include "sim/contact/contact_buffer.hpp"
#include "sim/tool/cylinder.hpp"

/// Measurements and scenes that several claims share.
namespace hapbench {

inline const Cylinder kDrill;
inline const ToolPose kUpright{Vec3::Zero(), {0.0, 0.0, -1.0}};

/// A wall point with normal +x, `beyond` the median line of an upright tool (so beyond > 0: the tool's axis is inside).
inline ContactBuffer wall_point(double beyond, const char* depth_model) {
  ContactBuffer contacts(1);
  contacts.push(0, {beyond, 0.0, 0.001}, Vec3::UnitX());
  find_depth_model(depth_model)->make()->evaluate(kDrill, kUpright, contacts);
  contacts.pad();
  return contacts;
}

/// Total variation of the velocity [m/s], power of the velocity above 30 Hz [m^2/s^2] and reversals of the force.
MeasuredCase vibration(const std::string& name, const Result& run);

/// A metric of the section ideal_trajectory; none if nothing was measured.
std::optional<double> ideal_trajectory_metric(const Result& run, const std::string& key);

/// The vibration of a law and of stiffness shaping, with all points, in the planar peg and then in a scene of task 2
/// with these overrides; with it "diverges", 1 or 0.
Measured vibrations_beside_shaping(const Evidence& e, const std::string& law, const std::string& task,
                                   const std::vector<std::string>& overrides_of_task);

/// An algorithm vibrates, compared with a smooth one, if it has rule.vibrates times the total variation and the square
/// of it times the power.
bool vibrates_much_more(const MeasuredCase& a, const MeasuredCase& b, const PublishedNumbers& p);
/// True if `a` has more of both.
bool vibrates_more(const MeasuredCase& a, const MeasuredCase& b);

std::string vibrations_text(const Measured& cases);

/// The damping ratio of a swing about zero [m], a value for each row, from the ratio q of successive extremes,
/// zeta = -ln q / sqrt(pi^2 + ln^2 q). An extreme within a micrometre of zero ends the decay: rounding and grazing
/// contact are no swings. None with fewer than two, since a motion that never turns swings not.
std::optional<double> damping_ratio_of_swings(std::span<const double> x);

}  // namespace hapbench
