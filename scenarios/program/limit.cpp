#include <fmt/format.h>

#include "scenarios/program/command_line.hpp"
#include "scenarios/program/limit_cases.hpp"

namespace hapbench {
namespace {

int limit(const LimitOptions& options) {
  LimitTable table = limit_cases(options);
  const std::string name = options.scenarios.size() > 1 ? "limit" : "limit_" + table.first().scene;
  const std::filesystem::path out = results_directory(options.out, name);
  require_writable_directory(out);
  std::vector<LimitCase> cases;
  for (const LimitRow& row : table.rows) cases.push_back(row.asked);
  add_limits(table, field_limits(cases, job_options(options.jobs, options.output, "limit")));
  Report report(options.output, out);
  tell_limits(table, report);
  report.say(fmt::format("\nresults in {}\n", out.string()));
  return report.finish();
}

}  // namespace

void add_limit(CommandLine& line) {
  auto [command, options] = line.command(
      "limit", "Find how far any field may go, on which device, with which algorithm, by bisection on runs", limit,
      "no limit is written");
  command.add("scenarios", options.scenarios, "scenario files, or names of bundled scenarios").required();
  command.add("--vary", options.field, fmt::format("the field (default: {})", options.field));
  command.add("--between", options.between,
              "a:b, the range to search (default: a thousandth to a thousandfold of the scenario's value)");
  command.flag("--smallest", options.smallest, "find the smallest stable value instead, as of a mass");
  command.add("--algorithms", options.algorithms, "names separated by commas, or all (default: each scenario's own)")
      .comma_separated();
  command
      .add("--device", options.devices,
           "in place of each scene's own: presets, ideal, admittance, files NAME.json, all, or impedance for all "
           "presets, separated by commas; a preset also at both ends of what nobody published of it")
      .comma_separated();
  command
      .add("--friction", options.friction,
           "in place of these ends each device's dry friction times factors, such as 0,2; none: neither")
      .comma_separated();
  command.add("--over", options.over, "ask for each value of another field, too, as sweep --vary takes it; repeatable")
      .repeatable();
  command
      .add("--stable", options.stable,
           "what a run has to do: be settled (come to rest), bounded (vibrating counts, too) or still (a handle that "
           "does not vibrate; default with --device)")
      .one_of({"settled", "bounded", "still"});
  command.add(
      "--vibration", options.vibration,
      fmt::format("of still: the largest vibration of the handle above 30 Hz [m/s rms] (default: {})", kMostVibration));
  command.add("--bound", options.bounds,
              "a stable run keeps metric=most or metric=least:most, too, as inside_settled_m=3e-4; repeatable");
  command.add("--resolution", options.resolution,
              "relative width of the answer (default: 0.001); of the range when the range reaches 0 or below");
  add_jobs(command, options.jobs, "searches at once (default: as many as the machine has threads)");
  command.add("--out", options.out, "directory of the results (default: results/out/limit_NAME)");
  add_overrides(command, options.overrides, "override a field of all runs: path=value");
  add_output_options(command, options.output);
  command.footer(
      "A run is stable when it comes to rest or dies out, the classes of \"hapbench describe stability\". It is not "
      "stable when it vibrates, diverges, goes through the surface, is thrown out (leaves the hole, or ends without contact "
      "beyond the shell's box by more than the tool reaches), loses contact, is stuck, touches nothing, or does not keep a "
      "--bound. Oscillations slower than a quarter of the run are not seen. "
      "The range is tried at 17 values. The first edge upwards of the scenario's own value (of the first stable value, "
      "if that one is not stable; with --smallest downwards, from the high end) is bisected, then the other end of the "
      "interval of stable values, below which a surface may be too soft; three values are tried "
      "on either side of the first edge, which may reveal an earlier edge. The column inconsistent counts unstable values in the interval "
      "and stable ones outside of it. Where the hand is an impedance, a run without environment tells whether "
      "hand and device alone are unstable beyond the edge. Where the springs stay in contact, the theoretical limit "
      "stands beside the edge. A hand with a mass loses it on ideal and admittance, where the virtual mass stands for it. "
      "limit_runs.csv has every run.");
}

}  // namespace hapbench
