#include "tests/bench/bench.hpp"

#include <functional>
#include <map>

#include "scenarios/input/bundled_scenarios.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/scene/environments.hpp"

namespace hapbench::bench {
namespace {

/// Index of the first pose and number of poses, in steps of the run of a task. T1 begins at the start of its run. T2
/// and T3 use one later period, which lasts 6 s.
struct Window {
  std::uint64_t first, count;
};
Window window_of(const std::string& task) {
  return task == "T1" ? Window{0, 10'240} : Window{12'288, 12'288};
}

LoadedScenario load_step_scenario(const std::string& name) {
  if (name.ends_with("_mesh")) return step_scenario(name.substr(0, 2));
  if (name == "T1") return load_unrecorded("poke_on_flat", {});
  if (name == "T2") return load_unrecorded("rotate_in_hole", {});
  if (name == "T2_proxy") return load_unrecorded("rotate_in_hole", {"rendering.algorithm=proxy"});
  if (name == "T3") return load_unrecorded("round_the_wall", {});
  if (name == "unreduced_1000") {
    return load_unrecorded("round_the_wall", {"tool.diameter_m=0.00184", "initial.position_m=[0.00002,0,-0.0049]",
                                              "rendering.reduction=null"});
  }
  if (name == "upright" || name == "upright_proxy") {
    // Take the first 10 s of the first trial, with a shell that lists each vertex once. In this scene the proxy needs
    // the largest number of passes per step.
    std::vector<std::string> overrides = {"environment.vertices=shared", "time.duration_s=10"};
    if (name == "upright_proxy") overrides.emplace_back("rendering.algorithm=proxy");
    return load_unrecorded("vertical_peg_in_hole_shaped_stiffness", std::move(overrides));
  }
  if (name == "pressed_ideal" || name == "pressed_impedance") {
    // The hand is so soft that the drill rests on the same points with both devices.
    const char* device =
        name == "pressed_ideal"
            ? R"(device={"type":"ideal"})"
            : R"(device={"type":"impedance","handle_mass_kg":0.1,"viscous_N_s_per_m":2,"coulomb_N":0.05,
                                  "encoder_step_m":1e-6,"delay_samples":0.5})";
    return load_unrecorded("round_the_wall", {device,
                                              R"(hand={"type":"impedance","stiffness_N_per_m":300,"damping_N_s_per_m":6,
                                                 "target":{"x_m":0,"y_m":0,"z_m":-0.006}})",
                                              "initial.position_m=[0,0,-0.0049]", "rendering.stiffness_N_per_m=2000",
                                              "rendering.damping_ratio=0.1", "time.duration_s=10"});
  }
  return load_unrecorded("round_the_wall",
                         {"hand={\"type\":\"none\"}", "device={\"type\":\"ideal\"}", "initial.position_m=[0,0,0.05]"});
}

class PoseRecorder final : public Observer {
 public:
  PoseRecorder(Window window, std::vector<ToolPose>& poses) : window_(window), poses_(poses) {}
  void on_step(const StepRecord& record) noexcept override {
    if (record.step >= window_.first) poses_.push_back(record.tool.pose);
  }

 private:
  Window window_;
  std::vector<ToolPose>& poses_;
};

TaskScene make_task_scene(const std::string& task) {
  TaskScene scene;
  scene.loaded = step_scenario(task);
  scene.shell = block_shell();
  const Window window = window_of(task);
  scene.poses.reserve(window.count);
  PoseRecorder recorder(window, scene.poses);
  SimulationConfig config = simulation_config(scene.loaded.scenario);
  config.steps = window.first + window.count;
  SimulationParts parts = assemble(scene.loaded.scenario, scene.loaded.files, scene.shell, {});
  scene.tool = parts.tool;
  Simulation(config, std::move(parts), {&recorder}).run();
  return scene;
}

}  // namespace

LoadedScenario load_unrecorded(const char* bundled, std::vector<std::string> overrides) {
  // Write only the summary, because records take time.
  for (const char* off : {"record.trajectory=false", "record.ratio_iterations=[]", "record.ideal_trajectory=false"}) {
    overrides.emplace_back(off);
  }
  return load_scenario(find_scenario(bundled), overrides);
}

const LoadedScenario& step_scenario(const std::string& name) {
  static std::map<std::string, LoadedScenario> loaded;
  const auto found = loaded.find(name);
  return found != loaded.end() ? found->second : loaded.emplace(name, load_step_scenario(name)).first->second;
}

const TaskScene& task_scene(std::string_view task) {
  static std::map<std::string, TaskScene, std::less<>> scenes;
  const auto found = scenes.find(task);
  if (found != scenes.end()) return found->second;
  const std::string name(task);
  return scenes.emplace(name, make_task_scene(name)).first->second;
}

std::shared_ptr<const PointShell> block_shell() {
  static const auto shell = make_shell(step_scenario("T1").scenario);
  return shell;
}

}  // namespace hapbench::bench
