#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "results/io/columns.hpp"
#include "results/observe/energy_ledger.hpp"
#include "results/observe/force_fidelity.hpp"
#include "results/observe/ideal_trajectory.hpp"
#include "results/record/recorder.hpp"
#include "scenarios/description/scenario.hpp"

namespace hapbench {

/// What the recorders of a trial are made from.
struct RecordedTrial {
  const RecordFields& fields;
  std::size_t contact_capacity;           ///< the most contacts a row can have
  const EnergyLedger* ledger;             ///< null unless the scenario asks for energy
  const IdealTrajectoryObserver* ideal;   ///< null unless it asks for the ideal trajectory
  const ForceFidelityObserver* fidelity;  ///< null without a measured force
};

/// Recorders for what the scenario asks for, which write into the directory. Throws IoError.
std::vector<std::unique_ptr<Recorder>> make_recorders(const RecordedTrial& trial,
                                                      const std::filesystem::path& directory);

/// The tables of all recorders there are.
std::vector<ResultTable> record_tables();
/// Those that a run with these fields writes.
std::vector<ResultTable> record_tables(const RecordFields& fields);

}  // namespace hapbench
