#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

#include "scenarios/description/bundled_scenarios.hpp"
#include "scenarios/description/load_scenario.hpp"
#include "scenarios/description/metric_sections.hpp"
#include "scenarios/program/command.hpp"
#include "scenarios/program/describe.hpp"
#include "scenarios/program/fields_text.hpp"
#include "scenarios/program/scenario_start.hpp"
#include "scenarios/studies/precision/measure.hpp"
#include "scenarios/studies/stability/stability_map.hpp"
#include "scenarios/thesis_claims/claims.hpp"
#include "sim/loop/integrators/table.hpp"

namespace hapbench {
namespace {

using WordList = std::vector<std::string>;

/// Joins words that a shell broke at "=" and ":".
WordList joined_at_breaks(const WordList& words) {
  WordList joined;
  bool behind_break = false;
  for (const std::string& word : words) {
    const bool is_break = word == "=" || word == ":";
    if ((is_break || behind_break) && !joined.empty()) {
      joined.back() += word;
    } else {
      joined.push_back(word);
    }
    behind_break = is_break;
  }
  return joined;
}

/// The words that begin with `typed`, each once and behind `before`. Of assignments FIELD=VALUE only "FIELD=" is
/// offered until the "=" is typed, then only those with a value.
WordList beginning_with(const std::string& typed, const std::string& before, const WordList& words) {
  const bool has_value = typed.find('=') != std::string::npos;
  WordList found;
  for (const std::string& word : words) {
    const std::size_t equals = word.find('=');
    const bool is_value = equals != std::string::npos && equals + 1 < word.size();
    if (!word.starts_with(typed) || is_value != (has_value && equals != std::string::npos)) continue;
    // A name may stand for two things and so be listed twice.
    if (std::find(found.begin(), found.end(), before + word) == found.end()) found.push_back(before + word);
  }
  return found;
}

WordList long_options(const CommandText& command) {
  WordList names;
  for (const OptionText& option : command.options) {
    if (!option.is_argument) names.push_back(option.name.substr(option.name.rfind(',') + 1));
  }
  return names;
}

/// The option of that name that takes a value, or null.
const OptionText* option_named(const CommandText& command, const std::string& name) {
  for (const OptionText& option : command.options) {
    if (option.name == name && !option.is_argument && !option.value.empty()) return &option;
  }
  return nullptr;
}

/// The positional argument that the word behind `words` binds to, or null.
const OptionText* next_argument(const CommandText& command, const WordList& words) {
  std::size_t place = 0;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (option_named(command, words[i]) != nullptr) {
      ++i;  // skips its value
    } else if (!words[i].starts_with("-")) {
      ++place;
    }
  }
  const OptionText* last = nullptr;
  for (const OptionText& option : command.options) {
    if (!option.is_argument) continue;
    last = &option;
    if (place-- == 0) return last;
  }
  return last != nullptr && last->value.ends_with("...") ? last : nullptr;
}

/// Completes the last of the words behind a command.
WordList completed(const CommandText& command, const WordList& words) {
  std::string typed = words.back(), before;
  const OptionText* option = words.size() > 1 ? option_named(command, words[words.size() - 2]) : nullptr;
  if (const std::size_t equals = typed.find('=');
      option == nullptr && typed.starts_with("--") && equals < typed.size()) {
    option = option_named(command, typed.substr(0, equals));
    before = typed.substr(0, equals + 1);
    typed.erase(0, equals + 1);
  }
  if (option == nullptr && typed.starts_with("-")) {
    return beginning_with(typed, before, long_options(command));
  }
  if (option == nullptr) option = next_argument(command, {words.begin(), words.end() - 1});
  if (option == nullptr || !option->words) return {};
  if (const std::size_t comma = typed.rfind(','); option->takes_a_list && comma != std::string::npos) {
    before += typed.substr(0, comma + 1);
    typed.erase(0, comma + 1);
  }
  return beginning_with(typed, before, option->words());
}

/// bash hands over the program's name as it was typed, with the backslashes before blanks and quotes.
constexpr const char* kBash = R"(_hapbench() {
  local IFS=$'\n' program=${1/#\~/$HOME}
  COMPREPLY=($("${program//\\/}" complete "${COMP_WORDS[@]:1:$COMP_CWORD}" 2>/dev/null))
  case ${COMPREPLY[0]-} in *=) compopt -o nospace 2>/dev/null ;; esac
}
complete -o default -F _hapbench hapbench
)";

/// zsh understands bash's completions after this line.
constexpr const char* kZsh = "autoload -U +X bashcompinit && bashcompinit\n";

constexpr const char* kFish = R"(complete -c hapbench -a '(hapbench complete (commandline -opc)[2..] (commandline -ct))'
)";

int print_script(const std::string& shell) {
  if (shell == "zsh") std::fputs(kZsh, stdout);
  std::fputs(shell == "fish" ? kFish : kBash, stdout);
  return kSuccess;
}

}  // namespace

WordList completions(const std::vector<CommandText>& texts, const WordList& words) {
  const WordList joined = joined_at_breaks(words);
  WordList found;
  if (joined.size() == 1) {
    WordList names;
    if (!joined.back().empty()) names = long_options(texts.front());
    for (auto command = texts.begin() + 1; command != texts.end(); ++command) names.push_back(command->name);
    found = beginning_with(joined.back(), "", names);
  } else {
    for (const CommandText& command : texts) {
      if (command.name == joined[0]) found = completed(command, {joined.begin() + 1, joined.end()});
    }
  }
  // The shell inserts only what stands behind its last break.
  const bool ends_in_break = words.back() == "=" || words.back() == ":";
  const std::size_t kept = joined.back().size() - (ends_in_break ? 0 : words.back().size());
  for (std::string& word : found) word.erase(0, kept);
  return found;
}

void add_completion(CommandLine& line) {
  auto [command, shell] =
      line.command("completion", "Print a script that lets a shell complete commands, options and names", print_script);
  command.add("shell", shell, "bash, zsh or fish").required().one_of({"bash", "zsh", "fish"});
  command.footer(
      "In ~/.bashrc:\n"
      "  source <(hapbench completion bash)\n"
      "In ~/.zshrc, after compinit:\n"
      "  source <(hapbench completion zsh)\n"
      "For fish:\n"
      "  hapbench completion fish >~/.config/fish/completions/hapbench.fish");
}

}  // namespace hapbench
