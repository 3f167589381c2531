// Compares the latency of a call of the renderer with the time of an offline step: renderer_latency [CALLS]. Prints the
// median, the 99.9th percentile and the largest latency in microseconds, the time of reading the clock, and the number
// of allocations, which should be 0.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "device_model/live/hapbench_renderer.hpp"
#include "results/summary/allocations.hpp"
#include "scenarios/input/bundled_scenarios.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/scene/load_scenario.hpp"

namespace {

using Clock = std::chrono::steady_clock;

struct Scene {
  const char* what;
  const char* scenario;
  std::vector<std::string> overrides;
  double lift = 0.0;  ///< height of the poses above the poses of the run [m]
};

const std::vector<Scene> kScenes = {
    {"tooth", "drag_molar", {}},
    {"hole", "press_into_hole", {"rendering.reduction=null", "environment.grid_m=4.3e-5"}},
    {"slot", "matching_slot", {}},
    {"free air", "drag_molar", {}, 0.01},
};

double microseconds(Clock::duration duration) {
  return std::chrono::duration<double, std::micro>(duration).count();
}

/// Prints the median, the 99.9th percentile and the maximum of the times [us]. Sorts the times.
void print_latency(const char* what, std::vector<double>& times) {
  std::sort(times.begin(), times.end());
  const auto at = [&](double share) {
    return times[static_cast<std::size_t>(share * static_cast<double>(times.size() - 1))];
  };
  std::printf("  %-14s median %8.3f   99.9 %% %8.3f   largest %9.3f us\n", what, at(0.5), at(0.999), times.back());
}

void measure(const Scene& scene, std::size_t calls) {
  using namespace hapbench;
  // Run the scenario offline, and keep the poses of the tool and the times of the steps.
  class Poses final : public Observer {
   public:
    void on_step(const StepRecord& record) noexcept override {
      tools.push_back(record.tool);
      contacts = std::max(contacts, record.colliding);
    }
    std::vector<ToolState> tools;
    std::size_t contacts = 0;
  } poses;
  const Scenario scenario = load_scenario(find_scenario(scene.scenario), scene.overrides).scenario;
  Simulation simulation(simulation_config(scenario), assemble(scenario), {&poses});
  poses.tools.reserve(simulation_config(scenario).steps);
  std::vector<double> offline;
  for (bool more = true; more;) {
    const auto start = Clock::now();
    more = simulation.step();
    offline.push_back(microseconds(Clock::now() - start));
  }
  // Render the same poses with the renderer.
  HapbenchMount mount = HAPBENCH_MOUNT_INIT;
  mount.max_force = INFINITY;
  Renderer renderer(scene.scenario, mount, scene.overrides);
  const double period = renderer.period();
  std::vector<double> live;
  live.reserve(calls);
  HapbenchInput input{};
  input.has = HAPBENCH_VELOCITY;
  const std::size_t n = poses.tools.size();
  std::size_t contacts = 0;
  const AllocationCount allocations;
  for (std::size_t i = 0; i < calls; ++i) {
    const std::size_t k = i / n % 2 == 0 ? i % n : n - 1 - i % n;
    const ToolState& tool = poses.tools[k];
    // Rotation from the tool's axis at rest, -z, to its axis in this step.
    const Eigen::Quaterniond q = Eigen::Quaterniond::FromTwoVectors(-Vec3::UnitZ(), tool.pose.axis);
    input.time_ns += static_cast<std::uint64_t>(1e9 * period);
    input.handle = {{tool.pose.position.x(), tool.pose.position.y(), tool.pose.position.z() + scene.lift},
                    {q.w(), q.x(), q.y(), q.z()}};
    for (int axis = 0; axis < 3; ++axis) input.velocity[axis] = tool.velocity[axis];
    const auto start = Clock::now();
    const HapbenchOutput output = renderer.step(input);
    live.push_back(microseconds(Clock::now() - start));
    contacts = std::max<std::size_t>(contacts, output.contacts);
    if (output.status == HAPBENCH_FAULT) {
      std::printf("FAULT: %s\n", renderer.fault().c_str());
      std::exit(1);
    }
  }
  std::printf("%s (%s): at most %zu contacts, %llu allocations\n", scene.what, scene.scenario, contacts,
              static_cast<unsigned long long>(allocations.value()));
  print_latency("call", live);
  if (scene.lift == 0.0) print_latency("offline step", offline);
}

}  // namespace

int main(int argc, char** argv) {
  const std::size_t calls = argc > 1 ? static_cast<std::size_t>(std::atol(argv[1])) : 1'000'000;
  for (const Scene& scene : kScenes) measure(scene, calls);
  return 0;
}
