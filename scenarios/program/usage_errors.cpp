#include "scenarios/program/usage_errors.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iterator>
#include <vector>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/nearest_name.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/program/program_words.hpp"
#include "scenarios/scene/scenario_schema.hpp"

namespace hapbench {

namespace {

std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

/// Tells a user who wrote a field of scenarios as an option how fields are given.
std::string field_hint(const std::string& option, const std::vector<std::string>& known) {
  const std::string field = option.substr(std::min(option.find_first_not_of('-'), option.size()));
  if (nearest_name(field, scenario_field_paths()).empty()) return "";
  if (std::ranges::count(known, "--vary") > 0) return "; fields are varied by --vary FIELD=VALUES";
  return std::ranges::count(known, "--set") > 0 ? "; fields are set by --set FIELD=VALUE" : "";
}

/// Explains a word that no option or argument takes.
std::string problem_of(const std::string& word, const CLI::App& program, const CLI::App* command) {
  if (word.starts_with("-") && word != "-") {
    const std::string name = word.substr(0, word.find('='));
    const std::vector<std::string> known = option_names(command ? *command : program);
    const std::string hint = nearest_name_hint(name, known);
    return fmt::format("unknown option \"{}\"{}", name, hint.empty() ? field_hint(name, known) : hint);
  }
  if (command != nullptr) return fmt::format("unexpected argument \"{}\"", word);
  std::vector<std::string> names = names_of(program.get_subcommands({}), &CLI::App::get_name);
  std::ranges::copy(option_names(program), std::back_inserter(names));
  return fmt::format("unknown command \"{}\"{}", word, nearest_name_hint(word, names));
}

}  // namespace

std::string usage_problem(const CLI::ParseError& error, const CLI::App& program) {
  const std::vector<CLI::App*> chosen = program.get_subcommands();
  const CLI::App* command = chosen.empty() ? nullptr : chosen.front();
  const std::string name = command ? command->get_name() + ": " : "", words = command ? command->get_name() + " " : "";
  const std::string help = fmt::format("; \"hapbench {}--help\" explains", words);
  ProgramWords extra = program.remaining(true);
  std::erase(extra, "--");
  // An unknown option leaves its value behind as an extra word; the option is the mistake to report.
  std::stable_partition(extra.begin(), extra.end(), [](const std::string& word) { return word.starts_with("-"); });
  if (!extra.empty()) return name + problem_of(extra.front(), program, command) + help;
  if (command == nullptr && error.get_name() == "RequiredError") return "a command is missing" + help;
  return one_line(name + error.what()) + help;
}

}  // namespace hapbench
