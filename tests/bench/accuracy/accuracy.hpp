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

/// Panels of error against run time. Each panel varies one quantity; for every setting it gives the error and the run
/// time.
namespace hapbench::accuracy {

/// Errors of a setting. Their names end with their unit; an error without a value is empty.
struct Errors {
  std::string outcome = "completes";  ///< outcome of the run; settings that fail are measured like all others
  std::vector<std::pair<std::string, std::optional<double>>> values;

  /// Returns NaN if the error has no value. Throws std::invalid_argument if there is no error with this name.
  double operator[](const std::string& name) const;
};

/// The work whose run time is measured.
struct Work {
  std::function<void()> prepare;  ///< called before every run, outside of the measured time
  std::function<void()> run;
  std::size_t count = 1;  ///< number of steps or calls in a run
};

struct Setting {
  std::string name;  ///< "panel/setting", the name in scripts and pictures
  std::string unit;  ///< of Work::count: "step" or "call"
  std::function<Errors()> errors;
  std::function<Work()> work;  ///< creates the work without observers; the errors are measured separately, with
                               ///< observers
};
using Panel = std::vector<Setting>;

/// Every integrator over the time step: error against the exact solution of damped springs and, without damping, the
/// created energy. For signed bilateral springs, free position, no hand.
Panel integrators(const Scenario& springs);
/// Every algorithm, also with its own options, against the ideal trajectory of a drill in a hole.
Panel algorithms(const Scenario& drill);
/// Spacing of the block's points, with both densities, against the ideal trajectory.
Panel spacing(const Scenario& drill);
/// Iterations of shaping, against the exact optimum on the contacts of a drill in a hole.
Panel shaping(const Scenario& drill);
/// Thresholds of the reduction, against exact shaping of all contacts.
Panel reduction(const Scenario& drill);
/// Reduced, merged and all contacts (from dozens to hundreds), against exact shaping of all contacts.
Panel merging(const Scenario& drill);
/// Every algorithm with contacts that are found in every n-th step, held or linear in between, against contacts that
/// are found in every step.
Panel multi_rate_contacts(const Scenario& free);
/// The contact search with and without skips. Both find the same contacts.
Panel skips(const Scenario& free);
/// Energy that a bounce gains because contacts begin and end between samples. For a free tool that is thrown at an
/// object.
Panel events(const Scenario& thrown);

// Functions that the panels share.

/// Calls `make` when the result is requested for the first time.
template <class Make>
auto once(Make make) {
  using Made = std::invoke_result_t<Make>;
  return [make, made = std::make_shared<std::optional<Made>>()]() -> const Made& {
    if (!*made) made->emplace(make());
    return **made;
  };
}

/// Positions of every `stride`-th step of a run, and the end of the run.
struct SampledRun {
  SimulationResult result;
  std::vector<Vec3> positions;  ///< [m]
};
SampledRun sampled_run(const Scenario& scenario, std::shared_ptr<const PointShell> shell, std::uint64_t stride,
                       std::vector<Observer*> observers = {});
/// Returns the same run as work to be timed, without observers.
Work bare_run(const Scenario& scenario, std::shared_ptr<const PointShell> shell);

/// Distance between two trajectories at their common samples [m].
struct Distance {
  double final = 0.0;  ///< distance at the last common sample
  double rms = 0.0;    ///< root mean square of the distances
  double max = 0.0;
};
Distance distance(std::span<const Vec3> a, std::span<const Vec3> b);

/// Returns the scenario with `factor` times its time step and the same duration.
Scenario with_step(const Scenario& scenario, double factor);

}  // namespace hapbench::accuracy
