#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "scenarios/format/input_error.hpp"

namespace CLI {
class App;
class Option;
}  // namespace CLI

/// The command line: a thin front of CLI11, so that command_line.cpp alone compiles that header.
namespace hapbench {

/// --quiet, --json and --wide, options of every command.
struct OutputOptions {
  bool quiet = false;  ///< nothing on standard output, no progress bar
  bool json = false;   ///< JSON instead of tables on standard output
};

/// The command that the user chose.
struct ChosenCommand {
  std::function<int()> action;  ///< does its work; returns the exit status
  std::string when_stopped;     ///< what becomes of its results when a signal stops it
};

/// A command in the program's help, and what its own help ends with.
struct CommandGuide {
  std::string_view group, name;
  std::string_view answers;                  ///< the question that it answers
  std::array<std::string_view, 3> examples;  ///< its words behind the program's name; of a command in Python empty
};

/// An option that means the same in every command that has it; `hapbench --help` explains it.
std::string shared_option_help(const std::string& name);

/// Throws an InputError that says what to write instead of a word that earlier versions took, such as the command
/// "suite" or the option "--search" of the command "stability", which may have a value as NAME=VALUE. `command` is that
/// of an option; empty for a command.
void refuse_old_word(const std::string& command, const std::string& word);

/// How an option or an argument may be given; its variable says of what kind the value is.
struct Takes {
  bool required = false;
  bool several = false;          ///< it may be given several times, each time with one value
  bool comma_separated = false;  ///< several values in one word; white space around them does not count
  std::optional<std::pair<std::int64_t, std::int64_t>> range = {};  ///< refuses numbers outside
  std::vector<std::string> one_of = {};                             ///< refuses other words
};

/// A subcommand that takes its options. The variables bound here are written while the command line is parsed and must
/// live until then.
class Command {
 public:
  /// The variable that an option writes.
  using Variable =
      std::variant<std::string*, std::vector<std::string>*, int*, unsigned*, std::int64_t*, std::uint64_t*, double*>;

  explicit Command(CLI::App* app) : app_(app) {}

  /// A name that begins with "--" is an option, another one an argument known by its place.
  template <class Value>
  void add(const std::string& name, Value& value, const std::string& help, const Takes& takes = {}) {
    add_variable(name, &value, help, takes);
  }
  void flag(const std::string& name, bool& value, const std::string& help);
  /// Calls `when_given` if the flag is.
  void flag(const std::string& name, std::function<void()> when_given, const std::string& help);
  /// Refuses an option without another one, of which it has one at most. Precondition: both were added.
  void needs(const std::string& option, const std::string& other);
  /// Text below the list of options: paragraphs, which are wrapped.
  void footer(const std::string& text);

 private:
  void add_variable(const std::string& name, Variable variable, const std::string& help, const Takes& takes);

  CLI::App* app_;
};

/// The error with what was typed as the place of each fault in a field that --set gave, and not the scene's file.
InputError with_typed_places(const InputError& error, const std::vector<std::string>& overrides);

/// The program's command line: every command adds itself, then `run` parses and runs the one that was chosen.
class CommandLine {
 public:
  /// `version` and `version_json` are what --version prints.
  CommandLine(std::vector<CommandGuide> guides, const std::string& version, std::function<std::string()> version_json);
  ~CommandLine();

  /// Adds a command and the options that `action` is called with when it is chosen; they live as long as the command
  /// line, and their `output` is what its last options write. `when_stopped`: a note on its results for when Ctrl-C
  /// stops it.
  template <class Options>
  std::pair<Command, Options&> command(const std::string& name, const std::string& summary,
                                       int (*action)(const Options&),
                                       const std::string& when_stopped = "incomplete results are removed") {
    auto options = std::make_shared<Options>();
    const auto run = [options, action] {
      try {
        return action(*options);
      } catch (const InputError& error) {
        if constexpr (requires { options->overrides; }) throw with_typed_places(error, options->overrides);
        throw;
      }
    };
    const Command command = add(name, summary, {run, when_stopped});
    outputs_.emplace_back(command, &options->output);
    return {command, *options};
  }
  /// Adds a command whose words behind its name, options and --help included, all go to `action` as they are.
  void pass_on(const std::string& name, std::function<int(const std::vector<std::string>&)> action);
  /// Replaces a study by its words (study.hpp), loads the modules that the words and HAPBENCH_MODULE_PATH name, then
  /// runs the command. Returns its exit status; for a success during which a law or a source of contacts from outside
  /// failed, kUnexpectedOutcome. Throws what the command throws, and InputError for a wrong usage and for modules.
  int run(int argc, char** argv);
  /// The chosen command's note on its results for when it is stopped.
  const std::string& when_stopped() const { return chosen_.when_stopped; }

 private:
  std::string front() const;
  std::string program_help() const;
  std::string examples_of(const std::string& command) const;
  Command add(const std::string& name, const std::string& summary, ChosenCommand command);
  void add_module_option(CLI::App& app);
  int run(std::vector<std::string> words);

  std::vector<CommandGuide> guides_;
  std::unique_ptr<CLI::App> app_;
  ChosenCommand chosen_;
  std::vector<std::pair<Command, OutputOptions*>> outputs_;
  std::vector<std::string> modules_;
  std::map<std::string, std::function<int(const std::vector<std::string>&)>> passed_on_;
};

}  // namespace hapbench
