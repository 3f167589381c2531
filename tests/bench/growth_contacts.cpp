#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "results/observe/metrics.hpp"
#include "results/observe/passivity_observer.hpp"
#include "tests/bench/bench.hpp"
#include "tests/bench/contact_samples.hpp"
#include "tests/bench/task_scene.hpp"

/// What a step costs as the number of contacts grows and nothing else does.
namespace hapbench::bench {
namespace {

constexpr std::uint64_t kStepsAtATime = 64;

/// The wall of a hole, 0.05 mm inside the upright drill that fills it: n points, every one a contact, evenly spread as
/// seeds are in a sunflower.
std::shared_ptr<const PointShell> wall(std::size_t n, const Cylinder& tool) {
  const double radius = tool.radius() - 5e-5, turn = std::numbers::pi * (3.0 - std::sqrt(5.0));
  std::vector<SurfacePoint> points(n);
  for (std::size_t i = 0; i < n; ++i) {
    const double angle = turn * static_cast<double>(i);
    const Vec3 out{std::cos(angle), std::sin(angle), 0.0};
    const double height = 0.004 * (static_cast<double>(i) + 0.5) / static_cast<double>(n);
    points[i] = {radius * out + Vec3{0.0, 0.0, height}, -out};
  }
  return std::make_shared<const PointShell>(points, 0.0);
}

/// The drill at rest in that hole, pushed by nobody and held by its contacts.
class FilledHole {
 public:
  FilledHole(std::size_t n, Skips skips) {
    static const LoadedScenario loaded =
        load_unrecorded("round_the_wall", {"rendering.reduction=null", "hand={\"type\":\"none\"}",
                                           "device={\"type\":\"ideal\"}", "initial.position_m=[0,0,-0.0005]"});
    Scenario scenario = loaded.scenario;
    scenario.rendering.skips = skips;
    SimulationConfig config = simulation_config(scenario);
    config.steps = 1'000'000'000;  // more than are ever timed
    metrics_ = std::make_unique<MetricsObserver>(config.dt);
    passivity_ = std::make_unique<PassivityObserver>(config.dt);
    simulation_ = std::make_unique<Simulation>(config, assemble(scenario, wall(n, make_cylinder(scenario.tool)), {}),
                                               std::vector<Observer*>{metrics_.get(), passivity_.get()});
    take(kStepsAtATime);
  }
  void take(std::uint64_t steps) { simulation_->advance(steps); }
  Metrics metrics() const { return metrics_->metrics(); }

 private:
  std::unique_ptr<MetricsObserver> metrics_;
  std::unique_ptr<PassivityObserver> passivity_;
  std::unique_ptr<Simulation> simulation_;
};

void step(benchmark::State& state, std::size_t n) {
  const auto wrong = [n]() -> std::string {
    const Metrics metrics = FilledHole(n, Skips::on).metrics();
    if (metrics.colliding_mean != static_cast<double>(n)) return "not every point is a contact";
    return metrics.state_hash == FilledHole(n, Skips::off).metrics().state_hash ? "" : "not the run without skips";
  };
  if (!proved(state, fmt::format("growth/step/{}", n), wrong)) return;
  FilledHole run(n, Skips::on);
  while (state.KeepRunningBatch(kStepsAtATime)) run.take(kStepsAtATime);
  state.counters["contacts"] = run.metrics().colliding_mean;
}

}  // namespace

void register_growth_over_contacts() {
  for (const std::size_t n : kGrowthContacts) {
    benchmark::RegisterBenchmark(fmt::format("growth/step/{}", n).c_str(), step, n);
  }
}

}  // namespace hapbench::bench
