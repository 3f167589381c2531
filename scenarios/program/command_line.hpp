#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "scenarios/input/input_error.hpp"
#include "scenarios/program/command.hpp"
#include "scenarios/program/options.hpp"
#include "scenarios/program/override_locations.hpp"
#include "scenarios/program/program_arguments.hpp"
#include "scenarios/program/program_context.hpp"

namespace hapbench {

/// The parser of the program's command line. Every command adds itself to the parser; run() parses the arguments and
/// runs the selected command.
class CommandLine {
 public:
  /// Adds all commands. Precondition: the context outlives the command line.
  explicit CommandLine(ProgramContext& context);

  /// Adds a command. Returns the command, for adding its options, and the option values, which live as long as
  /// the command line. `action` is called with these values if the user selects the command. Options::output
  /// receives --quiet and --json. `when_stopped` is the note on the results that the program prints after Ctrl-C.
  template <class Options>
  std::pair<Command, Options&> command(const std::string& name, const std::string& summary,
                                       int (*action)(const Options&, ProgramContext&),
                                       const std::string& when_stopped = "incomplete results are removed") {
    auto options = std::make_shared<Options>();
    const auto run = [options, action, &context = context_] {
      try {
        return action(*options, context);
      } catch (const InputError& error) {
        if constexpr (requires { options->overrides; }) throw with_override_locations(error, options->overrides);
        throw;
      }
    };
    return {add(name, summary, options->output, run, when_stopped), *options};
  }
  /// Runs a command line. Replaces the name of a study by the scenarios and options of the study, loads the modules
  /// that --module and HAPBENCH_MODULE_PATH name, and runs the command. Returns the exit status of the command, but
  /// kUnexpectedOutcome if the command succeeded while a loaded module failed. Throws InputError for wrong
  /// usage and for modules that cannot be loaded, and every exception of the command.
  int run(const ProgramArguments& arguments);
  const std::string& when_stopped() const { return when_stopped_; }

 private:
  Command add(const std::string& name, const std::string& summary, OutputOptions& output, std::function<int()> action,
              const std::string& when_stopped);
  void add_module_option(CLI::App& app);
  /// Returns the indices of the positional arguments in `arguments`, whose first element is the name of a command.
  /// Positional arguments are neither options nor values of options. Omits an argument that follows an unknown option,
  /// because it may be the value of this option. If the first element is not the name of a command, returns no indices.
  std::vector<std::size_t> argument_indices(const ProgramArguments& arguments) const;
  int parse_and_run(ProgramArguments arguments);

  ProgramContext& context_;
  std::shared_ptr<CLI::App> app_;
  std::function<int()> action_;  ///< action of the selected command
  std::string when_stopped_;
  std::vector<std::pair<CLI::App*, OutputOptions*>> outputs_;
  std::vector<std::string> modules_;
  bool allow_modules_ = false;
};

}  // namespace hapbench
