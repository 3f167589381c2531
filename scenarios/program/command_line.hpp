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
#include "scenarios/program/program_context.hpp"
#include "scenarios/program/program_words.hpp"
#include "scenarios/program/typed_places.hpp"

namespace hapbench {

/// The program's command line, to which every command adds itself; `run` parses and runs the one that was chosen.
class CommandLine {
 public:
  /// The context must outlive the command line.
  explicit CommandLine(ProgramContext& context);

  /// Adds a command and the options that `action` is called with when it is chosen; they live as long as the command
  /// line, and their `output` is what its last options write. `when_stopped`: a note on its results after Ctrl-C.
  template <class Options>
  std::pair<Command, Options&> command(const std::string& name, const std::string& summary,
                                       int (*action)(const Options&, ProgramContext&),
                                       const std::string& when_stopped = "incomplete results are removed") {
    auto options = std::make_shared<Options>();
    const auto run = [options, action, &context = context_] {
      try {
        return action(*options, context);
      } catch (const InputError& error) {
        if constexpr (requires { options->overrides; }) throw with_typed_places(error, options->overrides);
        throw;
      }
    };
    return {add(name, summary, options->output, run, when_stopped), *options};
  }
  /// Replaces a study by its words, loads the modules that the words and HAPBENCH_MODULE_PATH name, then runs the
  /// command. Returns its exit status; for a success during which a law from outside failed, kUnexpectedOutcome. Throws
  /// what the command throws, and InputError for a wrong usage and for modules.
  int run(const ProgramWords& words);
  const std::string& when_stopped() const { return when_stopped_; }

 private:
  Command add(const std::string& name, const std::string& summary, OutputOptions& output, std::function<int()> action,
              const std::string& when_stopped);
  void add_module_option(CLI::App& app);
  /// The places of the words that are arguments of the command words[0]: neither options nor values of its options. A
  /// word behind an unknown option may be its value and is left out. None without a command.
  std::vector<std::size_t> argument_places(const ProgramWords& words) const;
  int parse_and_run(ProgramWords words);

  ProgramContext& context_;
  std::shared_ptr<CLI::App> app_;
  std::function<int()> action_;  ///< of the chosen command
  std::string when_stopped_;
  std::vector<std::pair<CLI::App*, OutputOptions*>> outputs_;
  std::vector<std::string> modules_;
};

}  // namespace hapbench
