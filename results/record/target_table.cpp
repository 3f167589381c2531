#include "results/record/target_table.hpp"

#include <optional>

#include "results/io/csv_writer.hpp"

namespace hapbench {

void write_target_table(const std::filesystem::path& file, const std::vector<TargetRow>& rows) {
  CsvWriter csv(file, kTargetColumns);
  for (const TargetRow& row : rows) {
    const bool any = row.rows_on_target > 0;
    csv.row(std::uint64_t{row.subject}, std::uint64_t{row.trial}, std::uint64_t{row.target},
            std::uint64_t{row.result.place}, std::uint64_t{row.result.removed}, row.result.time, row.rows_on_target,
            any ? std::optional(row.model_force) : std::nullopt, any ? std::optional(row.speed) : std::nullopt);
  }
  csv.finish();
}

}  // namespace hapbench
