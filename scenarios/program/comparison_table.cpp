#include "scenarios/program/comparison_table.hpp"

#include <algorithm>

#include "results/io/atomic_file.hpp"
#include "results/summary/outcome_names.hpp"
#include "scenarios/description/metric_sections.hpp"
#include "scenarios/description/scenario.hpp"

namespace hapbench {
namespace {

/// Other programs read these by their place: new ones go behind the last.
constexpr const char* kMetrics[] = {"force_max_N",
                                    "velocity_total_variation_m_per_s",
                                    "force_reversals",
                                    "vibration_power_above_30Hz_m2_per_s2",
                                    "depth_max_m",
                                    "ratio_min",
                                    "ratio_max",
                                    "steps_in_contact",
                                    "contact_share",
                                    "landings",
                                    "landing_force_max_N",
                                    "landing_force_step_max_N",
                                    "settled_s",
                                    "force_mean_in_contact_N",
                                    "settled_force_max_N",
                                    "force_step_p99_N",
                                    "settled_force_step_max_N",
                                    "force_rms_above_30Hz_N",
                                    "force_reversals_per_s",
                                    "reduction_changes",
                                    "reduction_force_step_max_N"};

}  // namespace

std::vector<Column> comparison_columns() {
  std::vector<Column> columns = {
      {"algorithm", "", "force algorithm"}, {"outcome", "", "how the run ended"}, {"steps", "1", "rows of the run"}};
  const MetricList metrics = metrics_without_values();
  for (const char* name : kMetrics) {
    const auto& metric = *std::find_if(metrics.begin(), metrics.end(), [&](const Metric& m) { return m.name == name; });
    columns.push_back({name, metric.unit, metric.meaning});
  }
  return columns;
}

void write_comparison(const std::filesystem::path& file, std::span<const RunReport> reports, std::size_t seeds) {
  std::string text = (seeds > 1 ? "seed," : "") + header_of(comparison_columns()) + "\n";
  for (std::size_t i = 0; i < reports.size(); ++i) {
    const RunSummary& run = reports[i].summary;
    if (seeds > 1) text += std::to_string(i % seeds) + ",";
    text += run.algorithm + "," + std::string(outcome_name(run.result.outcome)) + "," + std::to_string(run.result.rows);
    const MetricList metrics = metric_list(run);
    for (const char* name : kMetrics) text += "," + cell_text(value_of(metrics, name));
    text += "\n";
  }
  write_file_atomically(file, text);
}

}  // namespace hapbench
