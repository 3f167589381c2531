#include "tests/bench/accuracy/accuracy.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "scenarios/run/assemble.hpp"
#include "scenarios/run/stop_signal.hpp"

namespace hapbench::accuracy {
namespace {

class Sampler final : public Observer {
 public:
  Sampler(std::uint64_t stride, std::vector<Vec3>& positions) : stride_(stride), positions_(positions) {}
  void on_step(const StepRecord& record) noexcept override {
    if (record.step % stride_ == 0) positions_.push_back(record.tool.pose.position);
  }

 private:
  std::uint64_t stride_;
  std::vector<Vec3>& positions_;
};

}  // namespace

double Errors::operator[](const std::string& name) const {
  for (const auto& [known, value] : values)
    if (known == name) return value.value_or(std::nan(""));
  throw std::invalid_argument(name);
}

SampledRun sampled_run(const Scenario& scenario, std::shared_ptr<const PointShell> shell, std::uint64_t stride,
                       std::vector<Observer*> observers) {
  const SimulationConfig config = simulation_config(scenario);
  SampledRun run;
  run.positions.reserve(config.steps / stride + 1);
  Sampler sampler(stride, run.positions);
  observers.push_back(&sampler);
  Simulation simulation(config, assemble(scenario, NamedFiles(scenario), std::move(shell), {}), std::move(observers));
  run.result = run_to_end(simulation);
  return run;
}

Work bare_run(const Scenario& scenario, std::shared_ptr<const PointShell> shell) {
  const auto simulation = std::make_shared<Simulation>(simulation_config(scenario),
                                                       assemble(scenario, NamedFiles(scenario), std::move(shell), {}),
                                                       std::vector<Observer*>{});
  const SimulationResult warm_up = run_to_end(*simulation);
  return {[simulation] { simulation->reset(); }, [simulation] { run_to_end(*simulation); },
          std::max<std::size_t>(1, warm_up.rows)};
}

Distance distance(std::span<const Vec3> a, std::span<const Vec3> b) {
  Distance d;
  const std::size_t samples = std::min(a.size(), b.size());
  if (samples == 0) return d;
  for (std::size_t i = 0; i < samples; ++i) {
    d.final = (a[i] - b[i]).norm();
    d.rms += d.final * d.final / static_cast<double>(samples);
    d.max = std::max(d.max, d.final);
  }
  d.rms = std::sqrt(d.rms);
  return d;
}

Scenario with_step(const Scenario& scenario, double factor) {
  Scenario run = scenario;
  run.time.step = scenario.time.step * factor;
  run.time.steps = std::llround(static_cast<double>(scenario.time.steps) / factor);
  return run;
}

}  // namespace hapbench::accuracy
