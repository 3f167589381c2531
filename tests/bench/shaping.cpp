#include <fmt/format.h>

#include "algorithms/laws/exact_shaping.hpp"
#include "algorithms/laws/shaped_stiffness.hpp"
#include "tests/bench/bench.hpp"
#include "tests/bench/contact_samples.hpp"
#include "tests/support/dense_laws.hpp"

namespace hapbench::bench {
namespace {

constexpr int kIterations = 3;

// The thesis's form: the n x n matrix of squared inner products, built for each step, then three updates.
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

}  // namespace hapbench::bench
