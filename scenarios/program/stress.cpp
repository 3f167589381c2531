#include <fmt/format.h>

#include "scenarios/limits/stress/law_stress.hpp"
#include "scenarios/program/index.hpp"
#include "scenarios/program/report.hpp"

namespace hapbench {
namespace {

struct StressOptions : CommonOptions {
  std::uint64_t count = 100'000;
  std::uint64_t seed = 1;
};

Columns<StressCounts> stress_columns() {
  Columns<StressCounts> columns;
  columns.add("algorithm", "", "force algorithm", &StressCounts::algorithm, {.heading = "algorithm"});
  columns.add("sets", "1", "random contact sets drawn", &StressCounts::sets, {.heading = "sets"});
  columns.add("in_contact", "1", "sets whose tool touches a point", &StressCounts::in_contact,
              {.heading = "in contact"});
  columns.add("non_finite", "1", "answers that are not finite", &StressCounts::non_finite, {.heading = "non-finite"});
  columns.add("out_of_bound", "1", "finite answers beyond what the law allows", &StressCounts::out_of_bound,
              {.heading = "out of bound"});
  columns.add("points_dropped", "1", "contacts that a full reduction refused", &StressCounts::points_dropped,
              {.heading = "points dropped"});
  columns.add("largest_force_per_K_d", "1", "largest ||f_spring|| in units of K times the set's deepest penetration",
              &StressCounts::largest_force, {.heading = "largest |f|/(K d)"});
  columns.add("largest_share_of_bound", "1",
              "largest ||f_spring|| in units of the law's bound; empty for laws without one",
              &StressCounts::largest_share, {.heading = "of its bound", .digits = 3});
  columns.add("first_bad_set", "1", "number of the first set with a bad answer", &StressCounts::first_bad, only_json());
  return columns;
}

int stress(const StressOptions& options) {
  Report report(options, "stress");
  const std::vector<StressCounts> all = stress_laws(options.count, options.seed, job_options(options, "stress"));
  const Columns<StressCounts> columns = stress_columns();
  report.write("stress.csv", columns, all);
  report.say(columns.table(all).text());
  for (const StressCounts& c : all) {
    report.json().push_back(columns.json(c));
    if (!c.first_bad) continue;
    report.fault(fmt::format("{}: {} of {} forces are not finite, {} out of bound; the first in set {} of seed {}",
                             c.algorithm, c.non_finite, c.sets, c.out_of_bound, *c.first_bad, options.seed),
                 kUnexpectedOutcome);
  }
  return report.finish();
}

}  // namespace

std::vector<DescribedTable> stress_tables() {
  return {stress_columns().described("stress.csv", "of stress: one line per algorithm")};
}

void add_stress(CommandLine& line) {
  auto [command, options] = line.command(
      "stress", "Pass random degenerate contact sets through every algorithm, and count what no law may give", stress);
  command.add("--count", options.count, "contact sets (default: 100000)", {.range = {{1, 1'000'000'000}}});
  command.add("--seed", options.seed, "of the random numbers (default: 1)", {.range = {{0, std::int64_t{1} << 53}}});
  add_jobs(command, options.jobs);
  add_out(command, options.out, "stress");
}

}  // namespace hapbench
