#include <fmt/format.h>

#include <vector>

#include "algorithms/stages/gradient_reduction.hpp"
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

void reduction(benchmark::State& state, std::size_t n) {
  const ReductionConfig config;
  const ContactBuffer contacts = task_contacts(n);
  const auto stage = make_gradient_reduction(config);
  ContactBuffer reduced = contacts;
  stage->process(reduced);
  const auto expected = kept_by_definition(contacts, config.threshold);
  bool same = reduced.size() == expected.size();
  for (std::size_t k = 0; same && k < expected.size(); ++k) {
    same = reduced.index[k] == expected[k].first && reduced.depth[k] == expected[k].second;
  }
  if (!same) return refute(state, "keeps other contacts than the definition");

  std::vector<ContactBuffer> buffers(kBuffers, contacts);
  while (state.KeepRunningBatch(kBuffers)) {
    state.PauseTiming();
    for (ContactBuffer& buffer : buffers) buffer = contacts;
    state.ResumeTiming();
    for (ContactBuffer& buffer : buffers) stage->process(buffer);
  }
  state.counters["contacts"] = static_cast<double>(n);
  state.counters["kept"] = static_cast<double>(reduced.size());
}

}  // namespace

void register_reduction() {
  for (const std::size_t n : {50u, 250u, 1000u}) {
    benchmark::RegisterBenchmark(fmt::format("reduction/{}", n).c_str(), reduction, n);
  }
}

}  // namespace hapbench::bench
