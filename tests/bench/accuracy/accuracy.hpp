#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "scenarios/scene/scenario.hpp"
#include "sim/contact/contact_buffer.hpp"
#include "sim/loop/simulation.hpp"

/// What accuracy costs: each panel varies one thing, and gives for every setting how far off it is and how long it
/// takes.
namespace hapbench::accuracy {

/// How far off a setting is, under names that end with their unit; empty where there is no value.
struct Errors {
  std::string outcome = "completes";  ///< of the run; settings that fail are measured like the others
  std::vector<std::pair<std::string, std::optional<double>>> values;

  /// NaN where there is no value. Throws std::invalid_argument when there is no such name.
  double operator[](const std::string& name) const;
};

/// What is timed.
struct Work {
  std::function<void()> prepare;  ///< before every run, while the clock stands
  std::function<void()> run;
  std::size_t count = 1;  ///< steps or calls that a run makes
};

struct Setting {
  std::string name;  ///< "panel/setting": scripts and pictures know it
  std::string unit;  ///< of Work::count: "step" or "call"
  std::function<Errors()> errors;
  std::function<Work()> work;  ///< without observers: these measure the errors, apart
};
using Panel = std::vector<Setting>;

/// Every integrator over the time step, against the exact solution of damped springs; and without damping, how much
/// energy it makes. For signed bilateral springs, free position, no hand.
Panel integrators(const Scenario& springs);
/// Every algorithm, with its own options too, against the ideal trajectory of a drill in a hole.
Panel algorithms(const Scenario& drill);
/// The spacing of the block's points, with either density, against the same.
Panel spacing(const Scenario& drill);
/// Iterations of shaping, against the exact optimum on the contacts of a drill in a hole.
Panel shaping(const Scenario& drill);
/// Thresholds of the reduction, against exact shaping of all contacts.
Panel reduction(const Scenario& drill);
/// Reduced, merged and all contacts, dozens to hundreds, against exact shaping of all.
Panel merging(const Scenario& drill);
/// Every algorithm with contacts found in every n-th row, held or linear in between, against contacts of every row.
Panel multi_rate_contacts(const Scenario& free);
/// The search for contacts with what it skips and without, whose contacts are the same.
Panel skips(const Scenario& free);
/// Energy that a bounce gains because contacts begin and end between samples. For a free tool that is thrown at
/// something.
Panel events(const Scenario& thrown);

// What the panels have in common.

/// Calls `make` the first time that the result is asked for.
template <class Make>
auto once(Make make) {
  using Made = std::invoke_result_t<Make>;
  return [make, made = std::make_shared<std::optional<Made>>()]() -> const Made& {
    if (!*made) made->emplace(make());
    return **made;
  };
}

/// Positions of every `stride`-th row of a run, and how it ended.
struct SampledRun {
  SimulationResult result;
  std::vector<Vec3> positions;  ///< [m]
};
SampledRun sampled_run(const Scenario& scenario, std::shared_ptr<const PointShell> shell, std::uint64_t stride,
                       std::vector<Observer*> observers = {});
/// The same run to be timed, without observers.
Work bare_run(const Scenario& scenario, std::shared_ptr<const PointShell> shell);

/// Distance between two trajectories at their common samples [m].
struct Distance {
  double final = 0.0;  ///< at the last common sample
  double rms = 0.0;    ///< root of the mean square
  double max = 0.0;
};
Distance distance(std::span<const Vec3> a, std::span<const Vec3> b);

/// The scenario at `factor` times its step, as long a run.
Scenario with_step(const Scenario& scenario, double factor);

}  // namespace hapbench::accuracy
