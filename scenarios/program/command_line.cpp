#include "scenarios/program/command_line.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

#include "algorithms/module/module.hpp"
#include "scenarios/description/writer.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/program/command.hpp"
#include "scenarios/program/study.hpp"
#include "scenarios/program/table.hpp"
#include "scenarios/run/load_module.hpp"

namespace hapbench {

namespace {

constexpr const char* kProgramName = "hapbench";

struct OldWords {
  std::string_view command;  ///< of options; empty for commands, "*" for options of every command
  std::string_view words;    ///< separated by blanks
  std::string_view instead;
};

/// By command, so that what one command lost stands together.
constexpr OldWords kOldWords[] = {
    {"*", "--memory", "ulimit -d KILOBYTES before the command; without it three quarters of what is free"},
    {"*", "--plugin", "--module FILE.so, of commands that run laws"},
    {"", "complete completion", "scripts/completion, which prints a completion for bash"},
    {"", "diff", "hapbench report A B --tolerance 0, which says what differs, with status 3"},
    {"", "explain",
     "hapbench run SCENE, which prints what is wrong and writes it to summary.json; hapbench describe diagnosis lists the rules"},
    {"", "identify", "hapbench import device LOG"},
    {"", "list", "hapbench describe, of a kind hapbench describe KIND; --grep TEXT searches"},
    {"", "man", "hapbench --help, and --help of each command"},
    {"", "merge", "hapbench sweep FOLDER, which joins the tables of the shards in it"},
    {"", "precision",
     "hapbench_accuracy, the benchmark of run time against error (tests/README.md), whose picture scripts/reproduce draws; "
     "hapbench converge SCENE --metric NAME"},
    {"", "shell", "hapbench validate SCENE --points FILE.csv"},
    {"", "stability",
     "hapbench limit spring_stiffness, spring_damping or spring_time_step; for --map other studies (hapbench describe studies), "
     "for --stress hapbench stress, for --search hapbench sweep SCENE --sample lhs:400 --vary hand.x_N=-5:5"},
    {"", "suite", "hapbench compare GROUP --algorithms all --seeds 5"},
    {"compare", "--check --sure", "hapbench compare SCENE --errors, of one number hapbench converge SCENE"},
    {"compare", "--devices --friction --resolution --vibration",
     "hapbench limit tap_wall tap_corner tap_hole --device all"},
    {"compare", "--html", "hapbench report FOLDER, of the comparison's folder"},
    {"compare", "--no-skip", "hapbench run SCENE --no-skip"},
    {"converge", "--resume", "the same without it: the runs are made again"},
    {"new", "--scale", "--extent SIZE, the longest edge of the mesh's box: 12mm, 1.2cm, 0.012m, 0.5in"},
    {"plot", "--no-sketch", "the same without it: plot draws no sketches"},
    {"reproduce", "--robustness",
     "hapbench reproduce --choices results/reference/readings.csv, or of scripts/readings.py 256"},
    {"reproduce", "--subjects",
     "their record, in the manual of the thesis's claims (scenarios/thesis_claims/README.md)"},
    {"run", "--sure", "hapbench converge SCENE, of the points with --vary environment.spacing_m"},
    {"sweep", "--cpus --dry-run --partition --slurm --time",
     "sbatch --array=0-99 scripts/sweep.sbatch SCENE --vary ... --out FOLDER"},
    {"sweep", "--status", "squeue, and the tables sweep.I_of_N.csv that are in the folder"},
};

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

void Command::add_variable(const std::string& name, Variable variable, const std::string& help, const Takes& takes) {
  CLI::Option* option = std::visit([&](auto* value) { return app_->add_option(name, *value, help); }, variable);
  option->required(takes.required);
  if (takes.several) option->allow_extra_args(false)->take_all();
  if (takes.comma_separated)
    option->delimiter(',')->transform([](const std::string& word) { return CLI::detail::trim_copy(word); });
  // CLI11's own checks word the errors differently, and show in the help.
  if (takes.range) {
    const auto problem = [range = *takes.range](const std::string& word) -> std::string {
      const auto [least, greatest] = range;
      std::int64_t number = 0;
      if (CLI::detail::lexical_cast(word, number) && number >= least && number <= greatest) return "";
      return fmt::format("got {}; allowed: {} ... {}", word, least, greatest);
    };
    option->check(CLI::Validator(problem, ""));
  }
  if (!takes.one_of.empty()) {
    const auto problem = [words = takes.one_of](const std::string& word) -> std::string {
      if (std::ranges::find(words, word) != words.end()) return "";
      return fmt::format("got \"{}\"; allowed: {}{}", word, quoted_list(words), nearest_name_hint(word, words));
    };
    option->check(CLI::Validator(problem, ""));
  }
}

void Command::flag(const std::string& name, bool& value, const std::string& help) {
  app_->add_flag(name, value, help);
}

void Command::flag(const std::string& name, std::function<void()> when_given, const std::string& help) {
  app_->add_flag_callback(name, std::move(when_given), help);
}

void Command::needs(const std::string& option, const std::string& other) {
  app_->get_option(option)->needs(app_->get_option(other));
}

void Command::footer(const std::string& text) {
  app_->footer(text);
}

CommandLine::CommandLine(const std::string& version, std::function<std::string()> version_json)
    : app_(std::make_unique<CLI::App>("an offline bench for haptic rendering", kProgramName)) {
  CLI::Option* json = app_->add_flag("--json");
  json->description("commit, compiler, instruction set and what the version promises");
  json->needs(app_->set_version_flag("--version", [=, version_json = std::move(version_json)] {
    return json->count() > 0 ? version_json() : version;
  }));
  app_->get_option("--version")->description("print the version; with --json also what it was built from");
  app_->get_option("--help")->description("print this help; with a command, that command's help");
  add_common_options(*app_);
  app_->require_subcommand(1);
  app_->footer(
      "Exit status: 0 success, 1 internal fault, 2 bad input or usage, 3 a run did not end as its scenario expects, "
      "130 stopped by Ctrl-C.");
}

CommandLine::~CommandLine() = default;

/// The program and each command have these options, so that they may stand before or behind the command.
void CommandLine::add_common_options(CLI::App& app) {
  const auto add = [this](const std::vector<std::string>& files) {
    modules_.insert(modules_.end(), files.begin(), files.end());
  };
  app.add_option_function<std::vector<std::string>>(
         "--module", add,
         "load FILE.so, which holds a force law of your own; HAPBENCH_MODULE_PATH names folders of such files")
      ->allow_extra_args(false)
      ->take_all();
}

Command CommandLine::add(const std::string& name, const std::string& summary, ChosenCommand command) {
  CLI::App* app = app_->add_subcommand(name, summary);
  app->get_option("--help")->description("print this help");
  app->callback([this, command = std::move(command)] { chosen_ = command; });
  add_common_options(*app);
  return Command(app);
}

void CommandLine::pass_on(const std::string& name, const std::string& summary,
                          std::function<int(const std::vector<std::string>&)> action) {
  app_->add_subcommand(name, summary);
  passed_on_[name] = std::move(action);
}

namespace {

std::string name_of(const CLI::Option& option) {
  return option.get_name(option.get_positional(), true);
}

/// The kind of value, as in "TEXT ..."; empty for a flag.
std::string kind_of_value(const CLI::Option& option) {
  if (option.get_type_size() == 0 || option.get_type_name().empty()) return "";
  std::string kind = option.get_type_name();
  if (option.get_expected_min() == 0) kind = "[" + kind + "]";
  if (option.get_expected_max() == CLI::detail::expected_max_vector_size)
    kind += option.get_delimiter() == ',' ? ",..." : " ...";
  return kind;
}

std::string usage(const CLI::App& app) {
  std::string words = app.get_parent() == nullptr ? fmt::format("{} [OPTIONS] COMMAND", kProgramName)
                                                  : fmt::format("{} {} [OPTIONS]", kProgramName, app.get_name());
  for (const CLI::Option* option : app.get_options()) {
    if (!option->get_positional()) continue;
    const std::string name = name_of(*option) + (kind_of_value(*option).ends_with("...") ? "..." : "");
    words += option->get_required() ? " " + name : " [" + name + "]";
  }
  return "Usage: " + words + "\n";
}

std::string options_text(const CLI::App& app, bool arguments) {
  std::string text;
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_positional() != arguments) continue;
    std::string name = name_of(*option), help = option->get_description();
    if (const std::string kind = kind_of_value(*option); !arguments && !kind.empty()) name += " " + kind;
    for (const CLI::Option* other : option->get_needs()) help += "; with " + other->get_name();
    if (option->get_required() && !arguments) help += "; required";
    text += entry(name, help);
  }
  return text.empty() ? "" : fmt::format("\n{}\n{}", bold(stdout, arguments ? "Arguments:" : "Options:"), text);
}

/// The help of a command, as wide as prose is; that of the program lists the others.
std::string help_text(const CLI::App& app) {
  const bool is_program = app.get_parent() == nullptr;
  std::string text = wrapped((is_program ? std::string(kProgramName) + ": " : "") + app.get_description(), 0);
  text += usage(app) + options_text(app, true) + options_text(app, false);
  if (is_program) {
    text += "\n" + bold(stdout, "Commands:") + "\n";
    for (const CLI::App* command : app.get_subcommands({}))
      text += entry(command->get_name(), command->get_description(), 2, 16);
  }
  return app.get_footer().empty() ? text : text + "\n" + wrapped(app.get_footer(), 0);
}

std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

std::vector<std::string> command_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
  return names;
}

/// Tells a user who wrote a field of scenarios as an option how fields are given.
std::string field_hint(const std::string& option, const std::vector<std::string>& known) {
  const std::string field = option.substr(std::min(option.find_first_not_of('-'), option.size()));
  if (nearest_name(field, scenario_field_paths()).empty()) return "";
  const auto has = [&known](const char* name) { return std::find(known.begin(), known.end(), name) != known.end(); };
  if (has("--vary")) return "; fields are varied by --vary FIELD=VALUES";
  return has("--set") ? "; fields are set by --set FIELD=VALUE" : "";
}

/// Explains a word that no option or argument takes.
std::string problem_of(const std::string& word, const CLI::App& program, const CLI::App* command) {
  if (word.starts_with("-") && word != "-") {
    const std::string name = word.substr(0, word.find('='));
    const std::vector<std::string> known = option_names(command ? *command : program);
    const std::string hint = nearest_name_hint(name, known);
    return fmt::format("unknown option \"{}\"{}", name, hint.empty() ? field_hint(name, known) : hint);
  }
  if (command != nullptr) return fmt::format("unexpected argument \"{}\"", word);
  std::vector<std::string> names = command_names(program);
  for (const std::string& option : option_names(program)) names.push_back(option);
  return fmt::format("unknown command \"{}\"{}", word, nearest_name_hint(word, names));
}

/// Refuses a word that only earlier versions took.
void refuse_old_words(const CLI::App& program, const CLI::App* command) {
  for (const std::string& word : program.remaining()) refuse_old_word("", word);
  if (command == nullptr) return;
  for (const std::string& word : command->remaining()) refuse_old_word(command->get_name(), word);
}

/// Explains in one line why the command line was refused.
std::string problem_of(const CLI::ParseError& error, const CLI::App& program) {
  const std::vector<CLI::App*> chosen = program.get_subcommands();
  const CLI::App* command = chosen.empty() ? nullptr : chosen.front();
  const std::string name = command ? command->get_name() + ": " : "", words = command ? command->get_name() + " " : "";
  const std::string help = fmt::format("; \"{} {}--help\" explains", kProgramName, words);
  std::vector<std::string> extra = program.remaining(true);
  std::erase(extra, "--");
  refuse_old_words(program, command);
  // An unknown option leaves its value behind as an extra word; the option is the mistake to report.
  std::stable_partition(extra.begin(), extra.end(), [](const std::string& word) { return word.starts_with("-"); });
  if (!extra.empty()) return name + problem_of(extra.front(), program, command) + help;
  if (command == nullptr && error.get_name() == "RequiredError") return "a command is missing" + help;
  return one_line(name + error.what()) + help;
}

void load_modules(const std::vector<std::string>& files) {
  for (const std::string& file : files) load_law(file);
  constexpr const char *kFolders = "HAPBENCH_MODULE_PATH", *kBefore = "HAPBENCH_PLUGIN_PATH";
  if (const char* folders = std::getenv(kFolders)) {
    load_laws_in(kFolders, folders);
  } else if (std::getenv(kBefore) != nullptr) {
    throw InputError(fmt::format("{} is no longer read; instead: {}", kBefore, kFolders));
  }
}

/// Makes a success fail when a module failed: its runs count as diverged, which by itself need not be a failure.
int status_with_faults(int status) {
  const ModuleFaults faults = take_module_faults();
  if (faults.count == 0) return status;
  std::fflush(stdout);
  print_error(fmt::format("a law or source of contacts from outside failed {}; its runs count as diverged: {}",
                          faults.count == 1 ? "once" : fmt::format("{} times", faults.count), faults.first));
  return status == kSuccess ? kUnexpectedOutcome : status;
}

}  // namespace

InputError with_typed_places(const InputError& error, const std::vector<std::string>& overrides) {
  constexpr std::size_t kMostTyped = 60;
  std::vector<InputError> faults;
  for (const InputError& fault : error.faults()) {
    std::string place = fault.place();
    for (const std::string& override : overrides) {
      std::string pointer = "/" + std::string(overridden_path(override));
      std::replace(pointer.begin(), pointer.end(), '.', '/');
      const std::size_t at = place.find(": " + pointer);
      const std::string rest = at == std::string::npos ? "" : place.substr(at + 2 + pointer.size());
      if (at == std::string::npos || !(rest.empty() || rest.starts_with('/'))) continue;
      const std::size_t file = place.rfind(": ", at - 1);  // behind what else was typed, as --device
      const std::string typed = file == std::string::npos ? "" : place.substr(0, file + 2);
      const bool is_long = override.size() > kMostTyped;
      place = fmt::format("{}--set {}{}{}", typed, override.substr(0, kMostTyped), is_long ? "…" : "",
                          rest.empty() ? "" : ": " + pointer + rest);
      break;
    }
    faults.emplace_back(fault.kind(), place, fault.problem());
  }
  return InputError::all(faults);
}

int CommandLine::run(int argc, char** argv) {
  std::vector<std::string> words(argv + std::min(argc, 1), argv + argc);
  const std::optional<StudyWords> study = StudyWords::in(words);
  if (!study) return run(std::move(words));
  try {
    return run(study->words());
  } catch (const InputError& error) {
    throw study->located(error);
  }
}

int CommandLine::run(std::vector<std::string> words) {
  if (!words.empty() && passed_on_.contains(words[0])) {
    const auto& action = passed_on_[words[0]];
    return action({words.begin() + 1, words.end()});
  }
  for (auto& [command, output] : outputs_) {
    command.flag("--quiet", output->quiet, "print nothing on standard output, and no progress bar");
    command.flag("--json", output->json, "print JSON instead of tables");
    command.flag("--wide", output_in_full, "print tables at full width, however narrow the terminal is");
  }
  try {
    std::reverse(words.begin(), words.end());  // as CLI11 takes them
    app_->parse(std::move(words));
  } catch (const CLI::CallForHelp&) {
    const std::vector<CLI::App*> chosen = app_->get_subcommands();
    refuse_old_words(*app_, nullptr);
    fmt::print("{}", help_text(chosen.empty() ? *app_ : *chosen.front()));
    return kSuccess;
  } catch (const CLI::CallForVersion& version) {
    fmt::print("{}\n", version.what());
    return kSuccess;
  } catch (const CLI::ParseError& error) {
    throw InputError(problem_of(error, *app_));
  }
  load_modules(modules_);
  take_module_faults();  // forgets those of an earlier command of this process
  return status_with_faults(chosen_.action());
}

}  // namespace hapbench
