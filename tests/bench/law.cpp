#include <fmt/format.h>
#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include "algorithms/depth/depth_model.hpp"
#include "algorithms/laws/shaped_stiffness.hpp"
#include "algorithms/proxy/proxy_constraints.hpp"
#include "algorithms/registry.hpp"
#include "algorithms/stages/point_stage.hpp"
#include "sim/contact/neighbour_list_query.hpp"
#include "tests/bench/bench.hpp"
#include "tests/bench/task_scene.hpp"
#include "tests/support/dense_laws.hpp"

/// The force laws, the reduction and the proxy's solver on contacts of the tasks.
namespace hapbench::bench {
namespace {

/// Calls take(contacts) at every so many poses of a task, until it returns false.
template <class Take>
void for_contacts(const std::string& task, std::size_t every, Take take) {
  const TaskScene& scene = task_scene(task);
  NeighbourListQuery query(*scene.shell, *scene.tool);
  const auto depth_model = make_depth_model("surface_normal");
  ContactBuffer here(query.capacity());
  for (std::size_t k = 0; k < scene.poses.size(); k += every) {
    query.contacts_at(scene.poses[k], here);
    depth_model->evaluate(*scene.tool, scene.poses[k], here);
    if (!take(here)) return;
  }
}

/// n contacts for any n; beyond kRepeated, they repeat.
constexpr std::size_t kRepeated = 1000;
ContactBuffer repeated_contacts(std::size_t n) {
  const ContactBuffer base = task_contacts(std::min(n, kRepeated));
  ContactBuffer sample(n);
  for (std::size_t i = 0; i < n; ++i) sample.push_copy_of(base, i % base.size());
  sample.pad();
  return sample;
}

/// The contacts of every 64th pose of a task before the reduction. Padded.
std::vector<ContactBuffer> contacts_along(const std::string& task) {
  constexpr std::size_t kEvery = 64;
  std::vector<ContactBuffer> samples;
  for_contacts(task, kEvery, [&samples](const ContactBuffer& here) {
    samples.emplace_back(std::max<std::size_t>(1, here.size()));
    samples.back().assign(here);
    return true;
  });
  return samples;
}

void law(benchmark::State& state, const std::string& algorithm, std::size_t n) {
  RenderingConfig config;
  config.algorithm = algorithm;
  const auto rendering = make_algorithm(config);
  // The contacts have their depths already, so the law alone is timed.
  ContactBuffer contacts = repeated_contacts(n);
  rendering->prepare({.capacity = n});
  rendering->reset();
  const ToolState tool;
  RenderedForce force;
  rendering->compute(tool, contacts, force);
  if (!force.spring.allFinite() || force.spring == Vec3::Zero()) return refute(state, "no force");
  for (auto _ : state) {
    rendering->compute(tool, contacts, force);
    benchmark::DoNotOptimize(force);
  }
  state.counters["contacts"] = static_cast<double>(n);
}

void add_laws() {
  for (const AlgorithmEntry& algorithm : algorithms()) {
    // An algorithm that finds its own contacts is timed as a step, such as T2_proxy.
    if (!algorithm.make_law) continue;
    const std::string name(algorithm.info->name);
    for (const std::size_t n : {50u, 250u, 1000u}) {
      benchmark::RegisterBenchmark(fmt::format("law/{}/{}", name, n).c_str(), law, name, n);
    }
    for (const std::size_t n : kGrowthContacts) {
      // Takes seconds per call for all pairs of contacts.
      if (name == "tandpasta" && n > 10'000) continue;
      benchmark::RegisterBenchmark(fmt::format("growth/law/{}/{}", name, n).c_str(), law, name, n);
    }
  }
}

constexpr int kIterations = 3;

/// Times one form of shaping: `matrix` is that of the thesis, the n x n matrix of squared inner products, computed in
/// each step, and three updates; `tensor` the library's; `exact` the solver of the limit.
void shaping(benchmark::State& state, const std::string& form, std::size_t n) {
  ContactBuffer contacts = task_contacts(n);
  const auto by_matrix = [&] { return test::shaped_weights(test::Dense(contacts).A(), kIterations); };
  state.counters["contacts"] = static_cast<double>(n);
  if (form == "exact") {
    state.counters["newton_steps"] = solve_exact_shaping(contacts);
    for (auto _ : state) benchmark::DoNotOptimize(solve_exact_shaping(contacts));
    return;
  }
  shape_weights(contacts, kIterations);
  // Both divide n sums of at most n terms three times: a few n roundings of 1e-16 each.
  if (!by_matrix().isApprox(test::weights(contacts), 1e-12)) return refute(state, "matrix and tensor differ");
  if (form == "matrix") {
    for (auto _ : state) benchmark::DoNotOptimize(by_matrix());
  } else {
    for (auto _ : state) benchmark::DoNotOptimize(shape_weights(contacts, kIterations));
  }
}

void add_shaping() {
  for (const char* form : {"matrix", "tensor", "exact"}) {
    for (const std::size_t n : {10u, 50u, 250u, 1000u}) {
      benchmark::RegisterBenchmark(fmt::format("shaping/{}/{}", form, n).c_str(), shaping, std::string(form), n);
    }
  }
}

/// Buffers that are reduced in sequence and restored together outside of the measured time.
constexpr std::size_t kBuffers = 16;

/// Reduces each of the buffers.
void reduce(benchmark::State& state, const std::vector<ContactBuffer>& samples) {
  const auto stage = make_gradient_reduction({});
  double contacts = 0.0, kept = 0.0;
  for (const ContactBuffer& sample : samples) {
    ContactBuffer reduced = sample;
    stage->process(reduced);
    contacts += static_cast<double>(sample.size()) / static_cast<double>(samples.size());
    kept += static_cast<double>(reduced.size()) / static_cast<double>(samples.size());
  }
  std::vector<ContactBuffer> buffers = samples;
  while (state.KeepRunningBatch(static_cast<benchmark::IterationCount>(samples.size()))) {
    state.PauseTiming();
    buffers = samples;
    state.ResumeTiming();
    for (ContactBuffer& buffer : buffers) stage->process(buffer);
  }
  state.counters["contacts"] = contacts;
  state.counters["kept"] = kept;
}

void reduction(benchmark::State& state, std::size_t n) {
  reduce(state, std::vector<ContactBuffer>(n <= 1000 ? kBuffers : 1, repeated_contacts(n)));
}

void reduction_in_task(benchmark::State& state) {
  reduce(state, contacts_along("T3"));
}

void largest_depth_in_task(benchmark::State& state) {
  const std::vector<ContactBuffer> samples = contacts_along("T3");
  while (state.KeepRunningBatch(static_cast<benchmark::IterationCount>(samples.size()))) {
    for (const ContactBuffer& sample : samples) benchmark::DoNotOptimize(sample.largest_depth());
  }
}

void add_reduction() {
  for (const std::size_t n : {50u, 250u, 1000u}) {
    benchmark::RegisterBenchmark(fmt::format("reduction/{}", n).c_str(), reduction, n);
  }
  benchmark::RegisterBenchmark("reduction/T3", reduction_in_task);
  benchmark::RegisterBenchmark("largest_depth/T3", largest_depth_in_task);
  for (const std::size_t n : kGrowthContacts) {
    benchmark::RegisterBenchmark(fmt::format("growth/reduction/{}", n).c_str(), reduction, n);
  }
}

constexpr std::uint64_t kRowsApart = 64;  ///< rows of T2_proxy

/// The problem that the solver of the proxy gets in a step.
struct Problem {
  ContactBuffer contacts;
  Vec3 wanted;
};

/// Collects the problems of T2 with a proxy, whose place is p + f_spring / K.
class Problems final : public Observer {
 public:
  Problems(const PointShell& shell, const ToolShape& tool, double K)
      : constraints_(shell, tool, Skips::on), found_(constraints_.capacity()), K_(K) {}

  void on_step(const StepRecord& record) noexcept override {
    if (record.step % kRowsApart != 0 || record.rendered->empty()) return;
    const Vec3 to_proxy = record.force.spring / K_;
    const ToolPose proxy{record.tool.pose.position + to_proxy, record.tool.pose.axis};
    constraints_.constraints_at(proxy, -to_proxy, found_);
    ContactBuffer contacts(std::max<std::size_t>(1, found_.size()));
    for (std::size_t i = 0; i < found_.size(); ++i) contacts.push_copy_of(found_, i);
    contacts.pad();
    problems.push_back({std::move(contacts), -to_proxy});
  }

  std::vector<Problem> problems;

 private:
  ShellConstraints constraints_;
  ContactBuffer found_;
  double K_;
};

std::vector<Problem> problems_of_task() {
  const Scenario& scenario = step_scenario("T2_proxy").scenario;
  SimulationParts parts = assemble(scenario, NamedFiles(scenario), block_shell(), {});
  Problems problems(*block_shell(), *parts.tool, scenario.rendering.stiffness);
  Simulation(simulation_config(scenario), std::move(parts), {&problems}).run();
  return std::move(problems.problems);
}

void solve(benchmark::State& state) {
  static std::vector<Problem> problems = problems_of_task();
  if (problems.empty()) return refute(state, "no problem to solve");
  double contacts = 0.0;
  for (const Problem& problem : problems)
    contacts += static_cast<double>(problem.contacts.size()) / static_cast<double>(problems.size());
  while (state.KeepRunningBatch(static_cast<benchmark::IterationCount>(problems.size()))) {
    for (Problem& problem : problems) {
      benchmark::DoNotOptimize(nearest_allowed(problem.wanted, problem.contacts));
    }
  }
  state.counters["contacts"] = contacts;
}

}  // namespace

ContactBuffer task_contacts(std::size_t n) {
  constexpr std::size_t kEvery = 205;  // 0.1 s
  ContactBuffer sample(n);
  for_contacts("T2", kEvery, [&](const ContactBuffer& here) {
    for (std::size_t i = 0; i < here.size() && sample.size() < n; ++i) sample.push_copy_of(here, i);
    return sample.size() < n;
  });
  if (sample.size() < n) throw std::logic_error("T2 has too few contacts for this benchmark");
  sample.pad();
  return sample;
}

void register_laws() {
  add_laws();
  add_shaping();
  add_reduction();
  benchmark::RegisterBenchmark("proxy/solve/T2", solve);
}

}  // namespace hapbench::bench
