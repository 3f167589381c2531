#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "results/io/table_writer.hpp"
#include "sim/loop/simulation.hpp"

/// The tables that a run writes row by row. Everything is that before the integrator moves the tool.
namespace hapbench {

class EnergyLedger;
class ForceFidelityObserver;
class IdealTrajectoryObserver;
class InsideObserver;
struct TargetRow;

/// The fields of a scenario's `record` that add columns to trajectory.csv.
struct TrajectoryExtras {
  bool pose = false;
  bool torque = false;
  bool inside = false;
};

/// One of these fields and its columns.
struct TrajectoryGroup {
  bool TrajectoryExtras::*is_wanted;
  const char* field;   ///< its name
  const char* effect;  ///< what it does
  std::span<const Column> columns;
  /// Writes a cell for each column. `inside` observes before the recorder; null without an inside.
  void (*fill)(const StepRecord& record, const InsideObserver* inside, std::optional<double>* cells);
  bool wants_roll = false, wants_springs = false;  ///< as those of Observer
};

/// All of them, in the order of their columns.
std::span<const TrajectoryGroup> trajectory_groups();

/// Makes the lines of a table from the rows of a run.
struct RowSource {
  std::vector<Column> columns;
  /// Writes the lines of one row, perhaps none. Allocates nothing.
  std::function<void(const StepRecord& record, TableWriter& table)> write;
  /// As those of Observer.
  bool wants_ratio = false, wants_roll = false, wants_springs = false, wants_found = false;
};

/// An observer that writes one table, to a file or into memory. A file's lines are written during the run through a
/// buffer of fixed size; a run that is interrupted before `finish` leaves none.
class Recorder final : public Observer {
 public:
  /// Keeps rows 0, every, 2 every, … Precondition: every > 0. Throws IoError.
  Recorder(const TableTarget& target, RowSource source, std::uint64_t every = 1);

  bool wants_ratio() const noexcept override { return source_.wants_ratio; }
  bool wants_roll() const noexcept override { return source_.wants_roll; }
  bool wants_springs() const noexcept override { return source_.wants_springs; }
  bool wants_found() const noexcept override { return source_.wants_found; }
  void on_step(const StepRecord& record) noexcept override {
    if (record.step % every_ == 0) source_.write(record, writer_);
  }

  /// After the run: TableWriter::finish.
  void finish(FileSet* together = nullptr) { writer_.finish(together); }

 private:
  RowSource source_;
  TableWriter writer_;
  std::uint64_t every_;
};

/// trajectory.csv: one line per row. `inside` as in TrajectoryGroup.
RowSource trajectory_rows(const TrajectoryExtras& extras = {}, const InsideObserver* inside = nullptr);
/// contacts.csv: one line per rendered contact, in the order in which the force law saw them.
RowSource contact_rows();
/// contact_trace.csv: one line per colliding point, in the order in which the search found them.
RowSource contact_trace_rows();
/// stiffness_tensor.csv: one line per row.
RowSource stiffness_rows();

/// Stiffness shaping as two operations on padded contacts. They are parameters because this folder knows no force law.
struct ShapingOperations {
  /// Sets all weights to 1; returns the stiffness tensor S.
  Mat3 (*start)(ContactBuffer& contacts) noexcept = nullptr;
  /// Updates the weights once, given the S of the present ones; returns the new S.
  Mat3 (*update)(ContactBuffer& contacts, const Mat3& S) noexcept = nullptr;
};

/// ratios.csv: how the stiffness ratios of the rendered contacts converge with the number of shaping updates (thesis
/// 3.4, Fig. 5), whatever law the run uses. For each row with contact, one line per number m >= 0 of updates from equal
/// weights 1, in `iterations` in any order, duplicates once. O(n) per update; as many updates as the largest m.
/// `capacity`: the most contacts a row can have.
RowSource ratio_rows(std::vector<int> iterations, ShapingOperations shaping, std::size_t capacity);

/// energy.csv: the energy balance, one line per row. The recorder must observe after `ledger`.
RowSource energy_rows(const EnergyLedger& ledger);
/// ideal_trajectory.csv: one line per row that `observer` compares and at whose tilt the ideal trajectory exists
/// (thesis Fig. 7). The recorder must observe after `observer` and keep every row.
RowSource ideal_trajectory_rows(const IdealTrajectoryObserver& observer);
/// force_reference.csv: reference force and error of the rendered one. The recorder must observe after `observer`.
RowSource force_reference_rows(const ForceFidelityObserver& observer);

/// targets.csv: the result of every target of every subject's trials, in that order. Throws IoError.
void write_target_table(const TableTarget& target, const std::vector<TargetRow>& rows, FileSet* together = nullptr);

/// The tables above with all their columns.
extern const ResultTable kTrajectoryTable, kContactTable, kContactTraceTable, kStiffnessTable, kRatioTable,
    kEnergyTable, kIdealTrajectoryTable, kForceReferenceTable, kTargetTable;

}  // namespace hapbench
