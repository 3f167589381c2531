#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "results/io/columns.hpp"
#include "scenarios/batch/league.hpp"
#include "scenarios/batch/run_batch.hpp"

/// Does the ranking of a comparison hold when its scenes are sampled more finely? A law may win by the distance of a
/// shell's points or by the time step alone.
namespace hapbench {

/// Half the distance of the shell's points, or half the time step.
enum class Finer { spacing, step };

/// The verdict on a column of numbers, one of each law.
enum class Holding { holds, drifts, flips, unchecked };

/// A verdict in words.
struct HoldingInfo {
  const char* name;     ///< in files
  const char* meaning;  ///< in a sentence without its full stop
};
std::span<const HoldingInfo> holding_infos() noexcept;

/// Numbers closer than this share of the larger one count as equal, before and after.
inline constexpr double kHeld = 0.1;

/// The verdict on a column, and the law that shows it: that of the largest relative change, or where the order flips
/// the two laws that are furthest apart before and after together.
struct ColumnVerdict {
  Holding holding = Holding::holds;
  std::size_t law = 0;
  std::optional<std::size_t> other = {};
};

/// A column of numbers, one of each law, and what each may be wrong by; nothing where there are no tolerances.
struct RankedNumbers {
  std::span<const double> values;
  std::span<const double> tolerances = {};
};

/// Judges a column before and after. Two numbers are apart when they differ by more than kHeld of the larger, by more
/// than kSameRank of the column's largest, and by more than both may be wrong by together. The column
/// - flips when `ranked` and two laws are apart before and after, in opposite order;
/// - drifts when it does not flip and a number after is apart from that before;
/// - holds otherwise.
/// Infinity stands for a law that fails or has no number: worse than all others. Precondition: as many numbers after as
/// before, at least one, none of them NaN.
ColumnVerdict judged_column(const RankedNumbers& before, const RankedNumbers& after, bool ranked);

/// A metric of all laws in a scenario before and after, or a scenario that cannot be sampled more finely.
struct RankingColumn {
  std::string scenario;
  Finer finer = Finer::spacing;
  std::string change;  ///< the field and its values, or why there is no change
  std::string metric;  ///< empty without a change
  /// The number of each law; none where a law failed or has no such number.
  std::vector<std::optional<double>> before = {}, after = {};
  std::vector<std::optional<double>> tolerance_before = {}, tolerance_after = {};  ///< of these
  ColumnVerdict verdict = {Holding::unchecked};
  std::optional<std::size_t> best_before = {}, best_after = {};  ///< of a metric of which less or more is better
};

struct RankingCheck {
  std::vector<std::string> algorithms;
  std::vector<RankingColumn> columns;
};

/// The columns of two leagues of one scenario and the same laws and metrics.
std::vector<RankingColumn> compared_columns(const League& before, const League& after);

/// Runs all of `plan` again at half the distance of the points and at half the step and compares the means with those
/// of `league`, which is of the same plan. Metrics of motion, force and contact are taken at the times of the coarse
/// rows, so that a step of the force means the same; delays of devices keep their length. Writes no files. Throws
/// Stopped.
RankingCheck check_ranking(const BatchPlan& plan, const League& league, const BatchOptions& options);

/// The columns of ranking.csv, which has a row for each column and law.
std::vector<Column> ranking_columns();
/// Writes ranking.csv. Throws IoError.
void write_ranking(const std::filesystem::path& file, const RankingCheck& check);
/// The same rows as objects.
Json ranking_json(const RankingCheck& check);

}  // namespace hapbench
