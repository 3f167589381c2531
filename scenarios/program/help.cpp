#include <fmt/format.h>

#include <algorithm>
#include <sstream>

#include "scenarios/program/command.hpp"
#include "scenarios/program/table.hpp"

namespace hapbench {
namespace {

std::string usage(const CommandText& command, bool is_program) {
  std::string words = is_program ? kProgramName : fmt::format("{} {}", kProgramName, command.name);
  words += " [OPTIONS]";
  if (is_program) words += " COMMAND";
  for (const OptionText& option : command.options) {
    if (!option.is_argument) continue;
    const std::string name = option.name + (option.value.ends_with("...") ? "..." : "");
    words += option.is_required ? " " + name : " [" + name + "]";
  }
  return "Usage: " + words + "\n";
}

std::string options_text(const std::vector<OptionText>& options, bool arguments) {
  std::string text;
  for (const OptionText& option : options) {
    if (option.is_argument != arguments) continue;
    const bool shows_value = !arguments && !option.value.empty();
    text += entry(shows_value ? option.name + " " + option.value : option.name,
                  option.help + (option.is_required && !arguments ? "; required" : ""));
  }
  return text.empty() ? "" : fmt::format("\n{}\n{}", bold(stdout, arguments ? "Arguments:" : "Options:"), text);
}

/// Wraps paragraphs, one per line. A line that begins with blanks keeps them, and its continuation is indented further.
std::string wrapped_paragraphs(const std::string& text) {
  std::string wrapped_text;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t indent = std::min(line.find_first_not_of(' '), line.size());
    const std::string rest = line.substr(indent);
    wrapped_text += indent == 0 ? wrapped(rest, 0) : wrapped(rest, indent + 2).erase(0, 2);
  }
  return wrapped_text;
}

}  // namespace

std::string help_text(const std::vector<CommandText>& texts, const std::string& command) {
  const auto found = std::find_if(texts.begin(), texts.end(), [&](const CommandText& t) { return t.name == command; });
  const bool is_program = found == texts.begin();
  std::string text =
      is_program ? wrapped(fmt::format("{}: {}", kProgramName, found->summary), 0) : wrapped(found->summary, 0);
  text += usage(*found, is_program) + options_text(found->options, true) + options_text(found->options, false);
  if (is_program) {
    text += "\n" + bold(stdout, "Commands:") + "\n";
    for (auto it = texts.begin() + 1; it != texts.end(); ++it) text += entry(it->name, it->summary, 2, 16);
  }
  return found->footer.empty() ? text : text + "\n" + wrapped_paragraphs(found->footer);
}

}  // namespace hapbench
