#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "results/io/csv_writer.hpp"
#include "scenarios/program/result_tables.hpp"
#include "scenarios/program/stability.hpp"
#include "scenarios/program/table.hpp"
#include "scenarios/studies/stress/law_stress.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

void write_counts(const fs::path& file, const std::vector<StressCounts>& all) {
  CsvWriter csv(file, kStressColumns);
  for (const StressCounts& c : all) {
    csv.row(std::string_view(c.algorithm), c.sets, c.in_contact, c.non_finite, c.out_of_bound, c.points_dropped,
            c.largest_force, c.largest_share);
  }
  csv.finish();
}

bool is_bad(const StressCounts& counts) {
  return counts.non_finite + counts.out_of_bound > 0;
}

Json counts_json(const StressCounts& c) {
  Json json = {{"algorithm", c.algorithm},
               {"sets", c.sets},
               {"in_contact", c.in_contact},
               {"non_finite", c.non_finite},
               {"out_of_bound", c.out_of_bound},
               {"points_dropped", c.points_dropped},
               {"largest_force_per_K_d", c.largest_force},
               {"largest_share_of_bound", c.largest_share ? Json(*c.largest_share) : Json(nullptr)}};
  json["first_bad_set"] = is_bad(c) ? Json(c.first_bad) : Json(nullptr);
  return json;
}

}  // namespace

int stability_stress_command(const StabilityOptions& options) {
  const fs::path out = options.directory("stability_stress");
  require_writable_directory(out);
  const std::vector<StressCounts> all = stress_laws(options.count, options.seed, options.job_options("stress"));
  write_counts(out / "stability_stress.csv", all);

  Table table({{"algorithm", false},
               {"sets"},
               {"in contact"},
               {"non-finite"},
               {"out of bound"},
               {"points dropped"},
               {"largest |f|/(K d)"},
               {"of its bound"}});
  Json json = Json::array();
  int status = kSuccess;
  for (const StressCounts& c : all) {
    table.add({c.algorithm, std::to_string(c.sets), std::to_string(c.in_contact), std::to_string(c.non_finite),
               std::to_string(c.out_of_bound), std::to_string(c.points_dropped), significant(c.largest_force),
               c.largest_share ? significant(*c.largest_share, 3) : "none"});
    json.push_back(counts_json(c));
    if (!is_bad(c)) continue;
    print_error(fmt::format("{}: {} of {} forces are not finite, {} out of bound; the first in set {} of seed {}",
                            c.algorithm, c.non_finite, c.sets, c.out_of_bound, c.first_bad, options.seed));
    status = kUnexpectedOutcome;
  }
  print(options.output, table.text(), json);
  return status;
}

}  // namespace hapbench
