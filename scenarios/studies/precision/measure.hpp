#pragma once

#include <chrono>
#include <memory>
#include <span>
#include <vector>

#include "scenarios/description/scenario.hpp"
#include "scenarios/studies/precision/study.hpp"
#include "sim/loop/simulation.hpp"

/// What the studies have in common: sampled runs, distances, fits and times.
namespace hapbench {

/// Positions and rendered forces of every `stride`-th row of a run, and how it ended.
struct SampledRun {
  SimulationResult result;
  std::vector<Vec3> positions;  ///< [m]
  std::vector<Vec3> forces;     ///< [N]
  bool in_contact = false;      ///< in any row
};

SampledRun sampled_run(const Scenario& scenario, std::shared_ptr<const PointShell> shell, std::uint64_t stride,
                       std::vector<Observer*> observers = {});

/// Distance between two trajectories, or two series of forces, at their common samples, in their unit.
struct TrajectoryDistance {
  double final = 0.0;  ///< at the last common sample
  double rms = 0.0;    ///< root of the mean square, the discrete l2 norm
  double max = 0.0;
};
TrajectoryDistance distance(std::span<const Vec3> a, std::span<const Vec3> b);

/// Slope of y over x by least squares; NaN for fewer than two different x.
double slope(std::span<const double> x, std::span<const double> y);

/// Order of convergence: the slope of log(error) over log(x) by least squares. Leaves out errors that are not positive
/// and finite; NaN for fewer than two.
double fitted_order(std::span<const double> x, std::span<const double> error);

/// Seconds per step of a run without observers, the least of `repetitions`, or of as many as a second allows.
double seconds_per_step(const Scenario& scenario, std::shared_ptr<const PointShell> shell, int repetitions);

/// Seconds per call of `work`, which makes `calls` calls; the least of `repetitions`, or of as many as a second allows.
template <class Work>
double seconds_per_call(std::size_t calls, int repetitions, Work work) {
  using Clock = std::chrono::steady_clock;
  double least = 0.0, all = 0.0;
  for (int i = 0; i < repetitions && all < 1.0; ++i) {
    const auto start = Clock::now();
    work();
    const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
    if (i == 0 || seconds < least) least = seconds;
    all += seconds;
  }
  return least / static_cast<double>(calls);
}

/// An ideal device with the same limit of the force, which adds no dynamics, delay or noise of its own.
IdealDeviceFields with_ideal_device(const DeviceFields& device);

/// Prepares a scenario in which a hand presses a drill into the block's hole for the studies: its device becomes an
/// ideal one with the same force limit, so that the device adds no dynamics of its own; it ends after one period of the
/// tilt and records nothing. Throws InputError when the scenario has no block_with_hole, or a tool whose ideal
/// trajectory is not known.
Scenario drill_in_hole(Scenario scenario);

/// Rows from one contact set of a study to the next.
inline constexpr std::uint64_t kContactSetStride = 64;

/// The colliding points of every `stride`-th row of a scenario, with depth and gradient, before any point stage. Rows
/// without contact are left out.
std::vector<ContactBuffer> contact_sets(Scenario scenario, std::uint64_t stride);

/// The same after the point stages of the scenario.
std::vector<ContactBuffer> rendered_contact_sets(const Scenario& scenario, std::uint64_t stride);

}  // namespace hapbench
