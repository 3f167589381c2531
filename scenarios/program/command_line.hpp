#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

/// The command line: a thin front of CLI11, so that command_line.cpp alone compiles that header, and the help made of
/// what commands declare.
namespace hapbench {

inline constexpr const char* kProgramName = "hapbench";

/// Does the work of the chosen command; returns the exit status.
using Action = std::function<int()>;

/// The command that the user chose.
struct ChosenCommand {
  Action action;
  std::string when_stopped;  ///< what becomes of its results when a signal stops it
};

/// An option, or an argument known by its place.
struct OptionText {
  std::string name;   ///< "--out"; all names, as in "-h,--help"
  std::string value;  ///< the kind of value, as in "TEXT ..."; empty for a flag
  std::string help;   ///< including what it needs and excludes
  bool is_argument;   ///< has no dashes
  bool is_required;
};

/// A command; the program itself is the one that is called "hapbench".
struct CommandText {
  std::string name;
  std::string summary;
  std::string footer;
  std::vector<OptionText> options;
};

/// Throws an InputError that says what to write instead of a word that earlier versions took, such as the command
/// "suite" or the option "--search" of the command "stability", which may have a value as NAME=VALUE. `command` is that
/// of an option; empty for a command.
void refuse_old_word(const std::string& command, const std::string& word);

/// The help of a command, as wide as prose is; that of the program, which is the first of `texts`, lists the others.
std::string help_text(const std::vector<CommandText>& texts, const std::string& command);

/// An option or an argument of a command. All functions return the option itself, for chaining.
class CommandOption {
 public:
  explicit CommandOption(CLI::Option* option) : option_(option) {}

  CommandOption& required();
  /// May be given several times, each time with one value.
  CommandOption& repeatable();
  /// Takes several values in one word, separated by commas; white space around them does not count.
  CommandOption& comma_separated();
  /// Refuses numbers outside [least, greatest].
  CommandOption& range(std::int64_t least, std::int64_t greatest);
  /// Refuses other words.
  CommandOption& one_of(const std::vector<std::string>& words);
  CommandOption& needs(const CommandOption& other);
  CommandOption& excludes(const CommandOption& other);

 private:
  CLI::Option* option_;
};

/// A subcommand that takes its options. The variables bound here are written while the command line is parsed and must
/// live until then.
class Command {
 public:
  /// The variable that an option writes.
  using Variable =
      std::variant<std::string*, std::vector<std::string>*, int*, unsigned*, std::int64_t*, std::uint64_t*, double*>;

  Command(CLI::App* app, ChosenCommand& chosen) : app_(app), chosen_(chosen) {}

  /// A name that begins with "--" is an option, another one an argument known by its place.
  template <class Value>
  CommandOption add(const std::string& name, Value& value, const std::string& help) {
    return add_variable(name, &value, help);
  }
  CommandOption flag(const std::string& name, bool& value, const std::string& help);
  /// Calls `when_given` if the flag is.
  CommandOption flag(const std::string& name, std::function<void()> when_given, const std::string& help);
  /// Text below the list of options: paragraphs, which are wrapped; a line that begins with blanks keeps them.
  void footer(const std::string& text);
  /// Sets the work of the command, and a note on its results for when Ctrl-C stops it.
  void runs(Action action, std::string when_stopped = "incomplete results are removed");

 private:
  CommandOption add_variable(const std::string& name, Variable variable, const std::string& help);

  CLI::App* app_;
  ChosenCommand& chosen_;
};

/// The program's command line: every command adds itself, then `run` parses and runs the one that was chosen.
class CommandLine {
 public:
  /// `version` and `version_json` are what --version prints.
  CommandLine(const std::string& version, std::function<std::string()> version_json);
  ~CommandLine();

  /// Adds a command. One with options of its own also gets them: they live as long as the command line, and `action` is
  /// called with them when the command is chosen (Command::runs).
  Command command(const std::string& name, const std::string& summary);
  template <class Options>
  std::pair<Command, Options&> command(const std::string& name, const std::string& summary,
                                       int (*action)(const Options&),
                                       const std::string& when_stopped = "incomplete results are removed") {
    auto options = std::make_shared<Options>();
    Command command = this->command(name, summary);
    command.runs([options, action] { return action(*options); }, when_stopped);
    return {command, *options};
  }
  /// Adds a command whose words behind its name, options and --help included, all go to `action` as they are.
  void pass_on(const std::string& name, const std::string& summary,
               std::function<int(const std::vector<std::string>&)> action);
  /// Replaces a study by its words (study.hpp), loads the plugins that the words and HAPBENCH_PLUGIN_PATH name, then
  /// runs the command. Returns its exit status; for a success during which a law or a source of contacts from outside
  /// failed, kUnexpectedOutcome. Throws what the command throws, and InputError for a wrong usage and for plugins.
  int run(int argc, char** argv);
  /// The chosen command's note on its results for when it is stopped.
  const std::string& when_stopped() const { return chosen_.when_stopped; }

 private:
  /// The program's own options and notes, then every command with its own, in the order in which they were added.
  std::vector<CommandText> texts() const;
  void add_common_options(CLI::App& app);
  int run(std::vector<std::string> words);

  std::unique_ptr<CLI::App> app_;
  ChosenCommand chosen_;
  std::vector<std::string> plugins_;
  std::map<std::string, std::function<int(const std::vector<std::string>&)>> passed_on_;
};

}  // namespace hapbench
