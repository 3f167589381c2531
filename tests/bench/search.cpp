#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <malloc.h>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <memory>
#include <string>

#include "sim/contact/contact_source.hpp"
#include "sim/contact/neighbour_list_query.hpp"
#include "tests/bench/bench.hpp"
#include "tests/bench/task_scene.hpp"
#include "tests/support/searches.hpp"
#include "tests/support/tool_kinds.hpp"

/// The searches for contacts and the shells that they search, also as the grid of the block gets finer.
namespace hapbench::bench {
namespace {
/// The searches that are compared.
constexpr const char* kSearches[] = {"brute_force", "grid", "neighbour_list"};

/// Brute force takes 30 us per pose, so it is called at every 16th pose only. The answer of other searches may depend
/// on earlier poses, so they are called at all poses and compared at every 16th.
constexpr std::size_t kBruteForceEvery = 16;

/// The definition in long double takes 30 ms per pose.
constexpr std::size_t kDefinitionEvery = 4096;

std::string wrong_by_definition(const TaskScene& scene) {
  ShellQuery query(*scene.shell, *scene.tool);
  ContactBuffer contacts(query.capacity());
  const Cylinder tool = make_cylinder(scene.loaded.scenario.tool);
  for (std::size_t k = 0; k < scene.poses.size(); k += kDefinitionEvery) {
    query.contacts_at(scene.poses[k], contacts);
    std::size_t next = 0;
    for (std::size_t i = 0; i < scene.shell->size(); ++i) {
      const bool found = next < contacts.size() && contacts.index[next] == i;
      if (found) ++next;
      const Vec3 point = scene.shell->point(i).position;
      const long double slack = test::slack(tool, scene.poses[k], point.cast<long double>());
      // Slacks within the rounding of coordinates of 1 cm are not compared.
      if (std::abs(slack) > 1e-16L && found != (slack > 0.0L)) return fmt::format("pose {}, point {}", k, i);
    }
  }
  return "";
}

std::unique_ptr<ContactQuery> make_search(const std::string& search, const PointShell& shell, const ToolShape& tool) {
  if (search == "brute_force") return std::make_unique<ShellQuery>(shell, tool);
  if (search == "grid") return std::make_unique<GridQuery>(shell, tool);
  return std::make_unique<NeighbourListQuery>(shell, tool);
}

/// Says what the search answers wrongly along the poses of the scene; empty if nothing. Brute force is compared with
/// the definition of the tool's body, the others with brute force.
std::string wrong_answers(const std::string& search, const TaskScene& scene) {
  if (search == "brute_force") return wrong_by_definition(scene);
  const auto query = make_search(search, *scene.shell, *scene.tool);
  ShellQuery brute(*scene.shell, *scene.tool);
  ContactBuffer found(query->capacity()), all(brute.capacity());
  for (std::size_t k = 0; k < scene.poses.size(); ++k) {
    query->contacts_at(scene.poses[k], found);
    if (k % kBruteForceEvery != 0) continue;
    brute.contacts_at(scene.poses[k], all);
    if (!test::same_contacts(found, all)) return fmt::format("not brute force's contacts at pose {}", k);
  }
  return "";
}

void search_benchmark(benchmark::State& state, const std::string& search, const std::string& task) {
  const TaskScene& scene = task_scene(task);
  if (!proved(state, search + task, [&] { return wrong_answers(search, scene); })) return;
  const auto query = make_search(search, *scene.shell, *scene.tool);
  ContactBuffer contacts(query->capacity());
  const std::size_t every = search == "brute_force" ? kBruteForceEvery : 1;
  const auto batch = static_cast<benchmark::IterationCount>((scene.poses.size() - 1) / every);
  std::uint64_t found = 0, queries = 0, tested = 0;
  while (state.KeepRunningBatch(batch)) {
    state.PauseTiming();  // back to the first pose, with a warm list
    tested += query->work().points_tested;
    query->reset();
    query->contacts_at(scene.poses[0], contacts);
    state.ResumeTiming();
    for (benchmark::IterationCount k = 1; k <= batch; ++k) {
      query->contacts_at(scene.poses[static_cast<std::size_t>(k) * every], contacts);
      found += contacts.size();
    }
    queries += static_cast<std::uint64_t>(batch);
  }
  tested += query->work().points_tested;
  state.counters["contacts"] = static_cast<double>(found) / static_cast<double>(queries);
  state.counters["points_tested"] = static_cast<double>(tested) / static_cast<double>(queries);
}

}  // namespace

void register_search() {
  for (const char* search : kSearches) {
    for (const char* task : kTasks) {
      benchmark::RegisterBenchmark(fmt::format("search/{}/{}", search, task).c_str(), search_benchmark,
                                   std::string(search), std::string(task));
    }
  }
}

namespace {

bool same_points(const PointShell& a, const PointShell& b) {
  if (a.size() != b.size()) return false;
  for (const auto column :
       {&PointShell::x, &PointShell::y, &PointShell::z, &PointShell::nx, &PointShell::ny, &PointShell::nz}) {
    if (!std::equal((a.*column)(), (a.*column)() + a.size(), (b.*column)())) return false;
  }
  return true;
}

/// A line of /proc/self/status [bytes]; 0 if there is none.
double memory(const std::string& key) {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    double kB = 0.0;
    if (word == key + ":" && status >> kB) return 1024.0 * kB;
  }
  return 0.0;
}

/// Growth of the process while it builds the shell [bytes].
double memory_of_building(const Scenario& scenario) {
  malloc_trim(0);                               // returns free memory to the system
  std::ofstream("/proc/self/clear_refs") << 5;  // resets the peak
  const double before = memory("VmRSS");
  benchmark::DoNotOptimize(built_shell(scenario));
  return memory("VmHWM") - before;
}

/// Times the construction of the scenario's shell, after comparing it with the exact surface of the block and with
/// `again`, the same shell built before. Counters: points, and bytes_per_point, the peak growth of the process.
void build_shells(benchmark::State& state, const Scenario& scenario, const PointShell& again) {
  // A vertex lies on an edge that crosses the surface, so its distance from the surface is at most the length of the
  // edge. Marching cubes has a test of its own.
  const auto& block = std::get<BlockEnvironment>(scenario.environment);
  for (std::size_t i = 0; i < again.size(); ++i) {
    if (std::abs(signed_distance(block.block, again.point(i).position)) > block.grid) {
      return refute(state, "off the surface");
    }
  }
  const double bytes = memory_of_building(scenario);
  std::shared_ptr<const PointShell> shell;
  for (auto _ : state) {
    shell.reset();
    shell = built_shell(scenario);
  }
  if (!same_points(*shell, again)) return refute(state, "another shell the second time");
  state.counters["points"] = static_cast<double>(shell->size());
  state.counters["bytes_per_point"] = bytes / static_cast<double>(shell->size());
}

void build_block(benchmark::State& state) {
  build_shells(state, step_scenario("T1").scenario, *block_shell());
}

}  // namespace

void register_shells() {
  benchmark::RegisterBenchmark("shell/build", build_block)->Unit(benchmark::kMillisecond);
}

namespace {

constexpr std::size_t kPoints[] = {10'000, 30'000, 100'000, 300'000};
constexpr std::size_t kManyPoints[] = {1'000'000, 3'000'000, 7'000'000};

/// The block of T2 with a grid that gives about so many points. Their number is the surface in units of the grid.
Scenario block_of(std::size_t points) {
  Scenario scenario = step_scenario("T2").scenario;
  double& grid = std::get<BlockEnvironment>(scenario.environment).grid;
  grid *= std::sqrt(static_cast<double>(block_shell()->size()) / static_cast<double>(points));
  return scenario;
}

/// The shell of block_of. Keeps the last one only, because benchmarks are ordered by size and large shells take
/// gigabytes.
std::shared_ptr<const PointShell> shell_of(std::size_t points) {
  static std::size_t kept = 0;
  static std::shared_ptr<const PointShell> shell;
  if (kept != points) {
    shell.reset();
    shell = built_shell(block_of(points));
    kept = points;
  }
  return shell;
}

void build(benchmark::State& state, std::size_t points) {
  const Scenario scenario = block_of(points);
  build_shells(state, scenario, *shell_of(points));
}

/// Poses of T2 between calls of brute force.
constexpr std::size_t kProofEvery = 1024;

std::string wrong_search(ContactQuery& query, const PointShell& shell) {
  const TaskScene& scene = task_scene("T2");
  ShellQuery brute(shell, *scene.tool);
  ContactBuffer found(query.capacity()), all(brute.capacity());
  for (std::size_t k = 0; k < scene.poses.size(); k += kProofEvery) {
    query.contacts_at(scene.poses[k], found);
    brute.contacts_at(scene.poses[k], all);
    if (!test::same_contacts(found, all)) return fmt::format("not brute force's contacts at pose {}", k);
  }
  return "";
}

void search(benchmark::State& state, const std::string& name, std::size_t points) {
  const auto shell = shell_of(points);
  const TaskScene& scene = task_scene("T2");
  const auto query = make_search(name, *shell, *scene.tool);
  if (!proved(state, fmt::format("growth/{}/{}", name, points), [&] { return wrong_search(*query, *shell); })) return;
  ContactBuffer contacts(query->capacity());
  const std::size_t every = name == "brute_force" ? kProofEvery : 1;
  const auto batch = static_cast<benchmark::IterationCount>(scene.poses.size() / every);
  double found = 0.0;
  query->contacts_at(scene.poses.back(), contacts);
  while (state.KeepRunningBatch(batch)) {
    found = 0.0;
    for (std::size_t k = 0; k < scene.poses.size(); k += every) {
      query->contacts_at(scene.poses[k], contacts);
      found += static_cast<double>(contacts.size());
    }
  }
  state.counters["points"] = static_cast<double>(shell->size());
  state.counters["contacts"] = found / static_cast<double>(batch);
}

/// Poses of all tasks. In T1 the tool comes down from free air, where building a list takes longest.
std::vector<ToolPose> some_poses() {
  constexpr std::size_t kEvery = 64;
  std::vector<ToolPose> poses;
  for (const char* task : kTasks) {
    const auto& all = task_scene(task).poses;
    for (std::size_t k = 0; k < all.size(); k += kEvery) poses.push_back(all[k]);
  }
  return poses;
}

/// A search that builds its list anew, as in the longest step.
void list_rebuild(benchmark::State& state, std::size_t points) {
  using Clock = std::chrono::steady_clock;
  constexpr int kRepeats = 5;
  const auto shell = shell_of(points);
  const std::vector<ToolPose> poses = some_poses();
  NeighbourListQuery query(*shell, *task_scene("T2").tool);
  ContactBuffer contacts(query.capacity());
  const auto rebuild = [&](const ToolPose& pose) {
    query.reset();
    query.contacts_at(pose, contacts);
  };
  // The shortest time of each pose excludes disturbances by the machine.
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

void register_size(std::size_t points) {
  benchmark::RegisterBenchmark(fmt::format("growth/shell/{}", points).c_str(), build, points)
      ->Unit(benchmark::kMillisecond);
  for (const char* name : kSearches) {
    benchmark::RegisterBenchmark(fmt::format("growth/search/{}/{}", name, points).c_str(), search, std::string(name),
                                 points);
  }
  benchmark::RegisterBenchmark(fmt::format("growth/list_rebuild/{}", points).c_str(), list_rebuild, points);
}

}  // namespace

void register_growth_over_points(bool full) {
  for (const std::size_t points : kPoints) register_size(points);
  if (!full) return;
  for (const std::size_t points : kManyPoints) register_size(points);
}

}  // namespace hapbench::bench
