#include "results/record/target_table.hpp"

#include <optional>
#include <utility>

#include "results/io/table_writer.hpp"

namespace hapbench {

void write_target_table(TableTarget target, const std::vector<TargetRow>& rows) {
  TableWriter table(std::move(target), kTargetColumns);
  for (const TargetRow& row : rows) {
    const bool any = row.rows_on_target > 0;
    table.row(std::uint64_t{row.subject}, std::uint64_t{row.trial}, std::uint64_t{row.target},
              std::uint64_t{row.result.place}, std::uint64_t{row.result.removed}, row.result.time, row.rows_on_target,
              any ? std::optional(row.model_force) : std::nullopt, any ? std::optional(row.speed) : std::nullopt);
  }
  table.finish();
}

}  // namespace hapbench
