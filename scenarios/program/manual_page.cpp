#include <fmt/format.h>

#include <cstdio>
#include <sstream>

#include "results/summary/provenance.hpp"
#include "scenarios/program/command.hpp"

namespace hapbench {
namespace {

/// Text as man(7) takes it: backslashes and dashes escaped, and no line that begins like a request.
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

std::string options(const CommandText& command) {
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

std::string manual_page(const std::vector<CommandText>& texts, const std::string& version) {
  const CommandText& program = texts.front();
  std::string page = fmt::format(".TH HAPBENCH 1 \"\" \"{} {}\" \"User Commands\"\n", kProgramName, roff(version));
  page += fmt::format(".SH NAME\n{} \\- {}\n", kProgramName, roff(program.summary));
  page += fmt::format(".SH SYNOPSIS\n.B {}\n[\\fIOPTIONS\\fR] \\fICOMMAND\\fR ...\n", kProgramName);
  page += ".SH OPTIONS\n" + options(program) + ".SH COMMANDS\n";
  for (auto command = texts.begin() + 1; command != texts.end(); ++command) {
    page += fmt::format(".SS {}\n{}\n", roff(command->name), roff(command->summary)) + options(*command) +
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
