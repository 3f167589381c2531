#include <fmt/format.h>
#include <algorithm>
#include <functional>
#include <stdexcept>
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
  GridQuery query(*scene.shell, *scene.tool);
  const auto depth_model = make_depth_model("surface_normal");
  ContactBuffer here(query.capacity());
  for (std::size_t k = 0; k < scene.poses.size(); k += every) {
    query.contacts_at(scene.poses[k], here);
    depth_model->evaluate(*scene.tool, scene.poses[k], here);
    if (!take(here)) return;
  }
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

ContactBuffer repeated_contacts(std::size_t n) {
  const ContactBuffer base = task_contacts(std::min(n, kRepeated));
  ContactBuffer sample(n);
  for (std::size_t i = 0; i < n; ++i) sample.push_copy_of(base, i % base.size());
  sample.pad();
  return sample;
}

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

namespace {

using test::Dense;

// Spring forces in units of K, as the formulas of the laws are written.

Vec3 original_averaging(const Dense& c) {
  const Vec3 sum = c.U.rowwise().sum();
  return -c.d.sum() / sum.norm() * sum.normalized();
}

Vec3 virtual_coupling(const Dense& c) {
  const Mat3 series = Mat3::Identity() + c.S(Eigen::VectorXd::Ones(c.n()));
  return series.inverse() * c.spring(1.0, Eigen::VectorXd::Ones(c.n()));
}

Vec3 least_squares(const Dense& c) {
  const Mat3 normal = RenderingConfig().regularisation * Mat3::Identity() + c.S(Eigen::VectorXd::Ones(c.n()));
  return normal.inverse() * c.spring(1.0, Eigen::VectorXd::Ones(c.n()));
}

Vec3 highest_depth(const Dense& c) {
  return -c.d.maxCoeff() * c.U.rowwise().sum().normalized();
}

/// The weights of a law with weighted penalty springs.
using Weights = std::function<Eigen::VectorXd(const Dense&)>;
Vec3 weighted(const Dense& c, const Weights& weights) {
  return c.spring(1.0, weights(c));
}

/// The formula of the algorithm's force in units of K; empty if there is none here.
std::function<Vec3(const Dense&)> reference(std::string_view algorithm) {
  const auto ones = [](const Dense& c) -> Eigen::VectorXd { return Eigen::VectorXd::Ones(c.n()); };
  const auto shaped = [](const Dense& c) { return test::shaped_weights(c.A(), 3); };
  if (algorithm == "original_averaging") return original_averaging;
  if (algorithm == "virtual_coupling") return virtual_coupling;
  if (algorithm == "least_squares") return least_squares;
  if (algorithm == "highest_depth") return highest_depth;
  if (algorithm == "summation") return [=](const Dense& c) { return weighted(c, ones); };
  if (algorithm == "mean") return [=](const Dense& c) -> Vec3 { return weighted(c, ones) / double(c.n()); };
  if (algorithm == "mcneely")
    return [=](const Dense& c) -> Vec3 { return weighted(c, ones) * std::min(1.0, 10.0 / double(c.n())); };
  if (algorithm == "tandpasta") return [](const Dense& c) { return weighted(c, test::tandpasta_weights); };
  if (algorithm == "shaped_stiffness" || algorithm.ends_with("normal_projection")) {
    return [=](const Dense& c) { return weighted(c, shaped); };
  }
  return {};
}

/// The force of k copies of every contact divided by that of one, for laws whose formulas are matrices of all pairs,
/// which are too large for many contacts. Shaping divides each weight by a sum over all contacts, so k copies share the
/// weight of one. The weights of tandpasta are ratios of such sums, so each copy has the weight of one. 0 for other
/// laws.
double force_of_copies(std::string_view algorithm, double k) {
  if (algorithm == "tandpasta") return k;
  return algorithm == "shaped_stiffness" || algorithm.ends_with("normal_projection") ? 1.0 : 0.0;
}

/// Says what is wrong with the algorithm's force; empty if nothing.
std::string wrong(std::string_view algorithm, const ContactBuffer& contacts, const RenderedForce& force, double K) {
  if (algorithm == "exact_shaping") {
    // The rounding of its partial sums of n / 8 terms grows with n (shaping_optimality.hpp).
    const double rounding =
        test::kShapingRounding * std::max(1.0, static_cast<double>(contacts.size()) / static_cast<double>(kRepeated));
    const double violation = test::shaping_optimality(contacts, kExactShapingEpsilon).violation;
    return violation > rounding ? fmt::format("optimality violated by {}", violation) : "";
  }
  const auto formula = reference(algorithm);
  if (!formula) return force.spring.allFinite() ? "" : "force not finite";
  const double copies = std::max(1.0, static_cast<double>(contacts.size()) / static_cast<double>(kRepeated));
  const double factor = copies > 1.0 ? force_of_copies(algorithm, copies) : 0.0;
  const Dense dense(factor != 0.0 ? repeated_contacts(kRepeated) : contacts);
  const double scale = factor != 0.0 ? factor * K : K;
  const Vec3 expected = scale * formula(dense);
  // Rounding of sums of n terms, each at most a depth, in another order.
  const double rounding = 1e-12 * scale * dense.magnitude(Eigen::VectorXd::Ones(dense.n()));
  return (force.spring - expected).norm() <= rounding ? "" : "not the formula's force";
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
  if (const std::string what = wrong(algorithm, contacts, force, config.stiffness); !what.empty()) {
    return refute(state, what);
  }
  for (auto _ : state) {
    rendering->compute(tool, contacts, force);
    benchmark::DoNotOptimize(force);
  }
  state.counters["contacts"] = static_cast<double>(n);
}

}  // namespace

void register_laws() {
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

namespace {

constexpr int kIterations = 3;

// The form of the thesis: the n x n matrix of squared inner products, computed in each step, and three updates.
void matrix(benchmark::State& state, std::size_t n) {
  ContactBuffer contacts = task_contacts(n);
  shape_weights(contacts, kIterations);
  const Eigen::VectorXd dense = test::shaped_weights(test::Dense(contacts).A(), kIterations);
  // Both divide n sums of at most n terms three times: a few n roundings of 1e-16 each.
  if (!dense.isApprox(test::weights(contacts), 1e-12)) return refute(state, "matrix and tensor differ");
  for (auto _ : state) {
    benchmark::DoNotOptimize(test::shaped_weights(test::Dense(contacts).A(), kIterations));
  }
  state.counters["contacts"] = static_cast<double>(n);
}

void tensor(benchmark::State& state, std::size_t n) {
  ContactBuffer contacts = task_contacts(n);
  shape_weights(contacts, kIterations);
  const Eigen::VectorXd dense = test::shaped_weights(test::Dense(contacts).A(), kIterations);
  if (!dense.isApprox(test::weights(contacts), 1e-12)) return refute(state, "matrix and tensor differ");
  for (auto _ : state) benchmark::DoNotOptimize(shape_weights(contacts, kIterations));
  state.counters["contacts"] = static_cast<double>(n);
}

void exact(benchmark::State& state, std::size_t n) {
  ContactBuffer contacts = task_contacts(n);
  const int steps = solve_exact_shaping(contacts);
  const double violation = test::shaping_optimality(contacts, kExactShapingEpsilon).violation;
  if (violation > test::kShapingRounding) return refute(state, fmt::format("optimality violated by {}", violation));
  for (auto _ : state) benchmark::DoNotOptimize(solve_exact_shaping(contacts));
  state.counters["contacts"] = static_cast<double>(n);
  state.counters["newton_steps"] = steps;
}

}  // namespace

void register_shaping() {
  const std::pair<const char*, void (*)(benchmark::State&, std::size_t)> forms[] = {
      {"matrix", matrix}, {"tensor", tensor}, {"exact", exact}};
  for (const auto& [name, run] : forms) {
    for (const std::size_t n : {10u, 50u, 250u, 1000u}) {
      benchmark::RegisterBenchmark(fmt::format("shaping/{}/{}", name, n).c_str(), run, n);
    }
  }
}

namespace {

/// Buffers that are reduced in sequence and restored together outside of the measured time.
constexpr std::size_t kBuffers = 16;

/// Shell indices and depths of the kept contacts, by the definition of thesis C.3.
std::vector<std::pair<std::uint32_t, double>> kept_by_definition(const ContactBuffer& contacts, double threshold) {
  std::vector<std::size_t> kept;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    bool absorbed = false;
    for (std::size_t& k : kept) {
      absorbed = contacts.gradient(i).dot(contacts.gradient(k)) > threshold;
      if (absorbed && contacts.depth[i] > contacts.depth[k]) k = i;
      if (absorbed) break;
    }
    if (!absorbed) kept.push_back(i);
  }
  std::vector<std::pair<std::uint32_t, double>> points;
  for (const std::size_t k : kept) points.emplace_back(contacts.index[k], contacts.depth[k]);
  return points;
}

/// Reduces each of the buffers.
void reduce(benchmark::State& state, const std::vector<ContactBuffer>& samples) {
  const ReductionConfig config;
  const auto stage = make_gradient_reduction(config);
  double contacts = 0.0, kept = 0.0;
  for (const ContactBuffer& sample : samples) {
    ContactBuffer reduced = sample;
    stage->process(reduced);
    const auto expected = kept_by_definition(sample, config.threshold);
    bool same = reduced.size() == expected.size();
    for (std::size_t k = 0; same && k < expected.size(); ++k) {
      same = reduced.index[k] == expected[k].first && reduced.depth[k] == expected[k].second;
    }
    if (!same) return refute(state, "keeps other contacts than the definition");
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
  for (const ContactBuffer& sample : samples) {
    const auto end = sample.depth.begin() + static_cast<std::ptrdiff_t>(sample.size());
    const double expected = sample.empty() ? 0.0 : *std::max_element(sample.depth.begin(), end);
    if (sample.largest_depth() != expected) return refute(state, "not the largest depth");
  }
  while (state.KeepRunningBatch(static_cast<benchmark::IterationCount>(samples.size()))) {
    for (const ContactBuffer& sample : samples) benchmark::DoNotOptimize(sample.largest_depth());
  }
}

}  // namespace

void register_reduction() {
  for (const std::size_t n : {50u, 250u, 1000u}) {
    benchmark::RegisterBenchmark(fmt::format("reduction/{}", n).c_str(), reduction, n);
  }
  benchmark::RegisterBenchmark("reduction/T3", reduction_in_task);
  benchmark::RegisterBenchmark("largest_depth/T3", largest_depth_in_task);
  for (const std::size_t n : kGrowthContacts) {
    benchmark::RegisterBenchmark(fmt::format("growth/reduction/{}", n).c_str(), reduction, n);
  }
}

namespace {

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
  SimulationParts parts = assemble(scenario, block_shell(), {});
  Problems problems(*block_shell(), *parts.tool, scenario.rendering.stiffness);
  Simulation(simulation_config(scenario), std::move(parts), {&problems}).run();
  return std::move(problems.problems);
}

/// True if the move satisfies every contact and is held by those on which it rests, which makes it the nearest one.
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
