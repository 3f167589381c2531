#include "scenarios/program/usage_errors.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/nearest_name.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/program/program_arguments.hpp"
#include "scenarios/scene/scenario_schema.hpp"

namespace hapbench {

namespace {

std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

/// Returns the options of a command that an error text of CLI11 names, in the order of the text. CLI11 gives
/// the option at fault only in the text.
std::vector<std::string> options_named(const std::string& text, const CLI::App& command) {
  const std::vector<std::string> known = option_names(command);
  std::vector<std::string> named;
  for (std::size_t begin = text.find("--"); begin != std::string::npos;) {
    const std::size_t end = std::min(text.find_first_not_of("abcdefghijklmnopqrstuvwxyz-", begin), text.size());
    const std::string name = text.substr(begin, end - begin);
    if (std::ranges::count(known, name) > 0) named.push_back(name);
    begin = text.find("--", end);
  }
  return named;
}

/// Returns a hint for users who give a field of scenarios as an option; empty for other options.
std::string field_hint(const std::string& option, const std::vector<std::string>& known) {
  const std::string field = option.substr(std::min(option.find_first_not_of('-'), option.size()));
  if (nearest_name(field, scenario_field_paths()).empty()) return "";
  if (std::ranges::count(known, "--vary") > 0) return "; fields are varied by --vary FIELD=VALUES";
  return std::ranges::count(known, "--set") > 0 ? "; fields are set by --set FIELD=VALUE" : "";
}

/// Explains an argument that no option or positional argument takes.
std::string problem_of(const std::string& argument, const CLI::App& program, const CLI::App* command) {
  if (argument.starts_with("-") && argument != "-") {
    const std::string name = argument.substr(0, argument.find('='));
    const std::vector<std::string> known = option_names(command ? *command : program);
    const std::string hint = nearest_name_hint(name, known);
    return fmt::format("unknown option \"{}\"{}", name, hint.empty() ? field_hint(name, known) : hint);
  }
  if (command != nullptr) return fmt::format("unexpected argument \"{}\"", argument);
  std::vector<std::string> names = names_of(program.get_subcommands({}), &CLI::App::get_name);
  std::ranges::copy(option_names(program), std::back_inserter(names));
  return fmt::format("unknown command \"{}\"{}", argument, nearest_name_hint(argument, names));
}

/// Returns the text of an error of CLI11. For a value that is not a number, CLI11 writes "Could not convert: OPTION =
/// VALUE"; this function replaces that text by a text that says what is allowed.
std::string text_of(const CLI::ParseError& error) {
  constexpr std::string_view kHead = "Could not convert: ", kEquals = " = ";
  const std::string text = error.what();
  const std::size_t equals = text.find(kEquals);
  if (!text.starts_with(kHead) || equals == std::string::npos) return one_line(text);
  return one_line(fmt::format("{}: got \"{}\"; allowed: a number without a unit",
                              text.substr(kHead.size(), equals - kHead.size()), text.substr(equals + kEquals.size())));
}

}  // namespace

InputError usage_error(const CLI::ParseError& error, const CLI::App& program) {
  const std::vector<CLI::App*> chosen = program.get_subcommands();
  const CLI::App* command = chosen.empty() ? nullptr : chosen.front();
  const std::string name = command ? command->get_name() + ": " : "", prefix = command ? command->get_name() + " " : "";
  const std::string help = fmt::format("; \"hapbench {}--help\" explains", prefix);
  // If there is an extra argument, it is the mistake. Otherwise CLI11's text explains the mistake.
  ProgramArguments extra = program.remaining(true);
  std::erase(extra, "--");
  // An unknown option leaves its value as an extra argument. Report the option, which is the mistake.
  std::stable_partition(extra.begin(), extra.end(),
                        [](const std::string& argument) { return argument.starts_with("-"); });
  const auto error_about = [](std::vector<std::string> options, const std::string& problem) {
    return InputError(InputError::Kind::relation, ErrorLocation{.about_options = std::move(options)}, problem);
  };
  if (!extra.empty()) {
    const std::string& argument = extra.front();
    return error_about({argument.substr(0, argument.find('='))}, name + problem_of(argument, program, command) + help);
  }
  if (command == nullptr && error.get_name() == "RequiredError") return InputError("a command is missing" + help);
  return error_about(options_named(error.what(), command ? *command : program), name + text_of(error) + help);
}

}  // namespace hapbench
