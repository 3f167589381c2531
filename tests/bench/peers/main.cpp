#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <map>

#include "results/summary/provenance.hpp"
#include "sim/contact/neighbour_list_query.hpp"
#include "sim/mesh/block_field.hpp"
#include "tests/bench/peers/peer.hpp"
#include "tests/bench/task_scene.hpp"

/// Our search and other libraries at the same poses of the same scenes: peers/<library>/<task> takes as long for a pose
/// as its counters say it found contacts there. Libraries that are not here when it is built are left out.
namespace hapbench::bench {
namespace {

/// They take milliseconds a pose.
constexpr std::size_t kEvery = 64;

struct Library {
  const char* name;
  MakePeer* make;
  bool same_question;  ///< which points of the shell are in the drill
};
const Library kLibraries[] = {
#ifdef HAPBENCH_PEER_KD_TREE
    {"cgal_kd_tree", make_kd_tree, true},
#endif
#ifdef HAPBENCH_PEER_FCL
    {"fcl", make_fcl, false},
#endif
#ifdef HAPBENCH_PEER_BULLET
    {"bullet", make_bullet, false},
#endif
#ifdef HAPBENCH_PEER_ODE
    {"ode", make_ode, false},
#endif
};

const PeerSurface& surface() {
  static const PeerSurface made = [] {
    PeerSurface surface;
    const auto add = [](std::vector<double>& to, const Vec3& p) { to.insert(to.end(), {p.x(), p.y(), p.z()}); };
    const auto shell = block_shell();
    for (std::size_t i = 0; i < shell->size(); ++i) add(surface.points, shell->point(i).position);
    const auto& block = std::get<BlockEnvironment>(task_scene("T1").loaded.scenario.environment);
    const IsoSurface mesh =
        marching_cubes(density_field(block.block, block.grid, block.density), {.triangles = true});
    for (const SurfacePoint& vertex : mesh.vertices) add(surface.vertices, vertex.position);
    for (const auto& triangle : mesh.triangles)
      surface.triangles.insert(surface.triangles.end(), triangle.begin(), triangle.end());
    return surface;
  }();
  return made;
}

PeerPose pose_of(const ToolPose& pose, double length) {
  const Vec3 centre = pose.position - 0.5 * length * pose.axis;
  const Mat3 r = pose.rotation();
  PeerPose out;
  for (int i = 0; i < 3; ++i) {
    out.centre[static_cast<std::size_t>(i)] = centre[i];
    for (int k = 0; k < 3; ++k) out.rotation[static_cast<std::size_t>(3 * i + k)] = r(i, k);
  }
  return out;
}

/// What our search and depths say at the poses that the libraries are asked at.
struct Ours {
  std::vector<PeerPose> poses;
  std::vector<std::vector<std::uint32_t>> points;
  std::vector<double> depths;
};

const Ours& ours(const std::string& task) {
  static std::map<std::string, Ours> known;
  const auto found = known.find(task);
  if (found != known.end()) return found->second;
  const TaskScene& scene = task_scene(task);
  const Cylinder drill = make_cylinder(scene.loaded.scenario.tool);
  SimulationParts parts = assemble(scene.loaded.scenario, scene.shell, {});
  ContactBuffer contacts(parts.source->capacity());
  Ours answers;
  for (std::size_t k = 0; k < scene.poses.size(); k += kEvery) {
    parts.source->contacts_at(scene.poses[k], contacts);
    answers.poses.push_back(pose_of(scene.poses[k], drill.length()));
    answers.points.emplace_back(contacts.index.begin(), contacts.index.begin() + static_cast<long>(contacts.size()));
    std::sort(answers.points.back().begin(), answers.points.back().end());
    answers.depths.push_back(contacts.largest_depth());
  }
  return known.emplace(task, std::move(answers)).first->second;
}

std::unique_ptr<Peer> make_peer(const Library& library, const TaskScene& scene) {
  const Cylinder drill = make_cylinder(scene.loaded.scenario.tool);
  return library.make(surface(), {drill.radius(), drill.length()});
}

/// Compares the answers before it times them: to the point with a library that is asked our question, else how often
/// both see a contact, and how deep they say it is.
void time_library(benchmark::State& state, const Library& library, const std::string& task) {
  const Ours& known = ours(task);
  const auto peer = make_peer(library, task_scene(task));
  double contacts = 0.0, agreed = 0.0, depth = 0.0, our_depth = 0.0;
  for (std::size_t k = 0; k < known.poses.size(); ++k) {
    const PeerAnswer answer = peer->ask(known.poses[k]);
    if (library.same_question && peer->points() != known.points[k])
      return state.SkipWithError(fmt::format("not the points of our search at pose {}", k).c_str());
    contacts += static_cast<double>(answer.contacts);
    agreed += (answer.contacts > 0) == !known.points[k].empty() ? 1.0 : 0.0;
    depth += answer.depth;
    our_depth += known.depths[k];
  }
  for (auto _ : state) {
    for (const PeerPose& pose : known.poses) benchmark::DoNotOptimize(peer->ask(pose).contacts);
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

/// The search alone, and with the depths, at the consecutive poses that a run asks it at.
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
  NeighbourListQuery query(*scene.shell, *scene.tool);
  time_ours(state, query, scene.poses);
}

void time_search_and_depths(benchmark::State& state, const std::string& task) {
  const TaskScene& scene = task_scene(task);
  const SimulationParts parts = assemble(scene.loaded.scenario, scene.shell, {});
  time_ours(state, *parts.source, scene.poses);
}

int run(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  const Provenance program = provenance();
  benchmark::AddCustomContext("commit", program.commit);
  benchmark::AddCustomContext("cpu", program.cpu);
  benchmark::AddCustomContext("compiler", program.compiler);
  for (const std::string task : kTasks) {
    benchmark::RegisterBenchmark(("peers/hapbench/" + task).c_str(), time_search, task);
    benchmark::RegisterBenchmark(("peers/hapbench_with_depths/" + task).c_str(), time_search_and_depths, task);
    for (const Library& library : kLibraries) {
      benchmark::RegisterBenchmark(fmt::format("peers/{}/{}", library.name, task).c_str(),
                                   [&library, task](benchmark::State& state) { time_library(state, library, task); });
    }
  }
  return benchmark::RunSpecifiedBenchmarks() == 0 ? 2 : 0;
}

}  // namespace
}  // namespace hapbench::bench

int main(int argc, char** argv) {
  try {
    return hapbench::bench::run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "hapbench_bench_peers: %s\n", error.what());
    return 1;
  }
}
