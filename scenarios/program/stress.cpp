#include "scenarios/program/stress.hpp"

#include <fmt/format.h>

#include "scenarios/analysis/stress/law_stress.hpp"
#include "scenarios/program/report.hpp"

namespace hapbench {
namespace {

struct StressOptions : CommonOptions {
  std::uint64_t count = 100'000, seed = 1;
};

Columns<StressCounts> stress_columns() {
  using Row = StressCounts;
  return {{"algorithm", "", "force algorithm", &Row::algorithm, under("algorithm")},
          {"sets", "1", "random contact sets drawn", &Row::sets, under("sets")},
          {"in_contact", "1", "sets whose tool touches a point", &Row::in_contact, under("in contact")},
          {"non_finite", "1", "answers that are not finite", &Row::non_finite, under("non-finite")},
          {"out_of_bound", "1", "finite answers beyond what the law allows", &Row::out_of_bound, under("out of bound")},
          {"points_dropped", "1", "contacts left out because the reduction already had its largest number of points",
           &Row::points_dropped, under("points dropped")},
          {"largest_force_per_K_d", "1", "largest ||f_spring|| in units of K times the set's deepest penetration",
           &Row::largest_force, under("largest |f|/(K d)")},
          {"largest_share_of_bound", "1",
           "largest ||f_spring|| divided by the bound that the algorithm guarantees; empty if it guarantees none",
           &Row::largest_share, under("fraction of bound", 3)},
          {"first_bad_set", "1", "index of the first contact set with a force that is not finite or above the bound",
           &Row::first_bad, kOnlyJson}};
}

int stress(const StressOptions& options, ProgramContext& context) {
  const Layout layout = context.layout();
  Report report(options, "stress", "stress", context);
  const std::vector<StressCounts> all =
      stress_laws(options.count, options.seed, job_options(options, "stress", context));
  const Columns<StressCounts> columns = stress_columns();
  report.write("stress.csv", columns, all);
  report.show(columns.table(all, "forces in degenerate contact sets", layout.in_full()));
  report.add_text("\n");
  report.add_text(layout.wrapped(
      "every force must be finite and within the bound that its algorithm guarantees: the columns \"non-finite\" and "
      "\"out of bound\" must be 0. \"points dropped\": contacts left out because the reduction keeps at most n_ext "
      "points",
      0));
  report.json() = columns.json_list(all);
  // Report each law with an invalid force as a failure.
  for (const StressCounts& c : all) {
    if (!c.first_bad) continue;
    report.fault(
        fmt::format("{}: {} of {} forces are not finite, {} are above the bound; the first in set {} of seed {}",
                    c.algorithm, c.non_finite, c.sets, c.out_of_bound, *c.first_bad, options.seed),
        kUnexpectedOutcome);
  }
  return report.finish();
}

}  // namespace

std::vector<DescribedTable> stress_tables() {
  return {stress_columns().described("stress.csv", "written by stress: one line per algorithm")};
}

void add_stress(CommandLine& line) {
  auto [command, options] = line.command(
      "stress",
      "Pass random degenerate contact sets to every force law, including the laws of --module, and count invalid "
      "forces.",
      stress);
  command.add("--count <n>", options.count, "number of contact sets (default: 100000)",
              {.range = {{1, 1'000'000'000}}});
  command.add("--seed <n>", options.seed, "seed of the random numbers (default: 1)",
              {.range = {{0, std::int64_t{1} << 53}}});
  add_jobs(command, options.jobs);
  add_out(command, options.out, "stress");
  add_table(command, options.output);
  command.footer(
      "Invalid: a force that is infinite or not a number, or, for a law with a proven bound, larger than this bound. "
      "Contact sets include zero normals, coincident points and opposite gradients.\n\n"
      "Result: a law passes if its columns \"non-finite\" and \"out of bound\" (stress.csv: non_finite, out_of_bound) "
      "are 0.\n\n"
      "Files: stress.csv has one row per law; it replaces an earlier one.\n\n"
      "Time: about 5 s on two processors for the default number of sets.\n\n"
      "Exit status: 0 if all laws pass, 3 if a law returns an invalid force.");
}

}  // namespace hapbench
