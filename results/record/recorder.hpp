#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "results/io/table_writer.hpp"
#include "sim/loop/simulation.hpp"

/// The tables that a run writes step by step. All values describe the state before the integrator moves the tool.
namespace hapbench {

class EnergyLedger;
class ForceFidelityObserver;
class IdealTrajectoryObserver;
struct SixDofRow;
class InsideObserver;
struct TargetRow;

/// Fields of a scenario's `record` that add columns to trajectory.csv.
struct TrajectoryExtras {
  bool pose = false;
  bool torque = false;
  bool inside = false;
};

/// A field of TrajectoryExtras and its columns.
struct TrajectoryGroup {
  bool TrajectoryExtras::*is_wanted;
  const char* field;   ///< name of the field
  const char* effect;  ///< effect of the field, for the documentation
  std::span<const Column> columns;
  /// Writes a value for each column to `cells`. `inside` must observe before the recorder; null if the run does not
  /// observe how deep the tool is inside the environment.
  void (*fill)(const StepRecord& record, const InsideObserver* inside, std::optional<double>* cells);
  bool wants_roll = false, wants_springs = false;  ///< see the functions of Observer with the same names
};

/// Returns all groups, in the order of their columns.
std::span<const TrajectoryGroup> trajectory_groups();

/// Columns of a table, and the function that writes the lines of a recorded step to the table.
struct RowSource {
  std::vector<Column> columns;
  /// Writes the lines of one step; writes nothing if the step has no lines. Allocates nothing.
  std::function<void(const StepRecord& record, TableWriter& table)> write;
  /// See the functions of Observer with the same names.
  bool wants_ratio = false, wants_roll = false, wants_springs = false, wants_found = false;
};

/// An observer that writes one table, to a file or into memory. During the run, lines go through a buffer of fixed size
/// to a temporary file, which `finish` renames. A run that is interrupted before `finish` therefore leaves no table.
class Recorder final : public Observer {
 public:
  /// Records steps 0, every, 2 every, … Precondition: every > 0. Throws IoError.
  Recorder(const TableTarget& target, RowSource source, std::uint64_t every = 1);

  bool wants_ratio() const noexcept override { return source_.wants_ratio; }
  bool wants_roll() const noexcept override { return source_.wants_roll; }
  bool wants_springs() const noexcept override { return source_.wants_springs; }
  bool wants_found() const noexcept override { return source_.wants_found; }
  void on_step(const StepRecord& record) noexcept override {
    if (record.step % every_ == 0) source_.write(record, writer_);
  }

  /// Completes the table (TableWriter::finish). Call after the run.
  void finish(FileSet* together = nullptr) { writer_.finish(together); }

 private:
  RowSource source_;
  TableWriter writer_;
  std::uint64_t every_;
};

/// Returns the source of trajectory.csv: one line per recorded step. `inside`: see TrajectoryGroup.
RowSource trajectory_rows(const TrajectoryExtras& extras = {}, const InsideObserver* inside = nullptr);
/// Returns the source of contacts.csv: one line per rendered contact, in the order of the force law's input.
RowSource contact_rows();
/// Returns the source of contact_trace.csv: one line per colliding point, in the order in which the search found
/// them.
RowSource contact_trace_rows();
/// Returns the source of stiffness_tensor.csv: one line per recorded step.
RowSource stiffness_rows();

/// Stiffness shaping as two operations on contacts that were padded to whole SIMD packs (ContactBuffer::pad). The
/// caller passes the operations in, because the folder results/ does not depend on any force law.
struct ShapingOperations {
  /// Sets all weights to 1; returns the stiffness tensor S.
  Mat3 (*start)(ContactBuffer& contacts) noexcept = nullptr;
  /// Updates the weights once, given the stiffness tensor S of the current weights; returns the new S.
  Mat3 (*update)(ContactBuffer& contacts, const Mat3& S) noexcept = nullptr;
};

/// Returns the source of ratios.csv: how the stiffness ratios of the rendered contacts converge with the number of
/// shaping updates (thesis 3.4, Fig. 5). The table does not depend on the force law of the run. For each recorded step
/// with contact, the table has one line for each number of updates m in `iterations`. The first update starts from
/// equal weights of 1. `iterations`: numbers >= 0 in any order; duplicates are ignored. `capacity`: largest number of
/// contacts in a step. A step costs as many updates as the largest m; the cost of one update is proportional to the
/// number of contacts.
RowSource ratio_rows(std::vector<int> iterations, ShapingOperations shaping, std::size_t capacity);

/// Returns the source of energy.csv: the energy balance, one line per recorded step. Precondition: the recorder
/// observes after `ledger`.
RowSource energy_rows(const EnergyLedger& ledger);
/// Returns the source of ideal_trajectory.csv: one line per step that `observer` compares with the ideal trajectory.
/// A step has no line if the ideal trajectory does not exist at the tilt of the tool in this step (thesis Fig. 7).
/// Precondition: the recorder observes after `observer` and records every step.
RowSource ideal_trajectory_rows(const IdealTrajectoryObserver& observer);
/// Returns the source of force_reference.csv: reference force and error of the rendered force. Precondition: the
/// recorder observes after `observer`.
RowSource force_reference_rows(const ForceFidelityObserver& observer);

/// Returns the source of six_dof.csv: force and torque of a 6-DOF device, and the force of the law on a 3-DOF device.
/// `row` has the equilibria of both devices in the recorded step. Precondition: the recorder observes after the
/// observer that writes `row`.
RowSource six_dof_rows(const SixDofRow& row);

/// Writes targets.csv: one line for each target in `rows`, in the same order. `rows` are the results of all subjects
/// and trials. Throws IoError.
void write_target_table(const TableTarget& target, const std::vector<TargetRow>& rows, FileSet* together = nullptr);

/// Documentation of the tables above, with all columns.
extern const ResultTable kTrajectoryTable, kContactTable, kContactTraceTable, kStiffnessTable, kRatioTable,
    kEnergyTable, kIdealTrajectoryTable, kForceReferenceTable, kSixDofTable, kTargetTable;

}  // namespace hapbench
