#include <fmt/format.h>
#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include "algorithms/depth/depth_model.hpp"
#include "algorithms/penalty_rendering.hpp"
#include "algorithms/registry.hpp"
#include "sim/contact/contact_query.hpp"
#include "tests/bench/bench.hpp"

/// Times the force laws and the reduction on contacts of the tasks.
namespace hapbench::bench {

ContactBuffer task_contacts(std::size_t n) {
  constexpr std::size_t kEvery = 205;  // steps in 0.1 s
  const TaskScene& scene = task_scene("T2");
  const auto query = make_contact_query(*scene.shell, *scene.tool, Skips::on);
  const auto depth_model = make_depth_model("surface_normal");
  ContactBuffer here(query->capacity()), sample(n);
  for (std::size_t k = 0; k < scene.poses.size() && sample.size() < n; k += kEvery) {
    query->contacts_at(scene.poses[k], here);
    depth_model->evaluate(*scene.tool, scene.poses[k], here);
    for (std::size_t i = 0; i < here.size() && sample.size() < n; ++i) sample.push_copy_of(here, i);
  }
  if (sample.size() < n) throw std::logic_error("T2 has too few contacts for this benchmark");
  sample.pad();
  return sample;
}

namespace {

/// Largest number of different contacts in the result of repeated_contacts(). For a larger n, the contacts repeat in
/// turn.
constexpr std::size_t kRepeated = 1000;
ContactBuffer repeated_contacts(std::size_t n) {
  const ContactBuffer base = task_contacts(std::min(n, kRepeated));
  ContactBuffer sample(n);
  for (std::size_t i = 0; i < n; ++i) sample.push_copy_of(base, i % base.size());
  sample.pad();
  return sample;
}

void law(benchmark::State& state, const std::string& algorithm, std::size_t n) {
  RenderingConfig config;
  config.algorithm = algorithm;
  const auto rendering = make_algorithm(config);
  // The contacts already have depths, so only the law is timed.
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
    // An algorithm that finds its own contacts is timed only as a step, such as step/T2_proxy.
    if (!algorithm.make_law) continue;
    const std::string name(algorithm.info->name);
    for (const std::size_t n : {50u, 250u, 1000u}) {
      benchmark::RegisterBenchmark(fmt::format("law/{}/{}", name, n).c_str(), law, name, n);
    }
    for (const std::size_t n : kGrowthContacts) {
      // tandpasta takes seconds per call, because it uses all pairs of contacts.
      if (name == "tandpasta" && n > 10'000) continue;
      benchmark::RegisterBenchmark(fmt::format("growth/law/{}/{}", name, n).c_str(), law, name, n);
    }
  }
}

/// Number of buffers that are reduced one after the other. All are restored together, outside of the measured time.
constexpr std::size_t kBuffers = 16;

void reduction(benchmark::State& state, std::size_t n) {
  const auto stage = make_gradient_reduction({});
  const std::vector<ContactBuffer> samples(n <= 1000 ? kBuffers : 1, repeated_contacts(n));
  ContactBuffer reduced = samples[0];
  stage->process(reduced);
  std::vector<ContactBuffer> buffers = samples;
  while (state.KeepRunningBatch(static_cast<benchmark::IterationCount>(samples.size()))) {
    state.PauseTiming();
    buffers = samples;
    state.ResumeTiming();
    for (ContactBuffer& buffer : buffers) stage->process(buffer);
  }
  state.counters["contacts"] = static_cast<double>(n);
  state.counters["kept"] = static_cast<double>(reduced.size());
}

void add_reduction() {
  for (const std::size_t n : {50u, 250u, 1000u}) {
    benchmark::RegisterBenchmark(fmt::format("reduction/{}", n).c_str(), reduction, n);
  }
  for (const std::size_t n : kGrowthContacts) {
    benchmark::RegisterBenchmark(fmt::format("growth/reduction/{}", n).c_str(), reduction, n);
  }
}

}  // namespace

void register_laws() {
  add_laws();
  add_reduction();
}

}  // namespace hapbench::bench
