#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "algorithms/stages/point_stage.hpp"
#include "tests/bench/bench.hpp"
#include "tests/bench/contact_samples.hpp"

namespace hapbench::bench {
namespace {

/// Buffers that are reduced one after the other and restored together, outside of the measured time.
constexpr std::size_t kBuffers = 16;

/// Shell indices and depths of what is kept, as thesis C.3 describes it.
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

}  // namespace hapbench::bench
