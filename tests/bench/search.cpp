#include "tests/bench/search.hpp"

#include <fmt/format.h>

#include <cmath>

#include "sim/contact/neighbour_list_query.hpp"
#include "tests/bench/bench.hpp"
#include "tests/support/searches.hpp"
#include "tests/support/tool_kinds.hpp"

namespace hapbench::bench {
namespace {

/// The definition in long double takes 30 ms a pose.
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
      // Coordinates of 1 cm are subtracted and rotated in double: a few of their roundings decide nothing.
      if (std::abs(slack) > 1e-16L && found != (slack > 0.0L)) return fmt::format("pose {}, point {}", k, i);
    }
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
    state.PauseTiming();  // back to the first pose, where a list is warm
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

std::unique_ptr<ContactQuery> make_search(const std::string& search, const PointShell& shell, const ToolShape& tool) {
  if (search == "brute_force") return std::make_unique<ShellQuery>(shell, tool);
  if (search == "grid") return std::make_unique<GridQuery>(shell, tool);
  return std::make_unique<NeighbourListQuery>(shell, tool);
}

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

void register_search() {
  for (const char* search : kSearches) {
    for (const char* task : kTasks) {
      benchmark::RegisterBenchmark(fmt::format("search/{}/{}", search, task).c_str(), search_benchmark,
                                   std::string(search), std::string(task));
    }
  }
}

}  // namespace hapbench::bench
