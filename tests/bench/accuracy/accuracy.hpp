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

/// Panels of error against run time. Each panel varies one quantity. For every setting, the panel gives the error and
/// the run time.
namespace hapbench::accuracy {

/// Errors of a setting by name. A name ends with its unit. An error without a value is empty.
struct Errors {
  std::string outcome = "completes";  ///< outcome of the run; settings that fail are measured like all others
  std::vector<std::pair<std::string, std::optional<double>>> values;

  /// Returns NaN if the error has no value. Throws std::invalid_argument if there is no error with this name.
  double operator[](const std::string& name) const;
};

/// Work whose run time is measured.
struct Work {
  std::function<void()> prepare;  ///< called before every run, outside of the measured time
  std::function<void()> run;
  std::size_t count = 1;  ///< number of steps or calls in a run
};

struct Setting {
  std::string name;  ///< "panel/setting", the name in scripts and pictures
  std::string unit;  ///< unit of Work::count: "step" or "call"
  std::function<Errors()> errors;
  /// Creates the work whose run time is measured. The work runs without observers; `errors` measures with observers in
  /// separate runs.
  std::function<Work()> work;
};
using Panel = std::vector<Setting>;

/// Returns the panel of all integrators with different time steps, for a free tool on signed bilateral springs without
/// a hand. Errors: the distance to the exact solution of damped springs, and the energy created without damping.
Panel integrators(const Scenario& springs);
/// Returns the panel of all algorithms, some of them also with angular damping or with the passivity controller.
/// Errors: the deviation from the ideal trajectory of a drill in a hole.
Panel algorithms(const Scenario& drill);
/// Returns the panel of different spacings of the block's points, for the densities `signed_distance` and `binary` of
/// the block. Errors: the deviation from the ideal trajectory.
Panel spacing(const Scenario& drill);
/// Returns the panel of different numbers of shaping iterations. Errors: the deviation from the exact optimum on the
/// contacts of a drill in a hole.
Panel shaping(const Scenario& drill);
/// Returns the panel of different thresholds of the reduction. Errors: the deviation from exact shaping of all
/// contacts.
Panel reduction(const Scenario& drill);
/// Returns the panel of laws on reduced, merged and all contacts, for spacings with dozens to hundreds of contacts.
/// Errors: the deviation from exact shaping of all contacts.
Panel merging(const Scenario& drill);
/// Returns the panel of all algorithms with contacts that are found in every n-th step, and held or extrapolated
/// linearly between these steps. Errors: the deviation from a run whose contacts are found in every step.
Panel multi_rate_contacts(const Scenario& free);
/// Returns the panel of the contact search with and without skips. Both settings find the same contacts.
Panel skips(const Scenario& free);
/// Returns the panel of all integrators with different time steps, for a free tool that is thrown at an object. Errors:
/// the energy that a bounce gains because contacts begin and end between samples.
Panel events(const Scenario& thrown);

// Functions that the panels share.

/// Returns a function that calls `make` at its first call and returns this result at every call.
template <class Make>
auto once(Make make) {
  using Made = std::invoke_result_t<Make>;
  return [make, made = std::make_shared<std::optional<Made>>()]() -> const Made& {
    if (!*made) made->emplace(make());
    return **made;
  };
}

/// Result of a run, and the positions of the tool in every `stride`-th step.
struct SampledRun {
  SimulationResult result;
  std::vector<Vec3> positions;  ///< [m]
};
SampledRun sampled_run(const Scenario& scenario, std::shared_ptr<const PointShell> shell, std::uint64_t stride,
                       std::vector<Observer*> observers = {});
/// Returns the run of this scenario, without observers, as work whose run time is measured.
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
