#include "tests/scenarios/support/scenarios.hpp"

#include "scenarios/input/bundled_scenarios.hpp"
#include "scenarios/scene/load_scenario.hpp"

namespace hapbench::test {

std::vector<NamedScenario> minimal_scenarios() {
  const char* environments[] = {
      R"({"type": "springs"})",
      R"({"type": "hole_2d"})",
      R"({"type": "plane"})",
      R"({"type": "slot", "gap_m": 0.001, "depth_m": 0.005, "length_m": 0.01, "spacing_m": 0.0005})",
      R"({"type": "block_with_hole"})",
      R"({"type": "point_shell", "file": "shell.csv"})",
      R"({"type": "mesh", "file": "cube.obj", "scale": 0.001})",
  };
  std::vector<NamedScenario> scenarios;
  for (const char* environment : environments) {
    Json json = {{"time", {{"step_s", 0.0005}, {"steps", 20}}}, {"environment", Json::parse(environment)}};
    std::string name = json["environment"]["type"].get<std::string>();
    scenarios.push_back({std::move(name), std::move(json)});
  }
  return scenarios;
}

Json minimal_scenario(const std::string& environment_type) {
  for (NamedScenario& scenario : minimal_scenarios()) {
    if (scenario.name == environment_type) return std::move(scenario.json);
  }
  throw std::invalid_argument(environment_type);
}

std::vector<NamedScenario> rich_scenarios() {
  return {{"prescribed_slot", Json::parse(R"({
      "$schema": "anything", "name": "prescribed_slot", "description": "\u00e4", "source": "s",
      "seed": 9007199254740992,
      "time": {"step_s": 1, "duration_s": 3.4, "stop_when": ["tool_horizontal"]},
      "environment": {"type": "slot", "gap_m": 0.001, "depth_m": 0.005, "length_m": 0.01, "spacing_m": 0.0005},
      "tool": {"diameter_m": 0.0012, "length_m": 0.02, "tip": "round"},
      "motion": {
        "orientation": {"up": [0, 0, 2], "lean": [0, 3, 0], "tilt_rad": 0.1,
          "azimuth_rad": {"type": "sine", "mean": 0, "amplitude": 1, "period_s": 2, "phase_rad": 0.5},
          "roll_rad": {"type": "ramp", "start": 0.1, "rate_per_s": -2}},
        "position": {"type": "prescribed", "x_m": {"type": "ramp", "start": 0, "rate_per_s": 1e-4}, "y_m": 0,
          "shift_m": [1e-4, 0, 0],
          "z_m": {"type": "waypoints", "points": [[0, 0.001], [1.5, -0.001], [2, 0]], "interpolation": "cosine"}}},
      "rendering": {"algorithm": "virtual_coupling", "depth_model": "shortest_distance", "contact_source": "own",
        "local_average": true,
        "reduction": {"threshold": 0.9, "max_points": 7, "shuffle_seed": 5}, "virtual_coupling_N_per_m": 1000,
        "regularisation": 0.5,
        "passivity_controller": true, "damping_N_s_per_m": 3, "angular_damping": true,
        "parameters": {"mcneely": {"points": 5}, "static_coupling": {"saturation_N": 12},
          "proxy": {"damping_time_s": 0.02}},
        "angular_velocity_cutoff_Hz": 30,
        "limits": {"max_damping_N_s_per_m": 0, "max_force_N": 2.5}},
      "record": {"trajectory": true, "every": 2, "ratio_iterations": [0, 3], "contacts": true,
        "stiffness_tensor": true, "timing": true, "pose": true, "torque": true, "inside": true},
      "metrics": {"from_s": 0.5, "settling_s": 0},
      "expect": {"outcome": ["completes", "diverges"], "metrics": {"force_max_N": {"min": 0, "max": 1e6},
        "ratio_max": {}}}})")},
          {"drilled_block", Json::parse(R"({
      "time": {"step_s": 0.0005, "steps": 10},
      "environment": {"type": "block_with_hole", "size_m": [0.006, 0.006, 0.004], "hole_diameter_m": 0.002,
        "hole_depth_m": 0.002, "grid_m": 0.0002, "density": "binary", "vertices": "per_cell"},
      "initial": {"position_m": [0.0006, 0, -0.001]},
      "rendering": {"local_average": true, "damping": {"type": "hunt_crossley", "chi_s_per_m": 3},
        "force_stage": {"type": "energy_tank", "capacity_J": 0.2, "initial_J": 0.1},
        "friction": {"type": "dry", "mu": 0.2, "stiffness_N_per_m": 500, "damping_ratio": 0.5}}})")},
          {"recorded_shell", Json::parse(R"({
      "time": {"step_s": 0.0005, "steps": 1e2, "stop_when": []},
      "environment": {"type": "point_shell", "file": "shell.csv", "grid_m": 0.0005},
      "motion": {"position": {"type": "file", "file": "stroke.csv"}},
      "device": {"type": "ideal", "force_limit_N": null},
      "rendering": {"algorithm": "exact_shaping", "local_average": true, "reduction": null},
      "record": {"contacts": true}})")},
          {"traced_plane", Json::parse(R"({
      "time": {"step_s": 0.0005, "steps": 20},
      "environment": {"type": "plane", "size_m": 0.004, "spacing_m": 0.0002},
      "motion": {"position": {"type": "prescribed", "x_m": 0, "y_m": 0,
        "z_m": {"type": "ramp", "start": 0, "rate_per_s": -0.01}}},
      "rendering": {"contact_source": {"type": "trace", "file": "trace.csv"},
        "contacts": {"every": 2, "delay_samples": 1, "between": "linear", "dropout": 0.1},
        "force_stage": {"type": "actuator_limited_passivity", "max_force_N": [1, 2, 3], "max_damping_N_s_per_m": 4}},
      "record": {"contacts": true}})")},
          {"pushed_springs", Json::parse(R"({
      "time": {"step_s": 0.0005, "steps": 50},
      "environment": {"type": "springs", "bilateral": false, "signed": true,
        "groups": [{"direction": [0, -2, 0], "count": 0},
        {"direction": [1, 1, 1], "count": 3}], "random": {"count": 20, "planar": false}},
      "initial": {"position_m": [0.001, 0, 0], "velocity_m_per_s": [0, 0.1, 0]},
      "hand": {"type": "force", "x_N": 1, "y_N": {"type": "sine", "mean": 0, "amplitude": 3, "period_s": 0.01},
        "z_N": {"type": "waypoints", "points": [[0, 0]]}},
      "device": {"type": "ideal", "force_limit_N": 2},
      "rendering": {"algorithm": "shaped_stiffness", "iterations": 0, "stiffness_N_per_m": 0, "damping_ratio": 0,
        "mass_kg": 1, "friction": {"mu_s_N_s_per_m": 1, "mu_f_s_per_m": 1},
        "limits": {"max_damping_N_s_per_m": null, "max_force_N": null}},
      "integrator": {"type": "event", "tolerance_s": 1e-8},
      "bounds": {"position_m": 10, "speed_m_per_s": 20, "force_N": 30},
      "expect": {"outcome": "completes"}})")},
          {"tracked_block", Json::parse(R"({
      "time": {"step_s": 0.001, "duration_s": 2},
      "environment": {"type": "block_with_hole", "size_m": [0.006, 0.006, 0.004], "hole_depth_m": 0.002,
        "grid_m": 0.0002},
      "initial": {"position_m": [0, 0, -0.0018]},
      "hand": {"type": "tracking", "trials": 2,
        "task": {"display": "height", "places_m": [[0, 0, -0.001], [0, 0, -0.0015]], "targets_per_place": 1,
          "tolerance_m": 0.0003, "min_press_N": 0.5, "gauge": {"cutoff_Hz": 20, "grace_s": 0.05},
          "threshold": {"low": "pauses"}, "hold_s": 0.1, "time_limit_s": 0.4},
        "subjects": [{"reaction_delay_s": 0.1, "bandwidth_Hz": 1, "stiffness_N_per_m": 200, "damping_N_s_per_m": 5,
          "press_N": 1.2, "press_bandwidth_Hz": 0.5, "motor_noise_N": 0.01, "tilt_noise_rad": 0.001,
          "noise_bandwidth_Hz": 5, "height_per_tilt_m_per_rad": 0.003, "max_speed_m_per_s": 0.03,
          "max_turn_rad_per_s": 2, "max_force_N": 5}, {}]},
      "device": {"type": "admittance", "force_limit_N": null,
        "sensor": {"weight_offset_N": 0.5, "weight_compensated": false, "noise_N": 0.01},
        "servo": {"stiffness_N_per_m": 30000, "damping_N_s_per_m": 100, "max_force_N": 20, "delay_samples": 2},
        "mechanics": {"carriage_mass_kg": 0.3, "handle_mass_kg": 0.08, "friction_N_s_per_m": 1,
          "structure_stiffness_N_per_m": 1e5, "structure_damping_N_s_per_m": 20}},
      "record": {"trajectory": true, "energy": true, "ideal_trajectory": true}})")},
          {"turned_plane", Json::parse(R"({
      "time": {"step_s": 0.01, "steps": 20},
      "environment": {"type": "plane", "size_m": 0.004, "spacing_m": 0.0002},
      "motion": {"orientation": {"up": [0, 0, 1], "lean": [1, 0, 0], "azimuth_rad": 0,
          "tilt_rad": {"type": "ramp", "start": 0, "rate_per_s": 0.5}},
        "position": {"type": "prescribed", "x_m": 0, "y_m": 0, "z_m": -0.0001}},
      "rendering": {"algorithm": "proxy", "parameters": {"proxy": {"rotational_stiffness_N_m_per_rad": 0.13}}},
      "six_dof": {"hand_stiffness_N_per_m": 500, "hand_rotational_stiffness_N_m_per_rad": 0.2,
        "coupling_rotational_stiffness_N_m_per_rad": 0.4, "force_point_m": 0.03, "grip_m": 0.01, "pivot_m": 0.02,
        "law": "shaped_stiffness"},
      "record": {"six_dof": true}})")},
          {"pushed_plane", Json::parse(R"({
      "time": {"step_s": 0.0005, "steps": 100},
      "environment": {"type": "plane", "size_m": 0.004, "spacing_m": 0.0002},
      "hand": {"type": "push", "force_N": {"type": "ramp", "start": 0, "rate_per_s": 10}, "angle_rad": 0.3,
        "azimuth_rad": -1.5}})")},
          {"held_plane", Json::parse(R"({
      "time": {"step_s": 0.0005, "steps": 100},
      "environment": {"type": "plane", "size_m": 0.004, "spacing_m": 0.0002},
      "hand": {"type": "impedance", "stiffness_N_per_m": 100, "damping_N_s_per_m": 1,
        "target": {"x_m": {"type": "ramp", "start": 0, "rate_per_s": 0.01}, "y_m": 0, "z_m": -0.01},
        "tremor": {"rms_m": [1e-5, 0, 2e-5], "low_Hz": 7, "high_Hz": 11}},
      "device": {"type": "admittance"}})")},
          {"impedance_plane", Json::parse(R"({
      "time": {"step_s": 0.001, "steps": 100},
      "environment": {"type": "plane", "size_m": 0.004, "spacing_m": 0.0002},
      "hand": {"type": "mass_spring_damper", "mass_kg": 0.3, "stiffness_N_per_m": 100, "damping_N_s_per_m": 1,
        "target": {"x_m": {"type": "ramp", "start": 0, "rate_per_s": 0.01}, "y_m": 0, "z_m": -0.01}},
      "device": {"type": "impedance", "handle_mass_kg": 0.1, "viscous_N_s_per_m": 0.2, "coulomb_N": 0.1,
        "encoder_step_m": 1e-5, "delay_s": 0.0015, "delay_samples": 1.5,
        "velocity_filter": {"type": "low_pass", "cutoff_Hz": 80, "order": 3},
        "force_max_N": 10, "force_step_N": 0.01, "force_slew_N_per_s": 2000,
        "position_filter": {"cutoff_Hz": 200, "order": 2}, "position_noise_m": 1e-6,
        "transmission": {"motor_share": 0.6, "stiffness_N_per_m": 2e5, "damping_N_s_per_m": 0.5}},
      "record": {"energy": true}})")},
          {"preset_plane", Json::parse(R"({
      "time": {"step_s": 0.001, "steps": 100},
      "environment": {"type": "plane", "size_m": 0.004, "spacing_m": 0.0002},
      "hand": {"type": "push", "force_N": 1},
      "device": {"type": "impedance", "preset": "touch", "coulomb_N": 0.1,
        "velocity_filter": {"type": "adaptive_window", "noise_m": 3e-5}}})")},
          {"dragged_plane", Json::parse(R"({
      "time": {"step_s": 0.0005, "steps": 100},
      "environment": {"type": "plane", "size_m": 0.004, "spacing_m": 0.0002},
      "initial": {"position_m": [0, 0, 0.0001]},
      "hand": {"type": "drag", "force_N": {"type": "ramp", "start": 0, "rate_per_s": 10}, "direction": [1, 0, 0],
        "speed_m_per_s": 0.02, "tilt_rad": 0.3, "azimuth_rad": -1.5, "stiffness_N_per_m": 200, "damping_N_s_per_m": 5,
        "normal_damping_N_s_per_m": 40, "smoothing_m": 0.0004}})")},
          {"dragged_slot", Json::parse(R"({
      "time": {"step_s": 0.0005, "duration_s": 0.05},
      "environment": {"type": "slot", "gap_m": 0.002, "depth_m": 0.005, "length_m": 0.01, "spacing_m": 0.0005},
      "initial": {"position_m": [0.0004, 0, -0.001]},
      "motion": {"orientation": {"tilt_rad": 0.1}},
      "hand": {"type": "drag", "path_m": [[0.001, 0, -0.001], [0.001, 0.001, -0.002]], "tilt_rad": null}})")},
          {"bur_on_plane", Json::parse(R"({
      "time": {"step_s": 0.0005, "steps": 100},
      "environment": {"type": "plane", "size_m": 0.004, "spacing_m": 0.0002},
      "initial": {"position_m": [0, 0, 0.0005]},
      "tool": {"type": "bur", "family": "pear", "diameter_m": 0.0012, "length_m": 0.002, "shank_diameter_m": 0.0006},
      "hand": {"type": "force", "z_N": -1}})")},
          {"turned_tool_on_plane", Json::parse(R"({
      "time": {"step_s": 0.0005, "steps": 100},
      "environment": {"type": "plane", "size_m": 0.004, "spacing_m": 0.0002},
      "tool": {"type": "revolved", "profile_m": [[-0.01, 0.0004], [-0.002, 0.0004], [0, 0.0008]], "tip": "flat"},
      "hand": {"type": "force", "z_N": -1}})")},
          {"cube_on_plane", Json::parse(R"({
      "time": {"step_s": 0.0005, "steps": 100},
      "environment": {"type": "plane", "size_m": 0.02, "spacing_m": 0.001},
      "initial": {"position_m": [0, 0, 0.005]},
      "tool": {"type": "mesh", "file": "cube.obj", "scale": 0.001, "tip_m": [0.0001, 0, 0], "tip_axis": [0, 1, -2],
        "grid_m": 0.0005},
      "hand": {"type": "force", "z_N": -1}})")},
          {"scanned_cube", Json::parse(R"({
      "time": {"step_s": 0.0005, "steps": 10},
      "environment": {"type": "mesh", "file": "cube.obj", "scale": 0.001, "flip_normals": false,
        "spacing_m": 0.0003, "grid_m": 0.0005},
      "initial": {"position_m": [0, 0, 0.0049]},
      "rendering": {"local_average": true}})")}};
}

std::vector<NamedScenario> bundled_scenario_files() {
  std::vector<NamedScenario> scenarios;
  for (const BundledScenario& bundled : bundled_scenarios()) {
    scenarios.push_back({bundled.name, read_scenario_text(bundled.file).json});
  }
  return scenarios;
}

std::filesystem::path data_directory() {
  return HAPBENCH_TEST_DATA;
}

}  // namespace hapbench::test
