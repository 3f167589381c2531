#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "results/io/atomic_file.hpp"
#include "scenarios/description/load_scenario.hpp"
#include "scenarios/program/command.hpp"
#include "scenarios/program/fields_text.hpp"
#include "scenarios/program/scenario_start.hpp"
#include "scenarios/program/table.hpp"
#include "scenarios/run/assemble.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

struct NewOptions {
  std::string kind;
  std::string from;
  std::string out;
  OutputOptions output;
};

std::vector<std::string> kind_names() {
  return names_of(start_kinds(), &StartKind::name);
}

const StartKind& kind_named(const std::string& name) {
  const std::vector<std::string> names = kind_names();
  require_valid_name("KIND: got", name, names);
  return start_kinds()[static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin())];
}

void check_source(const StartKind& kind, const std::string& from) {
  if (kind.needs_source && from.empty())
    throw InputError(fmt::format("--from: missing; \"{}\" starts from a file", kind.name));
  if (kind.source == StartSource::none && !from.empty())
    throw InputError(fmt::format("--from: got \"{}\"; \"{}\" starts from no file", from, kind.name));
  std::error_code ignored;
  if (!from.empty() && !fs::exists(from, ignored))
    throw InputError(fmt::format("--from {}: cannot be read: no such file", from));
}

int list_kinds(const OutputOptions& output) {
  Table table({{"KIND", false}, {"what it starts with", false}});
  Json json = Json::array();
  for (const StartKind& kind : start_kinds()) {
    table.add({kind.name, kind.summary});
    json.push_back({{"kind", kind.name}, {"summary", kind.summary}});
  }
  print(output, table.text(), json);
  return kSuccess;
}

int write_new(const NewOptions& options) {
  if (options.kind.empty()) return list_kinds(options.output);
  const StartKind& kind = kind_named(options.kind);
  check_source(kind, options.from);
  const fs::path source = options.from;
  const fs::path out =
      !options.out.empty() ? options.out : (source.empty() ? "" : source.stem().string() + "_") + kind.name + ".json";
  std::error_code ignored;
  if (fs::exists(out, ignored)) throw InputError(fmt::format("{} exists; choose another with --out", out.string()));
  const fs::path directory = out.parent_path();
  const ScenarioStart start = scenario_start(kind, source.empty() ? std::nullopt : std::optional(source), directory);
  const Json json = parse_json(start.text);
  LoadedScenario loaded = read_scenario(json, directory);
  loaded.file = out;
  print_warnings(check_named_files(loaded));
  require_writable_directory(directory.empty() ? "." : directory);
  write_file_atomically(out, start.text);

  print_warnings(start.warnings);
  const std::vector<FieldMeaning> meanings = field_meanings(json);
  std::string text = fmt::format("{}: {}\n", out.string(), kind.summary);
  for (const std::string& note : start.notes) text += note + "\n";
  text += "\n";
  for (const FieldMeaning& field : meanings) text += entry(field.path, field.meaning, 0, 34);
  text += "\n";
  text += fmt::format("\"hapbench describe scenario\" shows all fields; next: hapbench run {}\n", out.string());
  Json fields = Json::object();
  for (const FieldMeaning& field : meanings) fields[field.path] = field.meaning;
  print(options.output, text, {{"file", out.string()}, {"notes", start.notes}, {"fields", fields}});
  return kSuccess;
}

}  // namespace

void add_new(CommandLine& line) {
  auto [command, options] = line.command("new", "Write a scenario to start from and explain its fields", write_new);
  command.add("kind", options.kind, "the kind of scenario; without it, the kinds are listed").words(kind_names);
  command.add("--from", options.from, "the file of the mesh, shell or stroke to start from");
  command.add("--out", options.out, "the file to write, which must not exist (default: [FROM_]KIND.json)");
  add_output_options(command, options.output);
}

}  // namespace hapbench
