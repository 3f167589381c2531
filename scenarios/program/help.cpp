#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <sstream>

#include "results/summary/provenance.hpp"
#include "scenarios/program/command.hpp"
#include "scenarios/program/table.hpp"

/// Help and the manual page.
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

/// Escapes text for man(7): backslashes, dashes and a period or quote that would begin a request.
std::string roff(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    if (escaped.empty() && (c == '.' || c == '\'')) escaped += "\\&";
    if (c == '\\') {
      escaped += "\\e";
    } else if (c == '-') {
      escaped += "\\-";
    } else {
      escaped += c;
    }
  }
  return escaped;
}

std::string roff_options(const CommandText& command) {
  std::string text;
  for (const OptionText& option : command.options) {
    text += ".TP\n\\fB" + roff(option.name) + "\\fR";
    if (!option.is_argument && !option.value.empty()) text += " \\fI" + roff(option.value) + "\\fR";
    text += "\n" + roff(option.help) + (option.is_required ? " (required)" : "") + "\n";
  }
  return text;
}

std::string roff_paragraphs(const std::string& footer) {
  std::string text;
  std::istringstream lines(footer);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t indent = line.find_first_not_of(' ');
    if (indent == std::string::npos) continue;
    text += (indent == 0 ? ".PP\n" : ".IP \"\" 4\n") + roff(std::string_view(line).substr(indent)) + "\n";
  }
  return text;
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

std::string manual_page(const std::vector<CommandText>& texts, const std::string& version) {
  const CommandText& program = texts.front();
  std::string page = fmt::format(".TH HAPBENCH 1 \"\" \"{} {}\" \"User Commands\"\n", kProgramName, roff(version));
  page += fmt::format(".SH NAME\n{} \\- {}\n", kProgramName, roff(program.summary));
  page += fmt::format(".SH SYNOPSIS\n.B {}\n[\\fIOPTIONS\\fR] \\fICOMMAND\\fR ...\n", kProgramName);
  page += ".SH OPTIONS\n" + roff_options(program) + ".SH COMMANDS\n";
  for (auto command = texts.begin() + 1; command != texts.end(); ++command) {
    page += fmt::format(".SS {}\n{}\n", roff(command->name), roff(command->summary)) + roff_options(*command) +
            roff_paragraphs(command->footer);
  }
  return page + ".SH EXIT STATUS\n" + roff_paragraphs(program.footer);
}

void add_man(CommandLine& line) {
  Command command = line.command("man", "Print the manual page, for \"man -l -\"");
  command.footer("  hapbench man | man -l -");
  command.runs([&line] {
    const std::string page = manual_page(line.texts(), provenance().version);
    std::fwrite(page.data(), 1, page.size(), stdout);
    return kSuccess;
  });
}

}  // namespace hapbench
