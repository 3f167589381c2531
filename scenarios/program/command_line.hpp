#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "scenarios/program/command_text.hpp"

namespace CLI {
class App;
class Option;
}  // namespace CLI

/// The command line. A thin front of CLI11, so that command_line.cpp alone compiles that header.
namespace hapbench {

/// What the chosen command does; returns the exit status.
using Action = std::function<int()>;

/// The command that the words of the command line name.
struct ChosenCommand {
  Action action;
  std::string when_stopped;  ///< what becomes of its results when a signal stops it
};

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
  CommandOption& range(int least, int greatest);
  CommandOption& range(std::uint64_t least, std::uint64_t greatest);
  /// Refuses other words.
  CommandOption& one_of(const std::vector<std::string>& words);
  /// May be given without a value, which then is this.
  CommandOption& value_if_none(const std::string& value);
  CommandOption& needs(const CommandOption& other);
  CommandOption& excludes(const CommandOption& other);

 private:
  CLI::Option* option_;
};

/// A subcommand that takes its options. The variables bound here are written while the command line is parsed and must
/// live until then.
class Command {
 public:
  Command(CLI::App* app, ChosenCommand& chosen) : app_(app), chosen_(chosen) {}

  /// A name that begins with "--" is an option, another one an argument known by its place.
  CommandOption add(const std::string& name, std::string& value, const std::string& help);
  CommandOption add(const std::string& name, std::vector<std::string>& value, const std::string& help);
  CommandOption add(const std::string& name, int& value, const std::string& help);
  CommandOption add(const std::string& name, std::int64_t& value, const std::string& help);
  CommandOption add(const std::string& name, unsigned& value, const std::string& help);
  CommandOption add(const std::string& name, double& value, const std::string& help);
  CommandOption add(const std::string& name, std::uint64_t& value, const std::string& help);
  CommandOption flag(const std::string& name, bool& value, const std::string& help);
  /// Calls `when_given` if the flag is.
  CommandOption flag(const std::string& name, std::function<void()> when_given, const std::string& help);
  /// Text below the list of options: paragraphs, which are wrapped; a line that begins with blanks keeps them.
  void footer(const std::string& text);
  /// What the command does when it is chosen, and what becomes of its results when Ctrl-C stops it.
  void runs(Action action, std::string when_stopped = "what was not complete is removed");

 private:
  CLI::App* app_;
  ChosenCommand& chosen_;
};

/// The program's command line: every command adds itself, then `run` parses and runs the one that was chosen.
class CommandLine {
 public:
  /// `version` and `version_json` are what --version prints.
  CommandLine(const std::string& version, std::function<std::string()> version_json);
  ~CommandLine();

  Command command(const std::string& name, const std::string& summary);
  /// Loads the plugins that the words and HAPBENCH_PLUGIN_PATH name, then runs the command. Returns its exit status; for
  /// a success during which the law of a plugin failed, kUnexpectedOutcome. Throws what the command throws, and
  /// InputError for a wrong usage and for plugins.
  int run(int argc, char** argv);
  /// What the chosen command says of its results when it is stopped.
  const std::string& when_stopped() const { return chosen_.when_stopped; }
  /// The program's own options and notes, then every command with its own, in the order in which they were added.
  std::vector<CommandText> texts() const;

 private:
  void add_plugin_option(CLI::App& app);

  std::unique_ptr<CLI::App> app_;
  ChosenCommand chosen_;
  std::vector<std::string> plugins_;
};

}  // namespace hapbench
