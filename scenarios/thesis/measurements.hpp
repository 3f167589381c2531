#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <optional>

#include "algorithms/registry.hpp"
#include "scenarios/thesis/claims.hpp"
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

// The contacts that a drill has in a hole, set by set, and how long a force law takes over them.

/// Seconds of a call of `work`: the least of `repetitions`, or of as many as a second allows.
template <class Work>
double seconds_of(int repetitions, Work work) {
  using Clock = std::chrono::steady_clock;
  double least = 0.0, all = 0.0;
  for (int i = 0; i < repetitions && all < 1.0; ++i) {
    const auto start = Clock::now();
    work();
    const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
    if (i == 0 || seconds < least) least = seconds;
    all += seconds;
  }
  return least;
}

/// Prepares a scenario in which a hand presses a drill into the block's hole to be measured: its device becomes an
/// ideal one with the same force limit, so that the device adds no dynamics of its own; it ends after one period of the
/// tilt and records nothing.
Scenario drill_in_hole(Scenario scenario);

/// Before or after the scenario's point stages.
enum class Points { colliding, rendered };

/// A buffer of just the size of these contacts.
inline ContactBuffer copy_of(const ContactBuffer& contacts) {
  ContactBuffer copy(contacts.size());
  copy.assign(contacts);
  return copy;
}

/// The points of every `stride`-th row of drill_in_hole(scenario), with depth and gradient; rows without contact are
/// left out.
std::vector<ContactBuffer> contact_sets(const Scenario& scenario, std::uint64_t stride,
                                        Points points = Points::colliding);

/// The largest set, of at least one, and its size, 0 without any.
inline ContactBuffer largest_of(const std::vector<ContactBuffer>& sets) {
  return *std::ranges::max_element(sets, {}, &ContactBuffer::size);
}
inline std::size_t largest_size(const std::vector<ContactBuffer>& sets) {
  return sets.empty() ? 0 : largest_of(sets).size();
}

/// Seconds of `work` with a copy of each set, one after the other, and of copying them.
template <class Work>
double seconds_with(const std::vector<ContactBuffer>& sets, int repetitions, Work work) {
  ContactBuffer copy(largest_size(sets));
  return seconds_of(repetitions, [&] {
    for (const ContactBuffer& set : sets) {
      copy.assign(set);
      work(copy);
    }
  });
}

/// Total variation of the velocity [m/s], power of the velocity above 30 Hz [m^2/s^2] and reversals of the force.
MeasuredCase vibration(const std::string& name, const Result& run);

/// The vibration of a law and of stiffness shaping, with all points, in the planar peg and then in a scene of task 2
/// with these overrides; with it "diverges", 1 or 0.
Measured vibrations_beside_shaping(const Evidence& e, const std::string& law, const std::string& task,
                                   const std::vector<std::string>& overrides_of_task);

/// An algorithm vibrates, compared with a smooth one, if it has rule.vibrates times the total variation and the square
/// of it times the power; or more of both, and so many times the reversals of the force, which then turns to and fro.
bool vibrates_much_more(const MeasuredCase& a, const MeasuredCase& b, const PublishedNumbers& p);
/// True if `a` has more of both.
inline bool vibrates_more(const MeasuredCase& a, const MeasuredCase& b) {
  return a["velocity_variation"] > b["velocity_variation"] && a["vibration_power"] > b["vibration_power"];
}

/// The damping ratio of a swing about zero [m], a value for each row, from the ratio q of successive extremes,
/// zeta = -ln q / sqrt(pi^2 + ln^2 q). An extreme within a micrometre of zero ends the decay: rounding and grazing
/// contact are no swings. None with fewer than two, since a motion that never turns swings not.
std::optional<double> damping_ratio_of_swings(std::span<const double> x);

}  // namespace hapbench
