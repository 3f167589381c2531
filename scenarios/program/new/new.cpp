#include "scenarios/program/new/new.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <utility>

#include "results/io/atomic_file.hpp"
#include "scenarios/input/writer.hpp"
#include "scenarios/program/columns.hpp"
#include "scenarios/program/exit_status.hpp"
#include "scenarios/program/new/meanings.hpp"
#include "scenarios/program/new/start.hpp"
#include "scenarios/program/output.hpp"
#include "scenarios/program/python_commands.hpp"
#include "scenarios/program/results_folder.hpp"
#include "scenarios/run/checked_scenario.hpp"
#include "scenarios/run/progress_bar.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/run/scene_checks.hpp"

namespace hapbench {
namespace {

int list_kinds(const OutputOptions& output, ProgramContext& context) {
  const Layout layout = context.layout();
  const Columns<StartKind> columns = {{"kind", "", "", &StartKind::name, under("KIND")},
                                      {"summary", "", "", &StartKind::summary, under("what it starts with")}};
  print(context, output, columns.text(start_kinds(), layout), columns.json_list(start_kinds()));
  return kSuccess;
}

void draw_preview(const std::filesystem::path& scenario, const std::filesystem::path& picture, bool quiet,
                  ProgramContext& context) {
  const std::filesystem::path run = results_directory("", scenario.stem().string());
  require_writable_directory(context, run);
  run_scenario(checked(load_scenario(scenario)), run, {!quiet, context.progress});
  write_way(context, run, picture, quiet);
}

int write_new(const NewOptions& options, ProgramContext& context) {
  const Layout layout = context.layout();
  if (options.kind.empty()) return list_kinds(options.output, context);
  const StartKind& kind = kind_named(options.kind);
  check_options(options, kind);
  const std::filesystem::path source = options.from;
  const std::filesystem::path out =
      !options.out.empty() ? options.out : (source.empty() ? "" : source.stem().string() + "_") + kind.name + ".json";
  std::error_code ignored;
  const std::filesystem::path picture = std::filesystem::path(out).replace_extension(".svg");
  if (options.preview && std::filesystem::exists(picture, ignored))
    throw InputError(fmt::format("{} exists; choose another name with --out", picture.string()));
  if (std::filesystem::exists(out, ignored))
    throw InputError(fmt::format("{} exists; choose another with --out", out.string()));
  const std::filesystem::path directory = out.parent_path();
  const StartedScene start = [&] {
    const WaitNotice notice("trying the scene", !options.output.quiet);
    return started_scene(kind, options, directory);
  }();
  LoadedScenario loaded = read_scenario(start.scene, directory);
  loaded.file = out;
  const CheckedScenario scene = checked(std::move(loaded));
  print_warnings(context, with_files(scene.loaded(), scene.file_warnings()));
  require_writable_directory(context, directory.empty() ? "." : directory);
  write_file_atomically(out, json_text(start.scene));

  print_warnings(context, start.warnings);
  if (options.preview) draw_preview(out, picture, options.output.quiet || options.output.json, context);
  std::string text = fmt::format("{}: {}\n", out.string(), kind.summary);
  for (const std::string& note : start.notes) text += note + "\n";
  if (options.preview) text += fmt::format("picture of a run in {}\n", picture.string());
  text += "\n";
  const Json fields = field_meanings(start.scene);
  for (const auto& [path, meaning] : fields.items()) text += layout.entry(path, meaning.get<std::string>(), 0, 34);
  text += fmt::format("\n\"hapbench describe scenario\" shows all fields; next: hapbench run {}\n", out.string());
  Json said = {{"file", out.string()}, {"notes", start.notes}, {"fields", fields}};
  if (options.preview) said["picture"] = picture.string();
  print(context, options.output, text, said);
  return kSuccess;
}

}  // namespace

void add_new(CommandLine& line) {
  auto [command, options] = line.command("new", "Write a scenario to start from and explain its fields", write_new);
  command.add("kind", options.kind, "the kind of scenario; without it, the kinds are listed");
  command.add("--from", options.from, "the file of the mesh, shell or stroke to start from");
  command.add("--on", options.on, "of a stroke: the mesh that it is played back over, in place of a plane");
  command.add(
      "--extent", options.extent,
      "size of the mesh, the longest edge of its box, with a unit: 12mm, 1.2cm, 0.012m, 0.5in (default: the file is "
      "in metres)");
  command.add("--unit", options.unit,
              "unit of the mesh's file: mm, cm, m or in; replaces --extent and keeps the size of the mesh",
              {.one_of = {"mm", "cm", "m", "in"}});
  command.add("--side", options.side, "from which the tool comes: x, y, z (default), or --side=-x, -y, -z",
              {.one_of = {"x", "y", "z", "-x", "-y", "-z"}});
  command.add("--path", options.path, "X,Y,Z [m] of a point to drag over; give it for each, two or more",
              {.several = true});
  command.add("--at", options.at, "X,Y,Z [m]: start over the place of the surface that is nearest to it");
  command.flag("--preview", options.preview, "run the scene and draw it: the surface, the tool on its way; FILE.svg");
  command.add("--out", options.out, "the file to write, which must not exist (default: [FROM_]KIND.json)");
}

}  // namespace hapbench
