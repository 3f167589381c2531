#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "results/summary/summary.hpp"
#include "scenarios/run/bare_run.hpp"
#include "scenarios/run/checked_scenario.hpp"
#include "scenarios/scene/scenario.hpp"
#include "scenarios/thesis/judging.hpp"
#include "scenarios/thesis/published_numbers.hpp"
#include "sim/contact/contact_buffer.hpp"
#include "sim/loop/simulation.hpp"
#include "sim/tool/cylinder.hpp"

/// Measurements and scenes that several claims use.
namespace hapbench {

/// The algorithm that the thesis proposes.
inline constexpr const char* kProposedLaw = "shaped_stiffness";

/// Names of the tasks of section 3.2 and of the block's point densities. The scenario of a task with a density has the
/// name TASK_DENSITY.
inline constexpr const char* kTasks[] = {"task1_flat", "task2_rotate", "task3_spin"};
inline constexpr const char* kDensities[] = {"signed_distance", "binary"};

/// Runs a scenario in memory and calls `row` for each time step. StepRecord::found has the contacts before the point
/// stages (local average and reduction). Throws InputError if the scenario cannot run.
void for_each_row(const CheckedScenario& checked, const std::function<void(const StepRecord&)>& row);

/// The default drill, and a tool pose with its tip at the origin and its axis pointing down.
inline const Cylinder kDrill;
inline const ToolPose kUpright{Vec3::Zero(), {0.0, 0.0, -1.0}};

/// Returns one contact of the upright drill with a wall point at x = `beyond` [m] and normal +x. Its depth is
/// computed by the depth model with the name `depth_model`. For beyond > 0 the tool's axis lies inside the wall, so the
/// point is on the far side of the axis.
ContactBuffer wall_point(double beyond, const char* depth_model);

/// Number of repetitions of a timing measurement.
inline constexpr int kRepetitions = 21;

/// Returns the median of `values`: of an even number of values, the upper one of the two in the middle. Requires a
/// value.
inline double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Returns the processor time [s] of a call of `work`. It does not include waiting for other processes.
template <class Work>
double seconds_of(Work work) {
  const double start = processor_seconds();
  work();
  return processor_seconds() - start;
}

/// Returns a variant of `scenario` for measuring contacts. In `scenario`, a drill is in the block's hole. The variant
/// has an ideal device, which has no dynamics, with the input-force limit of the device of `scenario`. It lasts at most
/// one period of the tilt (6 s) and has the default RecordFields.
Scenario drill_in_hole(Scenario scenario);

/// The contacts before (`colliding`) or after (`rendered`) the scenario's point stages.
enum class Points { colliding, rendered };

/// Returns the contacts, with depth and gradient, of every `stride`-th step of drill_in_hole(scenario). Skips steps
/// without contact.
std::vector<ContactBuffer> contact_sets(const Scenario& scenario, std::uint64_t stride,
                                        Points points = Points::colliding);

/// Returns the largest set. Throws NothingToMeasure if there is none.
ContactBuffer largest_of(const std::vector<ContactBuffer>& sets);
/// Returns the size of the largest set; 0 without sets.
std::size_t largest_size(const std::vector<ContactBuffer>& sets);

/// Returns the processor time [s] of a pass over all sets, which copies each set to `copy` and calls `work` with it.
/// Precondition: `copy` has room for the largest set.
template <class Work>
double seconds_of_pass(const std::vector<ContactBuffer>& sets, ContactBuffer& copy, Work work) {
  return seconds_of([&] {
    for (const ContactBuffer& set : sets) {
      copy.assign(set);
      work(copy);
    }
  });
}

/// Returns the median processor time [s], over the repetitions, of calling `work` with a copy of a set, as the mean
/// over the sets. Does not include the time of copying and of reading the clock, which is longer than some laws need:
/// each repetition subtracts the time of a pass that only copies. Throws NothingToMeasure if there is no set, or if the
/// median is not above 0.
template <class Work>
double seconds_with(const std::vector<ContactBuffer>& sets, Work work, int repetitions = kRepetitions) {
  ContactBuffer copy(largest_of(sets).size());
  std::vector<double> seconds;
  for (int i = 0; i < repetitions; ++i) {
    const double only_copies = seconds_of_pass(sets, copy, [](ContactBuffer&) {});
    seconds.push_back(seconds_of_pass(sets, copy, work) - only_copies);
  }
  const double middle = median(std::move(seconds));
  if (!(middle > 0.0)) throw NothingToMeasure("the computing time is below the noise of the clock");
  return middle / static_cast<double>(sets.size());
}

/// Returns the vibration measures of a run: total variation of the velocity [m/s], power of the velocity above 30 Hz
/// [m^2/s^2], and number of force reversals.
MeasuredCase vibration(const std::string& name, const Result& run);
/// Returns vibration() of a run with which other runs are compared. If this run diverges, each number is
/// NaN, and the number up to the divergence is stored beside it (MeasuredCase::set_diverged).
MeasuredCase reference_vibration(const std::string& name, const Result& run);

/// Returns true if `a` has a larger velocity variation and a larger vibration power than `b`.
bool vibrates_more(const MeasuredCase& a, const MeasuredCase& b);
/// Returns true if `a` vibrates in comparison with the smooth run `b`, that is, if one of two conditions is true. With
/// the factor f = rule.vibrates:
///   - `a` has at least f times the velocity variation and at least f^2 times the vibration power of `b`.
///   - vibrates_more() is true, and `a` has at least f times as many force reversals as `b`. If `b` has no force
///     reversals, `a` has at least f force reversals.
bool vibrates_much_more(const MeasuredCase& a, const MeasuredCase& b, const PublishedNumbers& p);

/// Returns a reference_vibration() with the numbers that it has if its divergence is ignored, as earlier rules did.
MeasuredCase until_divergence(MeasuredCase reference);

/// Returns the damping ratio zeta of an oscillation about zero, from positions `x` [m], one for each time step. With
/// the geometric mean q of the ratios of the magnitudes of successive extremes, zeta = -ln q / sqrt(pi^2 + ln^2 q), or
/// 0 if q is at least 1. Ignores the first extreme whose magnitude is below 1 um, and all later extremes, because
/// rounding and grazing contact are not oscillations. Returns nullopt if fewer than two extremes remain.
std::optional<double> damping_ratio_of_swings(std::span<const double> x);

}  // namespace hapbench
