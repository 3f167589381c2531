#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "results/summary/summary.hpp"
#include "scenarios/run/checked_scenario.hpp"
#include "scenarios/scene/scenario.hpp"
#include "scenarios/thesis/judging.hpp"
#include "scenarios/thesis/published_numbers.hpp"
#include "sim/contact/contact_buffer.hpp"
#include "sim/loop/simulation.hpp"
#include "sim/tool/cylinder.hpp"

/// Measurements and scenes that several claims share.
namespace hapbench {

/// The algorithm that the thesis proposes.
inline constexpr const char* kProposedLaw = "shaped_stiffness";

/// Runs a scenario in memory and calls `row` for each row, with the contacts as found. Throws InputError.
void for_each_row(const CheckedScenario& checked, const std::function<void(const StepRecord&)>& row);

inline const Cylinder kDrill;
inline const ToolPose kUpright{Vec3::Zero(), {0.0, 0.0, -1.0}};

/// A wall point with normal +x, `beyond` the median line of an upright tool (so beyond > 0: the tool's axis is inside).
ContactBuffer wall_point(double beyond, const char* depth_model);

/// How often what a claim times is repeated.
inline constexpr int kRepetitions = 20;

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

/// A scenario in which a hand presses a drill into the block's hole, for measuring: with an ideal device of the same
/// force limit, which adds no dynamics of its own, for one period of the tilt, and without records.
Scenario drill_in_hole(Scenario scenario);

/// Before or after the scenario's point stages.
enum class Points { colliding, rendered };

/// The points of every `stride`-th row of drill_in_hole(scenario) that has contact, with depth and gradient.
std::vector<ContactBuffer> contact_sets(const Scenario& scenario, std::uint64_t stride,
                                        Points points = Points::colliding);

/// The largest set, of at least one, and its size, 0 without any.
ContactBuffer largest_of(const std::vector<ContactBuffer>& sets);
std::size_t largest_size(const std::vector<ContactBuffer>& sets);

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

/// True if `a` has more variation and power.
bool vibrates_more(const MeasuredCase& a, const MeasuredCase& b);
/// Whether an algorithm vibrates, compared with a smooth one: it has rule.vibrates times the total variation and the
/// square of it times the power; or more of both, and so many times the reversals of the force.
bool vibrates_much_more(const MeasuredCase& a, const MeasuredCase& b, const PublishedNumbers& p);

/// The damping ratio of a swing about zero [m], a value for each row, from the ratio q of successive extremes,
/// zeta = -ln q / sqrt(pi^2 + ln^2 q). An extreme within a micrometre of zero ends the decay: rounding and grazing
/// contact are no swings. None with fewer than two extremes.
std::optional<double> damping_ratio_of_swings(std::span<const double> x);

}  // namespace hapbench
