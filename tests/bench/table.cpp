#include "tests/bench/table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <functional>
#include <thread>

#include "results/observe/step_latency.hpp"
#include "results/observe/step_times.hpp"
#include "results/summary/provenance.hpp"
#include "scenarios/run/environment_points.hpp"
#include "tests/bench/search.hpp"
#include "tests/bench/step.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/program.hpp"

namespace hapbench::bench {
namespace {

/// One line of the table.
struct Target {
  std::string what;
  std::string measured;
  std::string limit;
  bool met = false;
};
using Targets = std::vector<Target>;

Target at_most(std::string what, double value, double limit, const char* unit, const std::string& note = "") {
  return {std::move(what), fmt::format("{:.3g} {}{}", value, unit, note), fmt::format("≤ {:g} {}", limit, unit),
          value <= limit};
}

/// Latency of `step(k)` for k below n.
template <class Step>
StepLatency latency_of(std::size_t n, Step step) {
  StepTimes times(n);
  times.start();
  for (std::size_t k = 0; k < n; ++k) {
    step(k);
    times.lap();
  }
  return step_latency(times.nanoseconds(), times.overhead());
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

/// Of several times [ms] that `work` takes.
double median_ms(const std::function<void()>& work) {
  std::vector<double> ms;
  for (int i = 0; i < 7; ++i) {
    const auto start = std::chrono::steady_clock::now();
    work();
    ms.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
  }
  return median(ms);
}

void require(const std::string& what, const std::string& wrong) {
  if (!wrong.empty()) throw std::runtime_error(what + ": " + wrong);
}

/// Median of a search over the task's poses [us].
double search_median(const std::string& search, const TaskScene& scene) {
  const auto query = make_search(search, scene);
  ContactBuffer contacts(query->capacity());
  const std::size_t every = search == "brute_force" ? kBruteForceEvery : 1;
  query->contacts_at(scene.poses[0], contacts);
  const StepLatency latency = latency_of((scene.poses.size() - 1) / every, [&](std::size_t k) {
    query->contacts_at(scene.poses[(k + 1) * every], contacts);
  });
  return latency.p50 / 1e3;
}

void add_searches(Targets& targets) {
  constexpr double kGridLimit = 0.03, kListLimit = 0.01;
  for (const char* task : kTasks) {
    const TaskScene& scene = task_scene(task);
    for (const char* search : kSearches) require(search, wrong_answers(search, scene));
    const double brute = search_median("brute_force", scene);
    for (const auto& [search, limit] : {std::pair("grid", kGridLimit), std::pair("neighbour_list", kListLimit)}) {
      const double us = search_median(search, scene);
      targets.push_back({fmt::format("`search/{}/{}`, median", search, task),
                         fmt::format("{:.3f} µs of {:.1f} µs = {:.4f}", us, brute, us / brute),
                         fmt::format("≤ {:g} of brute force", limit), us / brute <= limit});
    }
  }
}

/// The same run several times: it takes the same steps, so what is slow in every one is the program's doing and what is
/// slow in one is the machine's.
struct RepeatedRun {
  static constexpr int kRuns = 5;
  StepLatency all;   ///< of the steps of all runs
  StepLatency best;  ///< of each step's shortest time
};

RepeatedRun repeated(TimedRun& run) {
  std::vector<std::uint32_t> all, best;
  std::uint32_t overhead = 0;
  for (int i = 0; i < RepeatedRun::kRuns; ++i) {
    StepTimes times(run.steps_left());
    run.rewind();
    times.start();
    while (run.simulation().step()) times.lap();
    const auto ns = times.nanoseconds();
    all.insert(all.end(), ns.begin(), ns.end());
    if (best.empty()) best.assign(ns.begin(), ns.end());
    for (std::size_t k = 0; k < ns.size(); ++k) best[k] = std::min(best[k], ns[k]);
    overhead = times.overhead();
  }
  return {step_latency(all, overhead), step_latency(best, overhead)};
}

void add_steps(Targets& targets) {
  for (const std::string name : {"T1", "T2", "T2_proxy", "T3", "unreduced_1000"}) {
    require(name, wrong_run(name));
    TimedRun run(name);
    const RepeatedRun latency = repeated(run);
    const bool task = name == "T1" || name == "T2" || name == "T3";
    const std::string contacts = fmt::format(" ({:.0f} contacts)", run.metrics().metrics().colliding_mean);
    targets.push_back(
        at_most(fmt::format("`step/{}`, median", name), latency.all.p50 / 1e3, task ? 3.0 : 10.0, "µs", contacts));
    if (!task) continue;
    targets.push_back(at_most(fmt::format("`step/{}`, 99.9 %", name), latency.all.p99_9 / 1e3, 25.0, "µs"));
    targets.push_back(
        {fmt::format("`step/{}`, steps over 488 µs", name),
         fmt::format("{} in every run (longest {:.1f} µs), {} in single ones of {} steps", latency.best.misses[1],
                     latency.best.max / 1e3, latency.all.misses[1], latency.all.steps),
         "none in every run", latency.best.misses[1] == 0});
  }
}

/// Too short for the clock: a hundred steps at a time.
void add_free_air(Targets& targets) {
  constexpr std::size_t kTogether = 100;
  require("free_air", wrong_run("free_air"));
  TimedRun run("free_air");
  run.rewind();
  const StepLatency latency = latency_of(run.steps_left() / kTogether, [&run](std::size_t) {
    for (std::size_t k = 0; k < kTogether; ++k) run.simulation().step();
  });
  targets.push_back(at_most("`step/free_air`, median", latency.p50 / static_cast<double>(kTogether), 50.0, "ns"));
}

void add_shells(Targets& targets) {
  const Scenario& scenario = step_scenario("T1").scenario;
  targets.push_back(
      at_most("`shell/build`, block at 0.1 mm", median_ms([&] { environment_points(scenario); }), 500.0, "ms"));
}

test::ProgramRun run_quietly(std::vector<std::string> arguments, const std::vector<std::string>& overrides) {
  const test::TemporaryDirectory directory;
  arguments.insert(arguments.begin(), {"run", "--quiet", "--out", directory.path().string()});
  for (const std::string& value : overrides) arguments.insert(arguments.end(), {"--set", value});
  test::ProgramRun run = test::hapbench(arguments);
  if (run.status != 0) throw std::runtime_error("hapbench " + arguments.back() + ": " + run.err);
  return run;
}

/// Processes are measured first: the system counts this process's memory among that of its children.
void add_processes(Targets& targets) {
  constexpr double kSimulated = 65.0;  // [s]
  const test::ProgramRun tasks =
      run_quietly({"poke_on_flat", "rotate_in_hole", "round_the_wall"},
                  {"record.trajectory=false", "record.ratio_iterations=[]", "record.ideal_trajectory=false"});
  const double faster = kSimulated / tasks.cpu_seconds;
  targets.push_back({"tasks 1–3, 65 s at 2048 Hz, nothing recorded, shells built",
                     fmt::format("{:.3g} s = {:.0f} × real time", tasks.cpu_seconds, faster), "≥ 60 ×",
                     faster >= 60.0});
  targets.push_back(at_most("their memory", static_cast<double>(tasks.peak_memory) / 1e6, 150.0, "MB"));
  const std::pair<const char*, std::vector<std::string>> small[] = {
      {"single_spring", {"time.steps=2000"}},
      {"peg_in_hole_2d_shaped_stiffness",
       {"time.steps=2000", "time.stop_when=[]", "record.ratio_iterations=[]", "expect.outcome=completes"}}};
  for (const auto& [name, overrides] : small) {
    std::vector<double> ms;
    for (int i = 0; i < 7; ++i) ms.push_back(1e3 * run_quietly({name}, overrides).wall_seconds);
    targets.push_back(
        at_most(fmt::format("`hapbench run {}`, 2000 steps, start to end", name), median(ms), 30.0, "ms"));
  }
}

void print(const Targets& targets) {
  const Provenance program = provenance();
  const InstructionSet instructions = instruction_set();
  fmt::print("{}, {} processors; {}, {} {}, {}; commit {}\n\n", program.cpu, std::thread::hardware_concurrency(),
             program.compiler, program.build_type, program.flags, instructions.widest, program.commit);
  fmt::print("| target | measured | limit | met |\n|---|---|---|---|\n");
  for (const Target& t : targets) {
    fmt::print("| {} | {} | {} | {} |\n", t.what, t.measured, t.limit, t.met ? "yes" : "**no**");
  }
}

}  // namespace

int print_table() {
  Targets processes, targets;
  add_processes(processes);
  add_searches(targets);
  add_steps(targets);
  add_free_air(targets);
  add_shells(targets);
  targets.insert(targets.end(), processes.begin(), processes.end());
  print(targets);
  return 0;
}

}  // namespace hapbench::bench
