#include <algorithm>
#include <vector>

#include "algorithms/proxy/nearest_allowed.hpp"
#include "algorithms/proxy/proxy_constraints.hpp"
#include "tests/bench/bench.hpp"
#include "tests/bench/task_scene.hpp"

namespace hapbench::bench {
namespace {

constexpr std::uint64_t kRowsApart = 64;  ///< rows of T2_proxy

/// What the proxy's solver is asked in a step.
struct Problem {
  ContactBuffer contacts;
  Vec3 wanted;
};

/// Of T2 with a proxy, whose place is p + f_spring / K.
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
  SimulationParts parts = assemble(scenario, block_shell(), {});
  Problems problems(*block_shell(), *parts.tool, scenario.rendering.stiffness);
  Simulation(simulation_config(scenario), std::move(parts), {&problems}).run();
  return std::move(problems.problems);
}

/// Whether the move satisfies every contact and is held by those it rests on: then it is the nearest one.
bool is_nearest(Problem& problem) {
  const AllowedMove allowed = nearest_allowed(problem.wanted, problem.contacts);
  Vec3 held = Vec3::Zero();
  for (std::size_t i = 0; i < problem.contacts.size(); ++i) {
    const double off = problem.contacts.depth[i] + problem.contacts.gradient(i).dot(allowed.move);
    const double lambda = problem.contacts.weight[i];
    if (allowed.feasible && (off > 1e-10 || lambda < 0.0 || (lambda > 0.0 && off < -1e-10))) return false;
    const Vec3 u = problem.contacts.gradient(i);
    if (lambda > 0.0) held += (lambda + allowed.share.dot(u)) * u;
  }
  return (problem.wanted - held - allowed.move).norm() <= 1e-9;
}

void solve(benchmark::State& state) {
  static std::vector<Problem> problems = problems_of_task();
  if (problems.empty()) return refute(state, "no problem to solve");
  double contacts = 0.0;
  for (Problem& problem : problems) {
    if (!is_nearest(problem)) return refute(state, "not the nearest allowed move");
    contacts += static_cast<double>(problem.contacts.size()) / static_cast<double>(problems.size());
  }
  while (state.KeepRunningBatch(static_cast<benchmark::IterationCount>(problems.size()))) {
    for (Problem& problem : problems) {
      benchmark::DoNotOptimize(nearest_allowed(problem.wanted, problem.contacts));
    }
  }
  state.counters["contacts"] = contacts;
}

}  // namespace

void register_proxy() {
  benchmark::RegisterBenchmark("proxy/solve/T2", solve);
}

}  // namespace hapbench::bench
