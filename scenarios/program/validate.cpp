#include "scenarios/program/validate.hpp"

#include <fmt/format.h>

#include <cmath>

#include "results/io/atomic_file.hpp"
#include "scenarios/analysis/stability/compared_devices.hpp"
#include "scenarios/analysis/stability/field_limit.hpp"
#include "scenarios/input/bundled_scenarios.hpp"
#include "scenarios/input/fields.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/input/mesh_file.hpp"
#include "scenarios/input/point_shell_file.hpp"
#include "scenarios/input/shell_words.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/program/exit_status.hpp"
#include "scenarios/program/output.hpp"
#include "scenarios/program/override_locations.hpp"
#include "scenarios/program/results_folder.hpp"
#include "scenarios/run/checked_scenario.hpp"
#include "scenarios/run/progress_bar.hpp"
#include "scenarios/run/quantity_text.hpp"
#include "scenarios/run/recorders.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/run/scene_checks.hpp"
#include "scenarios/run/stop_signal.hpp"
#include "scenarios/scene/environments.hpp"
#include "scenarios/scene/field_files.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "scenarios/scene/named_files.hpp"
#include "scenarios/scene/scenario.hpp"
#include "scenarios/scene/tools.hpp"
#include "sim/mesh/half_edge_mesh.hpp"
#include "sim/tool/mesh_tool.hpp"

namespace hapbench {
namespace {

struct ValidateOptions : CommonOptions {
  std::vector<std::string> files;
  std::string points;
};

std::string surface_text(const SceneFacts::Surface& surface, std::optional<bool> is_closed) {
  const std::string closed = is_closed ? (*is_closed ? ", closed" : ", open") : "";
  const auto& [gap, touching, is_estimate] = surface.start;
  const std::string start =
      touching > 0 ? fmt::format("starts in contact: {} points inside the tool, largest depth {}", touching,
                                 length_text(std::abs(gap)))
                   : fmt::format("starts {}{} from the surface", is_estimate ? "about " : "", length_text(gap));
  return fmt::format("  environment  {} ({}), {} points{}\n  start        {}\n", size_text(surface.box),
                     bounds_text(surface.box), surface.points, closed, start);
}

/// Returns whether a mesh component is closed, and the orientation of its normals, as text.
std::string closedness_text(const MeshComponent& component, const MeshFindings& found) {
  if (!component.is_closed) {
    return found.open_edges.empty() ? "cut along edges with more than two faces, normals by the winding of the file"
                                    : "open, normals by the winding of the file";
  }
  const std::string reversed = component.is_reversed ? " (reversed: they pointed to the wrong side)" : "";
  if (component.is_flat) return "closed, without volume (a double-sided sheet)";
  return (component.is_cavity ? "closed, a cavity, normals inwards" : "closed, normals outwards") + reversed;
}

/// Returns a line for each component of a mesh.
std::string components_text(const MeshFindings& found) {
  std::string text;
  for (std::size_t i = 0; i < found.components.size(); ++i) {
    const MeshComponent& component = found.components[i];
    const std::string head = i == 0 ? fmt::format("{} component{}", found.component_count,
                                                  found.component_count > 1 ? "s, the largest first: " : ": ")
                                    : "";
    text += fmt::format("  {:<11}  {}{}, {} triangle{}, {}\n", i == 0 ? "mesh" : "", head, size_text(component.box),
                        component.triangles, component.triangles == 1 ? "" : "s", closedness_text(component, found));
  }
  if (found.component_count > found.components.size())
    text += fmt::format("               and {} smaller components\n", found.component_count - found.components.size());
  return text;
}

const MeshTool* mesh_of(const SceneFacts& facts) {
  return dynamic_cast<const MeshTool*>(facts.tool.get());
}

std::size_t triangles_of_tool(const LoadedScenario& loaded) {
  return loaded.files.at(kToolFile).mesh().triangles().triangles.size();
}

std::string tool_text(const LoadedScenario& loaded, const SceneFacts& facts) {
  std::string text = fmt::format("  tool         {}: half width {}, reaches up to {} from the centre of its tip",
                                 tool_names()[loaded.scenario.tool.index()], length_text(facts.tool->half_width()),
                                 length_text(facts.tool->reach()));
  if (!facts.tool->convex()) text += ", not convex";
  if (const MeshTool* mesh = mesh_of(facts)) {
    text += fmt::format(
        "\n               relative to its tip centre {}\n               {} triangles, closed; grid {}, depth error at "
        "most {}",
        bounds_text(mesh->grid().box()), triangles_of_tool(loaded), length_text(mesh->grid().nodes().spacing),
        length_text(mesh->grid().error_bound()));
    const MeshFindings& found = loaded.files.at(kToolFile).mesh().findings();
    if (found.component_count > 1) return text + "\n" + components_text(found);
  }
  return text + "\n";
}

/// Returns an amount of data as text, such as "271 MB".
std::string bytes_text(double bytes) {
  if (bytes < 1e6) return fmt::format("{:.0f} kB", std::ceil(1e-3 * bytes));
  return bytes < 1e9 ? fmt::format("{:.3g} MB", 1e-6 * bytes) : fmt::format("{:.3g} GB", 1e-9 * bytes);
}

std::string facts_text(const LoadedScenario& loaded, const SceneFacts& facts) {
  const Scenario& scenario = loaded.scenario;
  std::string text = facts.surface ? surface_text(*facts.surface, facts.is_closed) : "  environment  springs\n";
  if (facts.surface && std::holds_alternative<MeshEnvironment>(scenario.environment))
    text += components_text(loaded.files.at(kEnvironmentFile).mesh().findings());
  text += tool_text(loaded, facts);
  const double duration = scenario.time.step * static_cast<double>(scenario.time.steps);
  text += fmt::format("  run          {} steps of {:.4g} ms = {:.4g} s", scenario.time.steps, 1e3 * scenario.time.step,
                      duration);
  if (const double trials = trial_count(scenario.hand); trials > 1.0) text += fmt::format(", {:.0f} trials", trials);
  const std::string contacts =
      scenario.record.contacts ? fmt::format(" if each step has {:.0f} contacts", kAssumedContacts) : "";
  return text + fmt::format("\n  writes       about {}{}\n", bytes_text(expected_output_bytes(scenario)), contacts);
}

Json box_json(const Box& box) {
  return {{box.min.x(), box.min.y(), box.min.z()}, {box.max.x(), box.max.y(), box.max.z()}};
}

Json components_json(const MeshFindings& found) {
  Json list = Json::array();
  for (const MeshComponent& component : found.components) {
    list.push_back({{"triangles", component.triangles},
                    {"box_m", box_json(component.box)},
                    {"closed", component.is_closed},
                    {"cavity", component.is_cavity},
                    {"flat", component.is_flat},
                    {"turned", component.is_reversed}});
  }
  return {{"count", found.component_count}, {"largest", list}};
}

Json facts_json(const LoadedScenario& loaded, const SceneFacts& facts) {
  const Scenario& scenario = loaded.scenario;
  Json json = {{"steps", scenario.time.steps},
               {"duration_s", scenario.time.step * static_cast<double>(scenario.time.steps)},
               {"trials", static_cast<std::size_t>(trial_count(scenario.hand))},
               {"expected_output_bytes", expected_output_bytes(scenario)}};
  json["tool"] = {{"type", tool_names()[scenario.tool.index()]},
                  {"half_width_m", facts.tool->half_width()},
                  {"reach_m", facts.tool->reach()},
                  {"convex", facts.tool->convex()}};
  if (const MeshTool* mesh = mesh_of(facts)) {
    json["tool"]["triangles"] = triangles_of_tool(loaded);
    json["tool"]["closed"] = true;  // open meshes are rejected
    json["tool"]["components"] = components_json(loaded.files.at(kToolFile).mesh().findings());
    json["tool"]["box_m"] = box_json(mesh->grid().box());
    json["tool"]["grid_m"] = mesh->grid().nodes().spacing;
    json["tool"]["error_bound_m"] = mesh->grid().error_bound();
  }
  if (!facts.surface) return json;
  json["environment"] = {{"box_m", box_json(facts.surface->box)}, {"points", facts.surface->points}};
  if (facts.is_closed) {
    json["environment"]["closed"] = *facts.is_closed;
    json["environment"]["components"] = components_json(loaded.files.at(kEnvironmentFile).mesh().findings());
  }
  json["start"] = {{"gap_m", facts.surface->start.distance}, {"touching", facts.surface->start.touching}};
  if (facts.surface->start.is_estimate) json["start"]["gap_is_estimate"] = true;
  return json;
}

/// Returns true for a file that has only the fields of a scenario's device, for `limit --device`.
bool is_device_file(const std::filesystem::path& file) {
  const ScenarioText text = read_scenario_text(file);
  return text.json.is_object() && !text.json.contains("environment") && !text.json.contains("time") &&
         (text.json.contains(kTypeField) || text.json.contains("preset"));
}

/// Returns the warnings about numbers of the device in a file that a scenario with this device would have.
std::vector<std::string> device_warnings(const std::string& file, const ComparedDevice& device) {
  const ScenarioText scene = read_scenario_text(find_scenario("tap_wall"));
  constexpr std::string_view kDevice = "/device";
  std::vector<std::string> texts;
  for (const Warning& warning : load_scenario(scene, overrides_on(device, scene, {})).warnings)
    if (warning.pointer.starts_with(kDevice))
      texts.push_back(fmt::format("{}: {}: {}", file, warning.pointer.substr(kDevice.size()), warning.text));
  return texts;
}

/// Writes the points of the environment. Throws InputError if it has no points or the file cannot be written.
void write_points(const LoadedScenario& loaded, const std::filesystem::path& file, ProgramContext& context) {
  if (std::holds_alternative<SpringsEnvironment>(loaded.scenario.environment))
    throw InputError(loaded.file.string() + ": /environment/type: got \"springs\", which have no point shell");
  std::error_code ignored;
  if (std::filesystem::is_directory(file, ignored))
    fail_in({.about_options = {"--points"}}, fmt::format("--points {}: is a directory", file.string()));
  const FolderLock lock = locked_results(context, file.has_parent_path() ? file.parent_path() : ".",
                                         file.filename().string(), "validate", "--points");
  const auto shell = make_shell(loaded.scenario, loaded.files);
  throw_if_stopped();  // making the shell may have taken seconds
  const std::string text = format_point_shell(shell->points(), file);
  write_file_atomically(file, text);
}

int validate(const ValidateOptions& options, ProgramContext& context) {
  if (!options.points.empty() && options.files.size() > 1)
    fail_in_option("--points", fmt::format("got {} scenes; allowed: one", options.files.size()));
  std::string text;
  Json verdicts = Json::array();
  int status = kSuccess;
  for (const std::string& argument : options.files) {
    Json& verdict = verdicts.emplace_back(Json{{"file", argument}, {"valid", true}});
    try {
      const WaitNotice notice(argument, !options.output.quiet);
      const std::filesystem::path file = find_scenario(argument);
      if (options.points.empty() && is_device_file(file)) {
        if (!options.overrides.empty())
          fail_in_option("--set",
                         "has no effect on the file of a device; allowed: with scenarios, such as \"hapbench "
                         "validate SCENARIO --set device.handle_mass_kg=0.1\"");
        print_warnings(context, device_warnings(argument, device_of_file(file)));
        text += fmt::format("{}: valid, but a device and not a scenario; use it with: {}\n", argument,
                            "hapbench limit tap_wall --device " + shell_file(argument));
        verdict["kind"] = "device";
        continue;
      }
      // Check the scenario, and report the facts about its scene.
      const CheckedScenario scene = checked(load_scenario(file, options.overrides), Libraries::inspected);
      const LoadedScenario& loaded = scene.loaded();
      print_warnings(context, scene);
      const SceneFacts facts = scene_facts(loaded);
      print_warnings(context, with_files(loaded, facts.warnings));
      if (!options.points.empty()) write_points(loaded, options.points, context);
      text += fmt::format("{}: valid\n{}", argument, facts_text(loaded, facts));
      verdict.update(facts_json(loaded, facts));
      if (options.points.empty()) continue;
      text += fmt::format("  points       written to {}\n", options.points);
      verdict["environment"]["points_file"] = options.points;
    } catch (const InputError& error) {
      print_errors(context, with_override_locations(error, options.overrides));
      const std::vector<std::string> messages = names_of(error.faults(), &InputError::what);
      verdict = {{"file", argument}, {"valid", false}, {"error", error.what()}, {"errors", messages}};
      status = kBadInput;
    }
  }
  print(context, options.output, text, verdicts);
  return status;
}

}  // namespace

void add_validate(CommandLine& line) {
  auto [command, options] = line.command(
      "validate", "Check scenario files and the files they name, without running them, and show what they contain.",
      validate);
  command.add("files <scenario>...", options.files, "scenario files, device files or names of bundled scenarios",
              {.required = true});
  command.add(
      "--points <file>", options.points,
      "write the surface points that hapbench makes or reads, with normals, to FILE.csv (exact) or FILE.ply (single "
      "precision, for viewers)");
  add_overrides(command, options.overrides);
  command.footer(
      "Checks: names of fields (with the nearest valid name), types and ranges of their values, and the files they "
      "name. Warnings point out likely unit errors (such as an object 100 times as large as the tool), coarse "
      "points, and a tool that starts behind the surface.\n\n"
      "Result: size of the object, number of points, start distance, duration of the simulated run, and disk space "
      "of its results.\n\n"
      "Exit status: 0 if all files are valid, also with warnings; 2 if a file is invalid. All files are checked in "
      "both cases.");
}

}  // namespace hapbench
