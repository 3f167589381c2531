#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "algorithms/registry.hpp"
#include "scenarios/batch/jobs.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/input/nearest_name.hpp"
#include "scenarios/scene/load_scenario.hpp"

namespace CLI {  // NOLINT(readability-identifier-naming): of CLI11
class App;
}

/// Shared by all commands: exit status, the command line, studies, common options, output and names. The command line
/// is a thin front of CLI11, so that command_line.cpp alone compiles that header.
namespace hapbench {

/// Exit status of the program.
enum ExitStatus : int {
  kSuccess = 0,
  kInternalFault = 1,
  kBadInput = 2,
  kUnexpectedOutcome = 3,  ///< a simulation diverged, or missed another expectation of its scenario
  kStopped = 128,          ///< plus the number of the signal, as shells do: 130 for Ctrl-C, 143 for SIGTERM
};

using ProgramWords = std::vector<std::string>;

/// Runs the command of the words behind the program's name and returns the exit status. Says on standard error when a
/// signal (stop_signal.hpp) stopped the work. Throws InputError, also for words that are no command, and IoError.
int run_program(const ProgramWords& words);

/// Does the same, but reports exceptions on standard error: exit status 2 for InputError, 1 for all others.
int run_program_to_exit(const ProgramWords& words);

// ---- The command line

/// --quiet, --json and --wide, options of every command.
struct OutputOptions {
  bool quiet = false;  ///< nothing on standard output, no progress bar
  bool json = false;   ///< JSON instead of tables on standard output
};

/// An option that means the same in every command that has it; `hapbench --help` explains it.
std::string shared_option_help(const std::string& name);

/// Throws an InputError that says what to write instead of a word that earlier versions took: of a command, or with
/// `command` of one of its options, which may have a value as NAME=VALUE.
void refuse_old_word(const std::string& command, const std::string& word);

/// How an option or an argument may be given; its variable says of what kind the value is.
struct Takes {
  bool required = false;
  bool several = false;          ///< it may be given several times, each time with one value
  bool comma_separated = false;  ///< several values in one word; white space around them does not count
  std::optional<std::pair<std::int64_t, std::int64_t>> range = {};  ///< refuses numbers outside
  std::vector<std::string> one_of = {};                             ///< refuses other words
};

/// A subcommand that takes its options. The variables bound here are written, and must live, until the line is parsed.
class Command {
 public:
  template <class... Values>
  using OneOf = std::variant<std::reference_wrapper<Values>...>;
  using Variable = OneOf<std::string, std::vector<std::string>, int, unsigned, std::int64_t, std::uint64_t, double>;

  explicit Command(CLI::App* app) : app_(app) {}

  /// A name that begins with "--" is an option, another one an argument known by its place.
  void add(const std::string& name, Variable variable, const std::string& help, const Takes& takes = {});
  void flag(const std::string& name, bool& value, const std::string& help);
  /// Refuses an option without another one, of which it has one at most. Precondition: both were added.
  void needs(const std::string& option, const std::string& other);
  /// Text below the list of options: paragraphs, which are wrapped.
  void footer(const std::string& text);

 private:
  CLI::App* app_;
};

/// The error with what was typed as the place of each fault in a field that --set gave, and not the scene's file.
InputError with_typed_places(const InputError& error, const std::vector<std::string>& overrides);

/// The program's command line, to which every command adds itself; `run` parses and runs the one that was chosen.
class CommandLine {
 public:
  CommandLine();

  /// Adds a command and the options that `action` is called with when it is chosen; they live as long as the command
  /// line, and their `output` is what its last options write. `when_stopped`: a note on its results after Ctrl-C.
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
  int parse_and_run(ProgramWords words);

  std::shared_ptr<CLI::App> app_;
  std::function<int()> action_;  ///< of the chosen command
  std::string when_stopped_;
  std::vector<std::pair<CLI::App*, OutputOptions*>> outputs_;
  std::vector<std::string> modules_;
};

// ---- Studies: questions as files. A study names a command, scenarios, and the command's options, and a command takes
// it in place of scenarios.
//
//   {"ask": "limit", "scenarios": ["wall_on_handle"], "summary": "K over B of a wall on an impedance device",
//    "between": [1e2, 1e5], "stable": "bounded",
//    "over": {"rendering.damping_N_s_per_m": {"from": 0.1, "to": 150, "count": 17, "log": true}}}
//
// Numbers, texts and true stand for themselves; two numbers of "between" for a range; a list for values separated by
// commas ("bound": for one option each); objects of "set", "over" and "vary" for fields by their paths, with a value, a
// list or a range with "from", "to", "count" and "log". A scenario that is a file is looked for next to the study
// first. "alone" is for scripts/reproduce: nothing runs at the same time as what is about time.

struct BundledStudy {
  std::string name, ask, summary;
  std::filesystem::path file;
};
/// All of them, by name.
std::vector<BundledStudy> bundled_studies();

/// The words of a command line in which a study stood, and where in its file they come from.
struct StudyWords {
  /// Replaces the first study behind the command by its scenarios and options; options that are given besides go before
  /// those of the study. `words`: without the program's name. Throws InputError for a study of another command.
  static std::optional<StudyWords> in(const ProgramWords& words);

  /// The error, about the line of the study that has the option which it names, if it names one.
  InputError located(const InputError& error) const;

  std::filesystem::path file;
  ProgramWords words;
  std::map<std::string, std::size_t> lines;  ///< of options, as "--over"
};

// ---- Options, output and names

/// Options that most commands have.
struct CommonOptions {
  std::vector<std::string> overrides;
  unsigned jobs = 0;  ///< 0: as many as this process may use
  std::string out;
  OutputOptions output;
};

// Each adds an option, add_common all three of CommonOptions.
inline void add_overrides(Command& command, std::vector<std::string>& overrides) {
  command.add("--set", overrides, shared_option_help("--set"), {.several = true});
}
inline void add_jobs(Command& command, unsigned& jobs) {
  command.add("--jobs", jobs, shared_option_help("--jobs"), {.range = {{1, 1024}}});
}
/// `name`: of the folder below results/out without the option.
inline void add_out(Command& command, std::string& out, const std::string& name) {
  command.add("--out", out, "directory of the results (default: results/out/" + name + ")");
}
/// `otherwise`: those without the option.
inline void add_algorithms(Command& command, std::vector<std::string>& algorithms, const std::string& otherwise) {
  command.add("--algorithms", algorithms, "names separated by commas, or all (default: " + otherwise + ")",
              {.comma_separated = true});
}
inline void add_common(Command& command, CommonOptions& options, const std::string& name) {
  add_jobs(command, options.jobs);
  add_out(command, options.out, name);
  add_overrides(command, options.overrides);
}

/// Prints `text`, as wide as the output is, or `json` under --json, or nothing under --quiet.
void print(const OutputOptions& options, const std::string& text, const Json& json);
/// Prints warnings, one line each, on standard error.
void print_warnings(const std::vector<std::string>& warnings);
/// Prints those about a scenario, given values first, then files, with the file of each in front.
void print_warnings(const LoadedScenario& loaded);
/// Prints "hapbench: TEXT" on standard error.
void print_note(std::string_view text);
/// Prints "hapbench: error: TEXT" on standard error.
void print_error(std::string_view text);
/// Prints each fault of bad input as an error.
void print_errors(const InputError& error);

/// The first texts, and behind them how many more there are.
inline std::vector<std::string> first_few(std::vector<std::string> texts, std::size_t most) {
  if (texts.size() <= most) return texts;
  const std::string rest = std::to_string(texts.size() - most) + " more like these";
  texts.resize(most);
  texts.push_back(rest);
  return texts;
}

/// The output of a command.
struct CapturedOutput {
  std::string text;                           ///< of standard output
  std::vector<std::string> warnings, errors;  ///< notes are among the warnings
};

/// The object that collects what the commands of this thread print, for a host that is not a terminal; null: none does.
CapturedOutput*& captured_output() noexcept;

/// Draws the run in a folder into FILE.svg. Throws IoError, after the Python tool has said why on standard error.
void write_way(const std::filesystem::path& folder, const std::filesystem::path& file, bool quiet);

/// Throws InputError unless each name is among the valid ones and given once; `got` stands before the name in its
/// message, as in "--only: got". `shown_by`: a command that shows the valid ones, see quoted_list.
inline void require_names(std::string_view got, const std::vector<std::string>& names,
                          const std::vector<std::string>& valid, std::string_view shown_by = {}) {
  std::set<std::string> seen;
  for (const std::string& name : names) {
    require_valid_name(got, name, valid, shown_by);
    if (!seen.insert(name).second) throw InputError(fmt::format("{} \"{}\" twice; allowed: once", got, name));
  }
}
/// Checks the same way and returns the names, where "all" alone stands for all of them.
inline std::vector<std::string> chosen_names(std::string_view got, const std::vector<std::string>& given,
                                             const std::vector<std::string>& all, std::string_view shown_by = {}) {
  if (given == std::vector<std::string>{"all"}) return all;
  if (std::find(given.begin(), given.end(), "all") != given.end())
    throw InputError(fmt::format("{} \"all\" together with other names; allowed: \"all\" alone", got));
  std::vector<std::string> valid = all;
  valid.insert(valid.begin(), "all");
  require_names(got, given, valid, shown_by);
  return given;
}

/// The algorithms of --algorithms.
inline std::vector<std::string> chosen_algorithms(const std::vector<std::string>& given) {
  return chosen_names("--algorithms: got", given, algorithm_names(), "hapbench describe algorithms");
}

/// The metric to show: the one asked for, else the first of kDefaultMetrics. Throws InputError when it is not there.
std::string chosen_metric(const std::vector<std::string>& metrics, const std::string& asked_for);

/// `out`, or results/out/`name` when it is empty.
inline std::filesystem::path results_directory(const std::string& out, const std::string& name) {
  return out.empty() ? std::filesystem::path("results") / "out" / name : std::filesystem::path(out);
}

/// Throws InputError, which names the option, unless results can be written to `directory`. Creates it, and removes it
/// again if it is still empty when the program ends.
void require_writable_directory(const std::filesystem::path& directory, std::string_view option = "--out");
/// The threads of --jobs, and a progress bar behind `label` unless quiet.
inline JobOptions job_options(const CommonOptions& options, const std::string& label) {
  return {options.jobs == 0 ? static_cast<unsigned>(available_threads()) : options.jobs,
          options.output.quiet ? "" : label};
}

/// Quotes words for a POSIX shell: those with anything but letters, digits and "_-./:=,+@%" in single quotes.
std::string shell_line(const ProgramWords& words);

/// The file of this program; a host that is another program sets it.
std::filesystem::path& this_program();

}  // namespace hapbench
