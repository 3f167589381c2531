#include "scenarios/program/old_words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/text_lines.hpp"

namespace hapbench {

namespace {

struct OldWords {
  std::string_view command;  ///< of options; empty for commands, "*" for options of every command
  std::string_view words;    ///< separated by blanks
  std::string_view instead;
};

/// The words that left in 0.4, by command. Words of earlier versions are unknown.
constexpr std::array<OldWords, 0> kOldWords{};

}  // namespace

void refuse_old_word(const std::string& command, const std::string& word) {
  const std::string name = word.substr(0, word.find('='));
  for (const OldWords& old : kOldWords) {
    const Words words = words_of(old.words);
    if (std::ranges::find(words, name) == words.end() || (old.command != command && old.command != "*")) continue;
    throw InputError(fmt::format("{}\"{}\" is no longer known; instead: {}", command.empty() ? "" : command + ": ",
                                 name, old.instead));
  }
}

}  // namespace hapbench
