#pragma once

#include <string>
#include <vector>

/// What there is to say of commands and options, and the texts made of it: help, manual page, completions.
namespace hapbench {

/// An option, or an argument known by its place.
struct OptionText {
  std::string name;   ///< "--out"; all names, as in "-h,--help"
  std::string value;  ///< what kind of value it takes, as in "TEXT ..."; empty for a flag
  std::string help;   ///< with what it needs and excludes
  bool is_argument;   ///< has no dashes
  bool is_required;
  bool takes_a_list;  ///< several values in a word, separated by commas
};

/// A command; the program itself is the one that is called "hapbench".
struct CommandText {
  std::string name;
  std::string summary;
  std::string footer;
  std::vector<OptionText> options;
};

inline constexpr const char* kProgramName = "hapbench";

/// The help of a command, as wide as prose is; that of the program, which is the first of `texts`, lists the others.
std::string help_text(const std::vector<CommandText>& texts, const std::string& command);

/// The manual page of the program with all its commands, in the language of man(7). `version` stands below it.
std::string manual_page(const std::vector<CommandText>& texts, const std::string& version);

/// The words that can stand in place of the last of `words`, which are those of a command line behind the program's
/// name up to the cursor; the last may be empty. Words that a shell broke at "=" and ":", as bash does, count as one,
/// and the answer is the part behind the break. None where a file name is wanted, or nothing is known.
std::vector<std::string> completions(const std::vector<CommandText>& texts, const std::vector<std::string>& words);

}  // namespace hapbench
