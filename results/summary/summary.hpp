#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "results/summary/metric_list.hpp"
#include "results/summary/provenance.hpp"
#include "sim/loop/simulation.hpp"
#include "sim/tool/profile_point.hpp"

namespace hapbench {

/// What the run cost in counted work. Counts are exact and repeatable; times are in timing.json.
struct RunWork {
  SearchWork search;
  std::uint64_t steps_skipped = 0;  ///< steps without any contact search
  AlgorithmWork algorithm;
  std::uint64_t allocations = 0;  ///< on the heap, inside the step loop

  RunWork& operator+=(const RunWork& other) noexcept {
    search += other.search;
    steps_skipped += other.steps_skipped;
    algorithm += other.algorithm;
    allocations += other.allocations;
    return *this;
  }
};

/// What drawings and readers need of a tool whose shape the scenario's fields do not show.
struct ToolSummary {
  double half_width = 0.0;  ///< [m]
  double reach = 0.0;       ///< of its furthest point from the tip centre [m]
  bool convex = true;
  std::vector<ProfilePoint> outline;  ///< ToolShape::outline
};

/// Everything summary.json says about one run.
struct RunSummary {
  std::string name;       ///< of the scenario
  std::string algorithm;  ///< as registered
  SimulationResult result;
  bool expected = false;  ///< the outcome is the one the scenario expects
  double duration = 0.0;  ///< simulated time: rows x dt [s]
  Metrics metrics;
  std::optional<PassivityMetrics> passivity;               ///< none without rows
  std::optional<EnergyMetrics> energy;                     ///< when the scenario asks for it
  std::optional<IdealTrajectoryMetrics> ideal_trajectory;  ///< when the scenario asks for it
  std::optional<ForceFidelity> fidelity;                   ///< of a stroke with a measured force
  std::optional<LostTorqueMetrics> torque;                 ///< when the scenario asks for it
  std::optional<PerceptionMetrics> perception;             ///< when the scenario asks for it
  std::optional<std::vector<PlaceMetrics>> targets;        ///< of a tracking hand
  std::optional<ToolSummary> tool;                         ///< of a tool that is no cylinder
  std::vector<std::string> warnings;                       ///< what may make the numbers mislead, a sentence each
  /// About the files that the scenario names, each with its pointer; summary.json has them before the others.
  std::vector<std::string> file_warnings;
  RunWork work;
  Provenance provenance;
  std::string scenario_hash;  ///< of the effective scenario
};

/// summary.json. The same run gives the same bytes: no time stamps, no timings, no instruction set. What does not exist
/// (a ratio without contact, the final position of no row) or is not finite is null.
nlohmann::ordered_json summary_json(const RunSummary& run);

/// The numbers of a summary that a scenario's `expect` may bound and the table of a sweep holds: those of "metrics"
/// under their own names, the final position's coordinates, as "final_position_m.x", and those of "passivity" and of
/// the sections "energy", "ideal_trajectory", "fidelity", "torque", "perception" and "targets", which not every run
/// has, as in "energy.created_sum_J" or "targets.0.success_rate.mean".
MetricList metric_list(const RunSummary& run);

/// summary.json as text.
std::string summary_text(const RunSummary& run);

}  // namespace hapbench
