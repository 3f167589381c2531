#include "scenarios/program/new/new.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <utility>

#include "results/io/atomic_file.hpp"
#include "scenarios/input/shell_words.hpp"
#include "scenarios/input/writer.hpp"
#include "scenarios/program/columns.hpp"
#include "scenarios/program/exit_status.hpp"
#include "scenarios/program/new/meanings.hpp"
#include "scenarios/program/new/start.hpp"
#include "scenarios/program/output.hpp"
#include "scenarios/program/python_commands.hpp"
#include "scenarios/program/results_folder.hpp"
#include "scenarios/run/checked_scenario.hpp"
#include "scenarios/run/expectations.hpp"
#include "scenarios/run/progress_bar.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/run/scene_checks.hpp"
#include "scenarios/scene/field_files.hpp"

namespace hapbench {
namespace {

int list_kinds(const OutputOptions& output, ProgramContext& context) {
  const Layout layout = context.layout();
  const Columns<StartKind> columns = {{"kind", "", "", &StartKind::name, under("KIND")},
                                      {"summary", "", "", &StartKind::summary, under("what it starts with")}};
  print(context, output, columns.text(start_kinds(), layout), columns.json_list(start_kinds()));
  return kSuccess;
}

/// Returns what to change if a run of the scene does not end as intended. Names only options that the kind accepts.
std::string remedy(const NewOptions& options, const StartKind& kind) {
  if (kind.source == "stroke")
    return "the positions of the stroke must be in metres and in the frame of the surface; change the stroke, or the "
           "surface in the file";
  std::string change = kind.scene.contains("hand") ? "change the hand in the file" : "change motion in the file";
  const PlacementOptions accepted = placement_options(options, kind);
  if (const std::string placing = accepted.text(); !placing.empty())
    return fmt::format("another start{} is needed: use {}; or {}", accepted.path ? " or path" : "", placing, change);
  if (kind.source == "mesh") return "another start is needed: change tool.tip_m and tool.tip_axis; or " + change;
  return change;
}

/// Runs the scene. If the run does not end as intended for the scene's kind, returns a warning and the warnings of the
/// run. Omits the warnings about files, which are already printed. `explained`: true if other warnings already explain
/// this outcome; all warnings of the run are then omitted. `advice`: what to change.
std::vector<std::string> outcome_warnings(const CheckedScenario& scene, bool explained, const std::string& advice) {
  const Result run = run_scenario(scene, std::nullopt, false);
  if (outcome_is_expected(scene.scenario().expect, run.end.outcome)) return {};
  std::vector<std::string> warnings;
  if (!explained)
    for (const Warning& warning : run.warnings)
      if (std::ranges::count(scene.file_warnings(), warning) == 0) warnings.push_back(warning.located_text());
  warnings.push_back(fmt::format("a run of this scene ends as \"{0}\" (hapbench describe {0}): {1}",
                                 outcome_name(run.end.outcome), advice));
  return warnings;
}

/// Runs the scene and draws it. The run is written to a folder that the caller has locked.
void draw_preview(const std::filesystem::path& scenario, const std::filesystem::path& run,
                  const std::filesystem::path& picture, bool quiet, ProgramContext& context) {
  run_scenario(checked(load_scenario(scenario)), RunOutput(run, /*has_lock=*/true), {!quiet, context.progress});
  draw_run(context, run, picture, quiet);
}

int write_new(const NewOptions& options, ProgramContext& context) {
  const Layout layout = context.layout();
  if (options.kind.empty()) return list_kinds(options.output, context);
  const StartKind& kind = kind_named(options.kind);
  check_options(options, kind);
  // Choose the files to write; no existing file is replaced.
  const std::filesystem::path source = options.from;
  const std::filesystem::path out =
      !options.out.empty() ? options.out : (source.empty() ? "" : source.stem().string() + "_") + kind.name + ".json";
  const std::filesystem::path directory = out.parent_path();
  const FolderLock lock = locked_results(context, directory.empty() ? "." : directory, out.filename().string(), "new");
  std::error_code ignored;
  const std::filesystem::path picture = std::filesystem::path(out).replace_extension(".svg");
  if (options.preview && std::filesystem::exists(picture, ignored))
    throw InputError(fmt::format("{} exists; choose another name with --out", picture.string()));
  if (std::filesystem::exists(out, ignored))
    throw InputError(fmt::format("{} exists; choose another with --out", out.string()));
  const std::filesystem::path run = results_directory("", out.stem().string());
  std::optional<FolderLock> run_lock;
  if (options.preview) run_lock.emplace(locked_run(context, run));
  // Make the scene and check it before anything is written.
  const StartedScene start = [&] {
    const WaitNotice notice("simulating the scene", !options.output.quiet);
    return started_scene(kind, options, directory);
  }();
  LoadedScenario loaded = read_scenario(start.scene, directory);
  loaded.file = out;
  const CheckedScenario scene = checked(std::move(loaded));
  print_warnings(context, with_files(scene.loaded(), scene.file_warnings()));
  const std::vector<std::string> failure = outcome_warnings(scene, !start.warnings.empty(), remedy(options, kind));
  // Write the scene, draw it with --preview, and explain its fields.
  write_file_atomically(out, json_text(start.scene));

  print_warnings(context, start.warnings);
  print_warnings(context, failure);
  if (options.preview) draw_preview(out, run, picture, options.output.quiet || options.output.json, context);
  std::string text = fmt::format("{}: {}\n", out.string(), kind.summary);
  for (const std::string& note : start.notes) text += note + "\n";
  if (options.preview) text += fmt::format("picture of a run: {}\n", picture.string());
  text += "\n";
  const Json fields = field_meanings(start.scene);
  for (const auto& [path, meaning] : fields.items()) text += layout.entry(path, meaning.get<std::string>(), 0, 34);
  text += fmt::format("\n\"hapbench describe scenario\" explains all fields; next: hapbench run {}\n", shell_file(out));
  Json json = {{"file", out.string()}, {"notes", start.notes}, {"fields", fields}};
  if (options.preview) json["picture"] = picture.string();
  print(context, options.output, text, json);
  return kSuccess;
}

}  // namespace

void add_new(CommandLine& line) {
  auto [command, options] =
      line.command("new", "Write a scenario file to start from, and explain its fields.", write_new);
  command.add("kind <kind>", options.kind,
              "kind of scenario, such as drag, mesh, hole or stroke; without it, all kinds are listed");
  command.add("--from <file>", options.from, "mesh, point shell or stroke to start from");
  command.add("--on <mesh>", options.on, "of kind stroke: mesh to play the stroke over (default: a plane)");
  command.add("--extent <length>", options.extent,
              "true length of the longest edge of the mesh's bounding box, with a unit: 12mm, 1.2cm, 0.012m or 0.5in");
  command.add(
      "--unit <unit>", options.unit,
      "unit of the mesh file, instead of --extent: mm, cm, m or in. Without both options, the file is read in m; it is "
      "rejected if the longest edge of its bounding box is then below 1 mm or above 1 m",
      {.one_of = {"mm", "cm", "m", "in"}});
  command.add(
      "--side <axis>", options.side,
      "side from which the tool approaches: z (default; the tool moves towards -z), x, y, --side=-x, --side=-y or "
      "--side=-z",
      {.one_of = {"x", "y", "z", "-x", "-y", "-z"}});
  command.add(
      "--path <x,y,z>", options.path,
      "point [m] of the path along which the tool moves over the surface (kinds drag, bur, fidelity); repeat --path "
      "for each of two or more points",
      {.several = true});
  command.add("--depth <length>", options.depth,
              "of kind fidelity: depth of the tip below the surface, such as 0.1mm (default: a tenth of the tool's "
              "diameter)");
  command.add("--at <x,y,z>", options.at,
              "start above the surface point nearest to this point [m], on the side of --side; coordinates of --at and "
              "--path are those of the scaled mesh");
  command.flag("--preview", options.preview,
               "also run the scenario and draw surface, tool and path in an .svg file next to it");
  command.add("--out <file.json>", options.out,
              "scenario to write (default: KIND.json in the current folder; with --from my.stl: my_KIND.json)");
  command.footer(
      "Tool: the tool of the kind, usually a drill of 1 mm; change its fields in the written file, such as "
      "tool.diameter_m.\n\n"
      "Files: the scenario, and with --preview a picture next to it (mine.json: mine.svg) and the run in results/out. "
      "An existing scenario or picture is never overwritten: exit status 2.");
}

}  // namespace hapbench
