#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "algorithms/module/module.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/scene/tools.hpp"
#include "sim/contact/contact_query.hpp"
#include "sim/contact/contact_source.hpp"
#include "tests/bench/bench.hpp"
#include "tests/bench/benchmark_program.hpp"
#include "tests/bench/peers/contact_library.hpp"

/// Times hapbench's search and other libraries at the same poses of the same scenes, as peers/<library>/<task>.
/// Libraries that are not installed are omitted.
namespace hapbench::bench {
namespace {

/// Number of poses from one query to the next. Not every pose is queried, because the libraries take milliseconds per
/// pose.
constexpr std::size_t kEvery = 64;

/// Maximum number of contacts that a library may return. The number is larger than ODE's own limit.
constexpr std::size_t kRoom = 100'000;

struct Library {
  std::string name;
  std::unique_ptr<Peer> (*make)(const HapbenchRun& run);
  bool same_question;  ///< true: the library finds the points of the shell in the drill, like our search
};

std::vector<Library> libraries() {
  std::vector<Library> here;
#ifdef HAPBENCH_PEER_KD_TREE
  here.push_back({"cgal_kd_tree", kd_tree, true});
#endif
#ifdef HAPBENCH_PEER_FCL
  here.push_back({"fcl", fcl, false});
#endif
#ifdef HAPBENCH_PEER_BULLET
  here.push_back({"bullet", bullet, false});
#endif
#ifdef HAPBENCH_PEER_ODE
  here.push_back({"ode", ode, false});
#endif
  return here;
}

/// Returns the block with a hole as points or as triangles, whichever the library needs.
const TriangleSoup& surface_for(const Library& library) {
  static const TriangleSoup points = [] {
    TriangleSoup surface;
    const auto shell = block_shell();
    for (std::size_t i = 0; i < shell->size(); ++i) surface.vertices.push_back(shell->point(i).position);
    return surface;
  }();
  static const TriangleSoup triangles =
      environment_surface(task_scene("T1").loaded.scenario, NamedFiles(task_scene("T1").loaded.scenario));
  return library.same_question ? points : triangles;
}

std::unique_ptr<Peer> made(const Library& library, const std::string& task) {
  const Cylinder drill = make_cylinder(task_scene(task).loaded.scenario.tool);
  const auto& [vertices, triangles] = surface_for(library);
  return library.make({.data = nullptr,
                       .stiffness = 0.0,
                       .capacity = kRoom,
                       .vertices = vertices.front().data(),
                       .vertex_count = vertices.size(),
                       .triangles = triangles.empty() ? nullptr : triangles.front().data(),
                       .triangle_count = triangles.size(),
                       .tool_radius = drill.radius(),
                       .tool_length = drill.length()});
}

/// The results of hapbench's search and depths at the poses of the queries.
struct Ours {
  std::vector<HapbenchPose> poses;
  std::vector<std::vector<std::uint32_t>> points;
  std::vector<double> depths;
};

const Ours& ours(const std::string& task) {
  static std::map<std::string, Ours> known;
  const auto found = known.find(task);
  if (found != known.end()) return found->second;
  const TaskScene& scene = task_scene(task);
  const Cylinder drill = make_cylinder(scene.loaded.scenario.tool);
  SimulationParts parts = assemble(scene.loaded.scenario, scene.loaded.files, scene.shell, {});
  ContactBuffer contacts(parts.source->capacity());
  Ours answers;
  for (std::size_t k = 0; k < scene.poses.size(); k += kEvery) {
    parts.source->contacts_at(scene.poses[k], contacts);
    answers.poses.push_back(module_pose(scene.poses[k], drill.length()));
    answers.points.emplace_back(contacts.index.begin(), contacts.index.begin() + static_cast<long>(contacts.size()));
    std::sort(answers.points.back().begin(), answers.points.back().end());
    answers.depths.push_back(contacts.largest_depth());
  }
  return known.emplace(task, std::move(answers)).first->second;
}

/// Before timing, compares the results of a library with the results of hapbench. They must be equal if the library
/// finds the points of the shell. Otherwise reports how often both find a contact, and the depths of both.
void time_library(benchmark::State& state, const Library& library, const std::string& task) {
  const Ours& known = ours(task);
  const std::unique_ptr<Peer> peer = made(library, task);
  std::vector<PeerContact> room(kRoom);
  double contacts = 0.0, agreed = 0.0, depth = 0.0, our_depth = 0.0;
  for (std::size_t k = 0; k < known.poses.size(); ++k) {
    const std::span answer(room.data(), peer->contacts_at(known.poses[k], room));
    const auto is_same = [](const PeerContact& contact, std::uint32_t point) { return contact.index == point; };
    if (library.same_question &&
        !std::equal(answer.begin(), answer.end(), known.points[k].begin(), known.points[k].end(), is_same))
      return state.SkipWithError(fmt::format("not the points of our search at pose {}", k).c_str());
    contacts += static_cast<double>(answer.size());
    agreed += answer.empty() == known.points[k].empty() ? 1.0 : 0.0;
    double deepest = 0.0;
    for (const PeerContact& contact : answer) deepest = std::max(deepest, contact.depth);
    depth += deepest;
    our_depth += known.depths[k];
  }
  for (auto _ : state) {
    for (const HapbenchPose& pose : known.poses) benchmark::DoNotOptimize(peer->contacts_at(pose, room));
  }
  const auto n = static_cast<double>(known.poses.size());
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(known.poses.size()));
  state.counters["poses"] = n;
  state.counters["contacts"] = contacts / n;
  state.counters["agree"] = agreed / n;
  state.counters["depth_m"] = depth / n;
  state.counters["our_depth_m"] = our_depth / n;
  state.counters["same_question"] = library.same_question ? 1.0 : 0.0;
}

/// Times a search, with or without depths, at consecutive poses of a run.
template <class Source>
void time_ours(benchmark::State& state, Source& source, const std::vector<ToolPose>& poses) {
  ContactBuffer contacts(source.capacity());
  double found = 0.0;
  for (auto _ : state) {
    for (const ToolPose& pose : poses) {
      source.contacts_at(pose, contacts);
      found += static_cast<double>(contacts.size());
    }
  }
  const auto n = static_cast<double>(poses.size());
  state.counters["poses"] = n;
  state.counters["contacts"] = found / n / static_cast<double>(state.iterations());
}

void time_search(benchmark::State& state, const std::string& task) {
  const TaskScene& scene = task_scene(task);
  const auto query = make_contact_query(*scene.shell, *scene.tool, Skips::on);
  time_ours(state, *query, scene.poses);
}

void time_search_and_depths(benchmark::State& state, const std::string& task) {
  const TaskScene& scene = task_scene(task);
  const SimulationParts parts = assemble(scene.loaded.scenario, scene.loaded.files, scene.shell, {});
  time_ours(state, *parts.source, scene.poses);
}

void add_benchmarks() {
  for (const std::string task : kTasks) {
    benchmark::RegisterBenchmark(("peers/hapbench/" + task).c_str(), time_search, task);
    benchmark::RegisterBenchmark(("peers/hapbench_with_depths/" + task).c_str(), time_search_and_depths, task);
    for (const Library& library : libraries()) {
      benchmark::RegisterBenchmark(fmt::format("peers/{}/{}", library.name, task).c_str(),
                                   [library, task](benchmark::State& state) { time_library(state, library, task); });
    }
  }
}

}  // namespace
}  // namespace hapbench::bench

int main(int argc, char** argv) {
  return hapbench::bench::run_benchmarks("hapbench_bench_peers", argc, argv, hapbench::bench::add_benchmarks);
}
