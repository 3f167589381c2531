#include "scenarios/program/help.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <string_view>
#include <vector>

#include "scenarios/input/text_lines.hpp"
#include "scenarios/program/commands.hpp"
#include "scenarios/program/options.hpp"
#include "scenarios/program/text.hpp"

namespace hapbench {

namespace {

std::string name_of(const CLI::Option& option) {
  return option.get_name(option.get_positional(), true);
}

/// Returns the placeholder of the value, such as "<file>", or its type, such as "TEXT ..."; empty for a flag.
std::string kind_of_value(const CLI::Option& option) {
  if (option.get_type_size() == 0 || option.get_type_name().empty()) return "";
  std::string kind = option.get_type_name();
  if (kind.starts_with('<')) return kind;
  if (option.get_expected_max() == CLI::detail::expected_max_vector_size)
    kind += option.get_delimiter() == ',' ? ",..." : " ...";
  return kind;
}

/// Returns the name of a positional argument in the help: its placeholder if it has one, otherwise its own name.
std::string argument_name(const CLI::Option& option) {
  std::string kind = kind_of_value(option);
  if (kind.starts_with('<')) return kind;
  return name_of(option) + (kind.ends_with("...") ? "..." : "");
}

std::string usage(const CLI::App& app) {
  std::string words = fmt::format("Usage: hapbench {} [OPTIONS]", app.get_name());
  for (const CLI::Option* option : app.get_options([](const CLI::Option* o) { return o->get_positional(); })) {
    const std::string name = argument_name(*option);
    words += option->get_required() ? " " + name : " [" + name + "]";
  }
  return words + "\n";
}

/// The column where the texts of options begin.
constexpr std::size_t kHelpColumn = 28;
constexpr const char* kSharedOptionsNote = "shared options; \"hapbench --help\" explains them";

/// Returns the entry of an argument or an option: its name with the placeholder of its value, its meaning and
/// the options that it requires.
std::string option_entry(const CLI::Option& option, const std::string& name, const Layout& layout) {
  if (option.get_positional()) return layout.entry(argument_name(option), option.get_description(), 2, kHelpColumn);
  const std::string kind = kind_of_value(option);
  std::string help = option.get_description();
  for (const CLI::Option* other : option.get_needs()) help += "; requires " + other->get_name();
  if (option.get_required()) help += "; required";
  return layout.entry(kind.empty() ? name : name + " " + kind, help, 2, kHelpColumn);
}

/// Returns the help of the positional arguments, or the help of the options. Lists shared options in one line by name.
std::string options_text(const CLI::App& app, bool arguments, const Layout& layout) {
  std::string text, shared;
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_positional() != arguments) continue;
    std::string name = name_of(*option);
    if (name == "-h,--help") name = "--help";
    if (!arguments && is_listed_briefly(name) && option->get_description() == shared_option_help(name)) {
      shared += (shared.empty() ? "" : ", ") + name;
    } else {
      text += option_entry(*option, name, layout);
    }
  }
  if (!shared.empty()) text += layout.entry(shared, kSharedOptionsNote, 2, kHelpColumn);
  return text.empty() ? "" : fmt::format("\n{}\n{}", bold(stdout, arguments ? "Arguments:" : "Options:"), text);
}

/// Returns true if a command has the shared option with its usual meaning. In other commands, an option of the same
/// name has another placeholder, such as `new --out <file.json>`.
bool has_option(const CommandGuide& guide, const SharedOption& shared, const CLI::App& program) {
  if (guide.add == nullptr) return std::ranges::count(shared.python_commands, guide.name) > 0;
  const CLI::Option* option =
      program.get_subcommand(std::string(guide.name))->get_option_no_throw(std::string(shared.name));
  return option != nullptr && kind_of_value(*option) == shared.placeholder;
}

/// Returns a text in parentheses with the commands that have the shared option. If less than a third of all commands do
/// not have the option, names these instead. Returns an empty text if all commands have the option.
std::string commands_text(const SharedOption& shared, const CLI::App& program) {
  std::vector<std::string_view> with, without;
  for (const CommandGuide& guide : command_guides())
    (has_option(guide, shared, program) ? with : without).push_back(guide.name);
  if (without.empty()) return "";
  const bool names_others = 2 * without.size() < with.size();
  return fmt::format(" ({}: {})", names_others ? "not in" : "in", fmt::join(names_others ? without : with, ", "));
}

}  // namespace

std::string front_text(const Layout& layout) {
  std::string text = fmt::format("hapbench: {}\n\n", kProgramSummary);
  std::string_view group;
  for (const CommandGuide& guide : command_guides()) {
    text +=
        layout.entry(fmt::format("{:8}{}", guide.group == group ? "" : guide.group, guide.name), guide.purpose, 0, 19);
    group = guide.group;
  }
  return text +
         "\n"
         "first   hapbench run drag_molar\n"
         "        hapbench new drag --from my.stl --extent 12mm\n"
         "        hapbench describe\n\n"
         "\"hapbench COMMAND --help\" explains a command and lists its options.\n"
         "\"hapbench --help\" explains the options that several commands share.\n";
}

std::string program_help(const CLI::App& program, const Layout& layout) {
  std::string text = front_text(layout) + "\n" + bold(stdout, "Options without a command:") + "\n";
  text += layout.entry("--help", "print this text", 2, 14);
  text += layout.entry(
      "--version", "print the version; with --json also commit, compiler, instruction set and what later versions keep",
      2, 14);
  // Indent these options by four spaces: scripts/completion offers only options that are indented by two spaces.
  text += "\n" + bold(stdout, "Options that commands share, written after the command's name:") + "\n";
  for (const SharedOption& option : shared_options())
    text += layout.entry(fmt::format("{}{}{}", option.name, option.placeholder.empty() ? "" : " ", option.placeholder),
                         std::string(option.help) + commands_text(option, program), 4, kHelpColumn);
  return text + "\n" + bold(stdout, "Exit status:") + "\n" + layout.entry("0", "success", 2, 8) +
         layout.entry("1", "internal fault", 2, 8) + layout.entry("2", "bad input or usage", 2, 8) +
         layout.entry("3", "a run did not end as its scenario expects, or the cause that the command's help names", 2,
                      8) +
         layout.entry("130", "stopped by Ctrl-C", 2, 8) + "\nManual: scenarios/README.md, section \"Commands\"\n";
}

std::string command_help(const CLI::App& app, const Layout& layout) {
  const CommandGuide& guide = *std::ranges::find(command_guides(), app.get_name(), &CommandGuide::name);
  std::string text = layout.wrapped(app.get_description(), 0) + "\n" + usage(app) + options_text(app, true, layout) +
                     options_text(app, false, layout) + "\n";
  if (!app.get_footer().empty()) text += layout.wrapped(app.get_footer(), 0) + "\n";
  text += bold(stdout, "Examples:") + "\n";
  LineReader examples(guide.examples);
  while (const auto example = examples.next()) text += fmt::format("  hapbench {}\n", *example);
  if (!guide.manual.empty()) text += "\n" + layout.wrapped(fmt::format("Manual: {}", guide.manual), 0);
  return text;
}

}  // namespace hapbench
