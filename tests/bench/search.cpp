#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <malloc.h>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <memory>
#include <string>

#include "scenarios/scene/environments.hpp"
#include "sim/contact/contact_query.hpp"
#include "sim/contact/contact_source.hpp"
#include "tests/bench/bench.hpp"
#include "tests/support/searches.hpp"

/// Times contact searches and the construction of the shells that they search. The growth of these times is measured on
/// blocks with finer and finer grids.
namespace hapbench::bench {
namespace {

/// The searches that are compared.
constexpr const char* kSearches[] = {"brute_force", "neighbour_list"};

std::unique_ptr<ContactQuery> make_search(const std::string& search, const PointShell& shell, const ToolShape& tool) {
  return make_contact_query(shell, tool, search == "brute_force" ? Skips::off : Skips::on);
}

/// A search over a shell at the poses of a task. The result of a search may depend on earlier poses, so the search is
/// called at all poses. The comparison with brute force, and the timing of brute force, use only every n-th pose.
struct Search {
  std::string name;  ///< one of kSearches
  std::shared_ptr<const PointShell> shell;
  const TaskScene& scene;
  std::size_t brute_force_every;

  std::unique_ptr<ContactQuery> make() const { return make_search(name, *shell, *scene.tool); }
  /// Returns the first compared pose at which the search differs from brute force, as a text; empty if there is none.
  std::string wrong() const {
    const auto query = make(), brute = make_search("brute_force", *shell, *scene.tool);
    ContactBuffer found(query->capacity()), all(brute->capacity());
    for (std::size_t k = 0; k < scene.poses.size(); ++k) {
      query->contacts_at(scene.poses[k], found);
      if (k % brute_force_every != 0) continue;
      brute->contacts_at(scene.poses[k], all);
      if (!test::same_contacts(found, all)) return fmt::format("not brute force's contacts at pose {}", k);
    }
    return "";
  }
};

void time_search(benchmark::State& state, const Search& search) {
  const auto& poses = search.scene.poses;
  const bool is_brute = search.name == "brute_force";
  const std::string what =
      fmt::format("{} {} {}", search.name, search.scene.loaded.scenario.name, search.shell->size());
  if (!is_brute && !proved(state, what, [&] { return search.wrong(); })) return;
  const auto query = search.make();
  ContactBuffer contacts(query->capacity());
  const std::size_t every = is_brute ? search.brute_force_every : 1;
  const auto batch = static_cast<benchmark::IterationCount>((poses.size() - 1) / every);
  std::uint64_t found = 0, queries = 0, tested = 0;
  while (state.KeepRunningBatch(batch)) {
    state.PauseTiming();  // returns to the first pose, for which a neighbour list is built
    tested += query->work().points_tested;
    query->reset();
    query->contacts_at(poses[0], contacts);
    state.ResumeTiming();
    for (benchmark::IterationCount k = 1; k <= batch; ++k) {
      query->contacts_at(poses[static_cast<std::size_t>(k) * every], contacts);
      found += contacts.size();
    }
    queries += static_cast<std::uint64_t>(batch);
  }
  tested += query->work().points_tested;
  state.counters["points"] = static_cast<double>(search.shell->size());
  state.counters["contacts"] = static_cast<double>(found) / static_cast<double>(queries);
  state.counters["points_tested"] = static_cast<double>(tested) / static_cast<double>(queries);
}

void search_in_task(benchmark::State& state, const std::string& search, const std::string& task) {
  const TaskScene& scene = task_scene(task);
  time_search(state, {search, scene.shell, scene, 16});
}

void add_searches() {
  for (const char* search : kSearches) {
    for (const char* task : kTasks) {
      benchmark::RegisterBenchmark(fmt::format("search/{}/{}", search, task).c_str(), search_in_task,
                                   std::string(search), std::string(task));
    }
  }
}

/// Returns the value of the line `key` of /proc/self/status [bytes]; 0 if the file has no line with this key.
double memory(const std::string& key) {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    double kB = 0.0;
    if (word == key + ":" && status >> kB) return 1024.0 * kB;
  }
  return 0.0;
}

/// Returns the growth of the process's memory at its peak while it builds the shell [bytes].
double memory_of_building(const Scenario& scenario) {
  malloc_trim(0);                               // returns free memory to the system
  std::ofstream("/proc/self/clear_refs") << 5;  // resets the peak
  const double before = memory("VmRSS");
  benchmark::DoNotOptimize(make_shell(scenario));
  return memory("VmHWM") - before;
}

/// Times the construction of the scenario's shell. Counters: points, and bytes_per_point, the growth of the process's
/// memory at its peak divided by the number of points.
void build_shells(benchmark::State& state, const Scenario& scenario) {
  const double bytes = memory_of_building(scenario);
  std::shared_ptr<const PointShell> shell;
  for (auto _ : state) {
    shell.reset();
    shell = make_shell(scenario);
  }
  state.counters["points"] = static_cast<double>(shell->size());
  state.counters["bytes_per_point"] = bytes / static_cast<double>(shell->size());
}

void add_shell() {
  benchmark::RegisterBenchmark("shell/build", build_shells, step_scenario("T1").scenario)
      ->Unit(benchmark::kMillisecond);
}

constexpr std::size_t kPoints[] = {10'000, 30'000, 100'000, 300'000};
constexpr std::size_t kManyPoints[] = {1'000'000, 3'000'000, 7'000'000};

/// Returns the block of T2 with a grid that gives the surface about `points` points. The number of points is
/// proportional to 1 / grid^2.
Scenario block_of(std::size_t points) {
  Scenario scenario = step_scenario("T2").scenario;
  double& grid = std::get<BlockEnvironment>(scenario.environment).grid;
  grid *= std::sqrt(static_cast<double>(block_shell()->size()) / static_cast<double>(points));
  return scenario;
}

/// Returns the shell of block_of(). Keeps only the last shell, because benchmarks are ordered by size and large shells
/// take gigabytes.
std::shared_ptr<const PointShell> shell_of(std::size_t points) {
  static std::size_t kept = 0;
  static std::shared_ptr<const PointShell> shell;
  if (kept != points) {
    shell.reset();
    shell = make_shell(block_of(points));
    kept = points;
  }
  return shell;
}

void build(benchmark::State& state, std::size_t points) {
  build_shells(state, block_of(points));
}

void search_among(benchmark::State& state, const std::string& search, std::size_t points) {
  time_search(state, {search, shell_of(points), task_scene("T2"), 1024});
}

/// Returns poses of all tasks. T1 includes the descent from free air, during which building a list takes longest.
std::vector<ToolPose> some_poses() {
  constexpr std::size_t kEvery = 64;
  std::vector<ToolPose> poses;
  for (const char* task : kTasks) {
    const auto& all = task_scene(task).poses;
    for (std::size_t k = 0; k < all.size(); k += kEvery) poses.push_back(all[k]);
  }
  return poses;
}

/// Times a search that builds a new neighbour list in each query. In a run, the steps that build a list take longest.
void list_rebuild(benchmark::State& state, std::size_t points) {
  using Clock = std::chrono::steady_clock;
  constexpr int kRepeats = 5;
  const auto shell = shell_of(points);
  const std::vector<ToolPose> poses = some_poses();
  const auto query = make_contact_query(*shell, *task_scene("T2").tool, Skips::on);
  ContactBuffer contacts(query->capacity());
  const auto rebuild = [&](const ToolPose& pose) {
    query->reset();
    query->contacts_at(pose, contacts);
  };
  // Use the shortest time of each pose, which excludes disturbances by the machine.
  double longest = 0.0;
  for (const ToolPose& pose : poses) {
    auto shortest = Clock::duration::max();
    for (int i = 0; i < kRepeats; ++i) {
      const auto start = Clock::now();
      rebuild(pose);
      shortest = std::min<Clock::duration>(shortest, Clock::now() - start);
    }
    longest = std::max(longest, std::chrono::duration<double>(shortest).count());
  }
  while (state.KeepRunningBatch(static_cast<benchmark::IterationCount>(poses.size()))) {
    for (const ToolPose& pose : poses) rebuild(pose);
  }
  state.counters["points"] = static_cast<double>(shell->size());
  state.counters["longest_s"] = longest;
}

void add_size(std::size_t points) {
  benchmark::RegisterBenchmark(fmt::format("growth/shell/{}", points).c_str(), build, points)
      ->Unit(benchmark::kMillisecond);
  for (const char* name : kSearches) {
    benchmark::RegisterBenchmark(fmt::format("growth/search/{}/{}", name, points).c_str(), search_among,
                                 std::string(name), points);
  }
  benchmark::RegisterBenchmark(fmt::format("growth/list_rebuild/{}", points).c_str(), list_rebuild, points);
}

}  // namespace

void register_searches(bool full) {
  add_searches();
  add_shell();
  for (const std::size_t points : kPoints) add_size(points);
  if (!full) return;
  for (const std::size_t points : kManyPoints) add_size(points);
}

}  // namespace hapbench::bench
