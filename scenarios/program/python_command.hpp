#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "scenarios/program/command.hpp"
#include "scenarios/program/table.hpp"

namespace hapbench {

/// The options of a command whose work a Python package does: those that are given reach it as NAME=VALUE, several
/// times for a list. Names are without "--".
struct PythonOptions {
  std::map<std::string, std::string> words;
  std::map<std::string, std::vector<std::string>> lists;
  std::map<std::string, double> numbers;  ///< negative: not given
  std::map<std::string, bool> flags;
  OutputOptions output;

  CommandOption list(Command& command, const std::string& name, const std::string& help);
  CommandOption word(Command& command, const std::string& name, const std::string& help);
  CommandOption number(Command& command, const std::string& name, const std::string& help, double otherwise = -1.0);
  CommandOption flag(Command& command, const std::string& name, const std::string& help);

  /// Runs the package, `doing` what the user is told meanwhile, with the words `more` besides those given. Returns its
  /// reply; nothing where it ended without one, after its reason was printed. Throws the faults that it reports,
  /// IoError with the file `out` among them.
  std::optional<Json> reply(const char* package, const char* doing, const std::filesystem::path& out,
                            const std::vector<std::string>& more) const;
  /// Prints the warnings of the reply's JSON, the file that the package made, its table and the `next` command, which
  /// the JSON gets, too.
  void print_made(Json& json, const std::filesystem::path& out, const Table& table, const std::string& next) const;
};

}  // namespace hapbench
