#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

#include "sim/contact/neighbour_list_query.hpp"
#include "tests/bench/bench.hpp"
#include "tests/bench/search.hpp"
#include "tests/bench/shell.hpp"
#include "tests/support/searches.hpp"

/// What shells and searches cost as the block's grid gets finer. The poses are T2's, so contacts grow with the points.
namespace hapbench::bench {
namespace {

constexpr std::size_t kPoints[] = {10'000, 30'000, 100'000, 300'000};
constexpr std::size_t kManyPoints[] = {1'000'000, 3'000'000, 7'000'000};

/// The block of T2 with a grid that gives about so many points: their number is its surface in units of the grid.
Scenario block_of(std::size_t points) {
  Scenario scenario = step_scenario("T2").scenario;
  double& grid = std::get<BlockEnvironment>(scenario.environment).grid;
  grid *= std::sqrt(static_cast<double>(block_shell()->size()) / static_cast<double>(points));
  return scenario;
}

/// Its shell. The last one is kept: benchmarks come by size, and the largest take gigabytes.
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

/// The poses at which brute force is asked, a few of T2.
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

/// Poses of all tasks: in T1 the tool comes down from free air, where a new list has to look furthest.
std::vector<ToolPose> some_poses() {
  constexpr std::size_t kEvery = 64;
  std::vector<ToolPose> poses;
  for (const char* task : kTasks) {
    const auto& all = task_scene(task).poses;
    for (std::size_t k = 0; k < all.size(); k += kEvery) poses.push_back(all[k]);
  }
  return poses;
}

/// A search that has to make its list anew, as the longest step does.
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
  // Of each pose the shortest time: what is slow every time is the program's doing.
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
