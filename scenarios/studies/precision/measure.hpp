#pragma once

#include <array>
#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "algorithms/registry.hpp"
#include "scenarios/description/scenario.hpp"
#include "sim/loop/simulation.hpp"

/// Studies of run time against error, and what they have in common: sampled runs, distances, fits and times. A study
/// has one row per setting of one thing (a time step, a number of iterations, an algorithm), with its error against a
/// reference, or what it asks for, and the time it takes.
namespace hapbench {

/// One setting. Failures are rows like the others, with what failed as outcome.
struct PrecisionRow {
  std::string setting;
  std::string outcome;
  std::vector<std::optional<double>> values;  ///< one for each column of the study; empty where there is no value
  double seconds = 0.0;  ///< per step or call: the least of the repetitions, timed apart from the errors
  std::optional<double> tolerance = {};  ///< relative, of the errors: what the reference's own error makes of them
};

/// The power of x with which errors fall, log(e_2 / e_3) / log(x_2 / x_3) at the two finest of a series.
struct Order {
  double value = 0.0;        ///< NaN with fewer than two errors
  double uncertainty = 0.0;  ///< distance from the order of the two errors before; NaN with fewer than three
};

/// The order of the rows of one series.
struct ObservedOrder {
  std::string series;
  std::string error;  ///< name of the column
  Order order;
};

struct PrecisionOptions {
  int repetitions = 5;
  std::function<void(std::size_t done, std::size_t all)> progress = [](std::size_t, std::size_t) {};
};

struct PrecisionResult {
  std::vector<std::string> columns;  ///< names with units
  std::string timed;                 ///< what `seconds` measures: a "step" or a "call"
  std::vector<PrecisionRow> rows;
  std::vector<ObservedOrder> orders;

  /// Appends a row and reports progress; `all` rows are expected.
  void add(PrecisionRow row, const PrecisionOptions& options, std::size_t all) {
    rows.push_back(std::move(row));
    options.progress(rows.size(), all);
  }
};

struct PrecisionStudy {
  const char* name;
  const char* summary;
  const char* scenario;  ///< name of the bundled scenario it starts from
  /// Throws InputError when the scenario is not of the kind the study needs.
  PrecisionResult (*run)(const Scenario& scenario, const PrecisionOptions& options);
};

// The table. Each study is defined in a file of its own; a new one needs that file and two lines here.
extern const PrecisionStudy kIntegratorsStudy;
extern const PrecisionStudy kTimeStepStudy;
extern const PrecisionStudy kShapingStudy;
extern const PrecisionStudy kSpacingStudy;
extern const PrecisionStudy kReductionStudy;
extern const PrecisionStudy kMergingStudy;
extern const PrecisionStudy kAlgorithmsStudy;
extern const PrecisionStudy kStiffnessStudy;
extern const PrecisionStudy kForceJumpsStudy;
extern const PrecisionStudy kQueryTimeStudy;
extern const PrecisionStudy kLateContactsStudy;
extern const PrecisionStudy kEventsStudy;

inline constexpr std::array kPrecisionStudies = {
    &kIntegratorsStudy, &kTimeStepStudy,  &kShapingStudy,    &kSpacingStudy,   &kReductionStudy,    &kMergingStudy,
    &kAlgorithmsStudy,  &kStiffnessStudy, &kForceJumpsStudy, &kQueryTimeStudy, &kLateContactsStudy, &kEventsStudy};

/// Calls `work` with every row of a run.
template <class Work>
class OnEachRow final : public Observer {
 public:
  explicit OnEachRow(Work work) : work_(std::move(work)) {}
  void on_step(const StepRecord& record) noexcept override { work_(record); }

 private:
  Work work_;
};

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

/// The order of convergence at the fine end; x falls. Ignores errors that are not positive and finite.
Order observed_order(std::span<const double> x, std::span<const double> error);

/// The scenario at `factor` times its step, as long a run.
Scenario with_step(const Scenario& scenario, double factor);

/// Throws InputError where the motion prescribes the position.
void require_free_position(const Scenario& scenario);

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

/// Seconds per contact set of `force`, which computes the force of a copy of the set that `load` has made; the time of
/// copying is subtracted.
template <class Load, class Force>
double seconds_per_force(const std::vector<ContactBuffer>& sets, int repetitions, Load load, Force force) {
  const double copying = seconds_per_call(sets.size(), repetitions, [&] {
    for (const ContactBuffer& set : sets) load(set);
  });
  const double seconds = seconds_per_call(sets.size(), repetitions, [&] {
    for (const ContactBuffer& set : sets) {
      load(set);
      force();
    }
  });
  return std::max(0.0, seconds - copying);
}

/// Prepares a scenario in which a hand presses a drill into the block's hole for the studies: its device becomes an
/// ideal one with the same force limit, so that the device adds no dynamics of its own; it ends after one period of the
/// tilt and records nothing. Throws InputError when the scenario has no block_with_hole, or a tool whose ideal
/// trajectory is not known.
Scenario drill_in_hole(Scenario scenario);

/// Rows from one contact set of a study to the next.
inline constexpr std::uint64_t kContactSetStride = 64;

/// The colliding points of every `stride`-th row of a scenario, with depth and gradient, before any point stage; rows
/// without contact are left out.
std::vector<ContactBuffer> contact_sets(Scenario scenario, std::uint64_t stride);
/// The same of every kContactSetStride-th row of `drill_in_hole(scenario)`. Throws InputError when the tool touches
/// nothing.
std::vector<ContactBuffer> drill_contact_sets(const Scenario& scenario);

/// The contacts of every `stride`-th row of a scenario after its point stages, without rows that have none.
std::vector<ContactBuffer> rendered_contact_sets(const Scenario& scenario, std::uint64_t stride);

/// The size of the largest set.
std::size_t largest_size(const std::vector<ContactBuffer>& sets);

/// The columns that `ideal_run` measures.
extern const std::vector<std::string> kIdealColumns;

/// A row of kIdealColumns, and where the run led the tool.
struct IdealRun {
  PrecisionRow row;
  std::vector<Vec3> positions;  ///< of every kContactSetStride-th row [m]
};

/// Errors of a run against the ideal trajectory, over the rows in which the hand is gentle, if it ever is; and the
/// largest change of the force in a step of all rows. Precondition: the scenario is a `drill_in_hole`.
IdealRun ideal_run(std::string setting, const Scenario& scenario, std::shared_ptr<const PointShell> shell,
                   int repetitions);

/// The share of K that is left where no contact normal points, the way out of a wedge, in closed form, for as many
/// points on either face, all equally deep. Empty for algorithms without a formula and for K = 0. The formulas are in
/// the files of the algorithms.
std::optional<WedgeStiffness> wedge_stiffness(const RenderingConfig& config, double half_angle, double points_per_face);

/// A springs scenario with two groups of as many springs each, turned into the faces of a wedge. Throws InputError for
/// other scenarios.
Scenario with_wedge(Scenario scenario, double half_angle);

}  // namespace hapbench
