#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "scenarios/description/bundled_scenarios.hpp"
#include "scenarios/description/load_scenario.hpp"
#include "scenarios/import/import_options.hpp"
#include "scenarios/program/command.hpp"
#include "scenarios/program/describe.hpp"
#include "scenarios/program/scenario_start.hpp"
#include "scenarios/program/schema_text.hpp"
#include "scenarios/studies/precision/measure.hpp"
#include "scenarios/studies/stability/stability_map.hpp"
#include "scenarios/thesis_claims/claims.hpp"
#include "sim/loop/integrators/table.hpp"

namespace hapbench {
namespace {

using WordList = std::vector<std::string>;

WordList with_all(WordList words) {
  words.emplace_back("all");
  return words;
}

WordList scenario_names() {
  WordList names;
  for (const BundledScenario& bundled : bundled_scenarios()) names.push_back(bundled.name);
  return names;
}

WordList integrator_names() {
  WordList names;
  for (const IntegratorEntry* entry : kIntegrators) names.emplace_back(entry->info.name);
  return names;
}

/// "path=" for each field and "path=value" for each value of those that have names for them.
WordList assignments() {
  WordList words;
  for (const std::string& path : scenario_field_paths()) {
    words.push_back(path + "=");
    const Json* field = find_in_schema(scenario_schema_once(), path);
    if (field == nullptr) continue;
    if (field->value("type", "") == "boolean") words.insert(words.end(), {path + "=true", path + "=false"});
    for (const Json& value : field->value("enum", Json::array()))
      words.push_back(path + "=" + value.get<std::string>());
  }
  return words;
}

/// What the value of an option, or an argument, can be, by its name, which means the same in every command.
WordList values_of(const std::string& name) {
  if (name == "scenario" || name == "scenarios" || name == "--scenario") return scenario_names();
  if (name == "--set" || name == "--vary") return assignments();
  if (name == "--algorithms") return with_all(all_algorithms());
  if (name == "--integrators") return with_all(integrator_names());
  if (name == "--metric" || name == "--by") return metric_names();
  if (name == "name") return described_names();
  if (name == "what")
    return {"algorithms", "depth_models", "stages", "integrators", "environments", "hands",   "devices", "scenarios",
            "thesis",     "limits",       "beyond", "quality",     "examples",     "metrics", "claims"};
  if (name == "--objective") return {"created", "vibration"};
  if (name == "--format") return stroke_format_names();
  if (name == "--orientation") return orientation_names();
  if (name == "shell") return {"bash", "zsh", "fish"};
  WordList words;
  if (name == "kind")
    for (const StartKind& kind : start_kinds()) words.emplace_back(kind.name);
  if (name == "--preset")
    for (const ImportPreset& preset : import_presets()) words.push_back(preset.name);
  if (name == "--map")
    for (const StabilityMap& map : stability_maps()) words.push_back(map.name);
  if (name == "studies")
    for (const PrecisionStudy* study : kPrecisionStudies) words.emplace_back(study->name);
  if (name == "--only")
    for (const Claim& claim : all_claims()) words.push_back(claim.id);
  return name == "--map" || name == "studies" ? with_all(words) : words;
}

/// The words as they would be if the shell broke them at blanks alone.
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

/// The words that begin with `typed`, in front of which `before` stands in the same word. Behind "=" come the values,
/// before it the paths alone.
WordList beginning_with(const std::string& typed, const std::string& before, const WordList& words) {
  const bool has_value = typed.find('=') != std::string::npos;
  WordList found;
  for (const std::string& word : words) {
    const std::size_t equals = word.find('=');
    const bool is_value = equals != std::string::npos && equals + 1 < word.size();
    if (!word.starts_with(typed) || is_value != (has_value && equals != std::string::npos)) continue;
    // Some names mean two things.
    if (std::find(found.begin(), found.end(), before + word) == found.end()) found.push_back(before + word);
  }
  return found;
}

/// The argument that a word is whose `words` stand before it behind the command; null when there is none.
const OptionText* argument_at(const CommandText& command, const WordList& words) {
  const auto find = [&](const std::string& name) {
    return std::find_if(command.options.begin(), command.options.end(),
                        [&](const OptionText& option) { return option.name == name; });
  };
  std::size_t place = 0;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const auto option = find(words[i]);
    if (option != command.options.end() && !option->is_argument && !option->value.empty()) {
      ++i;  // its value
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

WordList candidates(const CommandText& command, const WordList& words) {
  std::string typed = words.back(), before;
  const OptionText* option = nullptr;
  const auto named = [&](const std::string& name) -> const OptionText* {
    for (const OptionText& known : command.options) {
      if (known.name == name && !known.is_argument && !known.value.empty()) return &known;
    }
    return nullptr;
  };
  if (words.size() > 1) option = named(words[words.size() - 2]);
  if (const std::size_t equals = typed.find('=');
      option == nullptr && typed.starts_with("--") && equals < typed.size()) {
    option = named(typed.substr(0, equals));
    before = typed.substr(0, equals + 1);
    typed.erase(0, equals + 1);
  }
  if (option == nullptr && typed.starts_with("-")) {
    WordList names;
    for (const OptionText& known : command.options) {
      if (!known.is_argument) names.push_back(known.name.substr(known.name.rfind(',') + 1));
    }
    return beginning_with(typed, before, names);
  }
  if (option == nullptr) option = argument_at(command, {words.begin(), words.end() - 1});
  if (option == nullptr) return {};
  if (const std::size_t comma = typed.rfind(','); option->takes_a_list && comma != std::string::npos) {
    before += typed.substr(0, comma + 1);
    typed.erase(0, comma + 1);
  }
  return beginning_with(typed, before, values_of(option->name));
}

/// bash hands over the program's name as it was typed, with the backslashes before blanks and quotes.
constexpr const char* kBash = R"(_hapbench() {
  local IFS=$'\n' program=${1/#\~/$HOME}
  COMPREPLY=($("${program//\\/}" complete "${COMP_WORDS[@]:1:$COMP_CWORD}" 2>/dev/null))
  case ${COMPREPLY[0]-} in *=) compopt -o nospace 2>/dev/null ;; esac
}
complete -o default -F _hapbench hapbench
)";

/// Lets zsh take what is written for bash.
constexpr const char* kZsh = "autoload -U +X bashcompinit && bashcompinit\n";

constexpr const char* kFish = R"(complete -c hapbench -a '(hapbench complete (commandline -opc)[2..] (commandline -ct))'
)";

}  // namespace

WordList completions(const std::vector<CommandText>& texts, const WordList& words) {
  const WordList joined = joined_at_breaks(words);
  const std::string last = words.back() == "=" || words.back() == ":" ? "" : words.back();
  WordList found;
  if (joined.size() == 1) {
    WordList names = {"--help", "--version", "--plugin"};
    for (auto command = texts.begin() + 1; command != texts.end(); ++command) names.push_back(command->name);
    found = beginning_with(joined.back(), "", names);
    if (joined.back().empty()) found.erase(found.begin(), found.begin() + 3);
  } else {
    for (const CommandText& command : texts) {
      if (command.name == joined[0]) found = candidates(command, {joined.begin() + 1, joined.end()});
    }
  }
  const std::size_t kept = joined.back().size() - last.size();
  for (std::string& word : found) word.erase(0, kept);
  return found;
}

void add_completion(CommandLine& line) {
  auto shell = std::make_shared<std::string>();
  Command command = line.command("completion", "Print what lets a shell complete commands, options, names and fields");
  command.add("shell", *shell, "bash, zsh or fish").required().one_of({"bash", "zsh", "fish"});
  command.footer(
      "In ~/.bashrc:\n"
      "  source <(hapbench completion bash)\n"
      "In ~/.zshrc, behind compinit:\n"
      "  source <(hapbench completion zsh)\n"
      "For fish:\n"
      "  hapbench completion fish >~/.config/fish/completions/hapbench.fish");
  command.runs([shell] {
    if (*shell == "zsh") std::fputs(kZsh, stdout);
    std::fputs(*shell == "fish" ? kFish : kBash, stdout);
    return kSuccess;
  });
}

}  // namespace hapbench
