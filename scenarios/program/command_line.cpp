#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <clocale>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <iterator>

#include "algorithms/module/module.hpp"
#include "results/io/atomic_file.hpp"
#include "results/summary/summary.hpp"
#include "scenarios/input/nearest_name.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/program/report.hpp"
#include "scenarios/run/load_module.hpp"
#include "scenarios/run/stop_signal.hpp"
#include "scenarios/scene/scenario_schema.hpp"

namespace hapbench {

using AddCommand = void(CommandLine& line);

/// Every command, each defined in a source file of its own subject.
AddCommand add_compare, add_converge, add_describe, add_limit, add_new, add_reproduce, add_run, add_stress, add_sweep,
    add_tune, add_validate;
/// Runs a command of a Python package, which takes every word behind the name, --help included.
int run_python_command(const ProgramWords& words);

namespace {

constexpr const char* kDescription = "an offline bench for haptic rendering";

/// A command in the program's help, and in its own.
struct CommandGuide {
  std::string_view group, name, answers;  ///< the question that it answers
  AddCommand* add;                        ///< null: of a Python package
  std::string_view examples = {};         ///< a line each
};

/// In the order of the help.
constexpr CommandGuide kCommands[] = {
    {"make", "new", "a scene to start from", add_new,
     "new\n"
     "new drag --from my.stl --extent 12mm --preview\n"
     "new hole --out mine.json"},
    {"make", "import", "my recording as a stroke; my device's log as a device", nullptr},
    {"make", "validate", "is a scene right, and what is in it?", add_validate,
     "validate mine.json\n"
     "validate mine.json --set environment.spacing_m=1e-4\n"
     "validate drag_molar --points shell.csv"},
    {"run", "run", "what happens, what is wrong with it, what to try?", add_run,
     "run drag_molar\n"
     "run drag_molar --set rendering.algorithm=proxy --out results/proxy\n"
     "run mine.json --latency"},
    {"run", "compare", "which law does better, over scenes and seeds?", add_compare,
     "compare drag_molar\n"
     "compare tap_wall tap_corner --algorithms mean,proxy --seeds 5\n"
     "compare mine.json --algorithms mean,proxy --errors"},
    {"run", "sweep", "how does it depend on fields?", add_sweep,
     "sweep tap_wall --vary rendering.stiffness_N_per_m=1e3:1e5:9:log\n"
     "sweep tap_wall --vary rendering.algorithm=all --vary seed=1,2,3\n"
     "sweep results/out/sweep_tap_wall --where 'inside_max_m<3e-4'"},
    {"decide", "limit", "how far may a field go, on which device, with which law?", add_limit,
     "limit tap_wall --device all\n"
     "limit mine.json --algorithms mean,shaped_stiffness\n"
     "limit tap_wall --vary time.step_s --between 1e-4:1e-2"},
    {"decide", "tune", "which law, stiffness and damping?", add_tune,
     "tune tap_wall --device touch\n"
     "tune mine.json --device log_device.json --algorithms mean,proxy\n"
     "tune drag_molar --device omega.3 --bound inside_max_m=3e-4"},
    {"decide", "converge", "how accurate is a number?", add_converge,
     "converge drag_molar --metric force_max_N\n"
     "converge mine.json --levels 5 --metric inside_max_m\n"
     "converge drag_molar --vary environment.spacing_m"},
    {"decide", "stress", "does any law break on degenerate contacts?", add_stress,
     "stress\n"
     "stress --count 1000\n"
     "stress --module ./my_law.so"},
    {"decide", "reproduce", "which claims of the thesis hold?", add_reproduce,
     "reproduce\n"
     "reproduce --only T2,R1b\n"
     "reproduce --choices results/reference/readings.csv"},
    {"look", "describe", "what is a name? without one: what is there?", add_describe,
     "describe\n"
     "describe shaped_stiffness\n"
     "describe scenarios --grep molar"},
    {"look", "plot", "a picture of results", nullptr},
    {"look", "report", "a page of results with replay; of two: what differs", nullptr}};

std::string version_text(bool as_json) {
  const Provenance program = provenance();
  if (!as_json) return fmt::format("hapbench {} ({})", program.version, program.commit);
  Json json = {
      {"version", program.version},
      {"commit", program.commit},
      {"compiler", program.compiler},
      {"build_type", program.build_type},
      {"flags", program.flags},
      {"instruction_set", {{"march", program.march}, {"widest", program.widest}, {"simd", program.simd}}},
      {"promise",
       "Within a major version (before 1.0: a minor one) no field of scenarios, no file or column of results, no "
       "command, option or exit status goes away or changes its meaning; there may be more of them. Computed "
       "numbers may change with every version: results name the commit that made them."}};
  return json.dump(2);
}

struct OldWords {
  std::string_view command;  ///< of options; empty for commands, "*" for options of every command
  std::string_view words;    ///< separated by blanks
  std::string_view instead;
};

/// By command, so that what one command lost stands together.
constexpr OldWords kOldWords[] = {
    {"*", "--memory", "ulimit -d KILOBYTES before the command; without it three quarters of the machine's"},
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
    {"import device", "--duration --force --mass --rate --travel", "--design chirp,force=2,travel=0.08,mass=0.1"},
    {"import stroke", "--list", "hapbench import stroke, without a file"},
    {"import stroke", "--floats --force-by-tool --max-gap --max-speed --sample-rate --shift --tip-axis",
     "--set NAME=VALUE, as max_speed=9 or floats=true; the help has the names"},
    {"new", "--scale", "--extent SIZE, the longest edge of the mesh's box: 12mm, 1.2cm, 0.012m, 0.5in"},
    {"plot", "--no-sketch", "the same without it: plot draws no sketches"},
    {"reproduce", "--robustness",
     "hapbench reproduce --choices results/reference/readings.csv, or of scripts/readings.py 256"},
    {"reproduce", "--subjects", "their record, in the manual of the thesis's claims (scenarios/thesis/README.md)"},
    {"run", "--sure", "hapbench converge SCENE, of the points with --vary environment.spacing_m"},
    {"sweep", "--cpus --dry-run --partition --slurm --time",
     "sbatch --array=0-99 scripts/sweep.sbatch SCENE --vary ... --out FOLDER"},
    {"sweep", "--status", "squeue, and the tables sweep.I_of_N.csv that are in the folder"},
    {"tune", "--max-inside", "--bound inside_max_m=3e-4 [m]"},
    {"tune", "--max-step", "--bound settled_force_step_max_N=0.2"},
    {"tune", "--max-vibration", "--bound force_rms_above_30Hz_N=0.05"},
    {"tune", "--over", "--family hands,seeds,speeds"},
};

/// What commands have in common, as far as it means something to them.
constexpr std::pair<std::string_view, std::string_view> kSharedOptions[] = {
    {"--set", "override a field of every scene: path=value, as in time.steps=100; repeatable"},
    {"--out", "where the results go (default: results/out/NAME); a command's help has its own"},
    {"--jobs", "runs at once; no result depends on it (default: one per thread)"},
    {"--seed", "of the random numbers, for another sample (default: 1)"},
    {"--module", "load FILE.so, which holds a force law of your own; HAPBENCH_MODULE_PATH names folders of such files"},
    {"--json", "print JSON instead of tables, for a script"},
    {"--quiet", "print nothing on standard output, and no progress"},
    {"--wide", "print tables in full width, however narrow the terminal is"},
    {"--help", "explain the command, with examples"}};

std::string name_of(const CLI::Option& option) {
  return option.get_name(option.get_positional(), true);
}

/// The kind of value, as in "TEXT ..."; empty for a flag.
std::string kind_of_value(const CLI::Option& option) {
  if (option.get_type_size() == 0 || option.get_type_name().empty()) return "";
  std::string kind = option.get_type_name();
  if (option.get_expected_max() == CLI::detail::expected_max_vector_size)
    kind += option.get_delimiter() == ',' ? ",..." : " ...";
  return kind;
}

std::string usage(const CLI::App& app) {
  std::string words = fmt::format("Usage: hapbench {} [OPTIONS]", app.get_name());
  for (const CLI::Option* option : app.get_options([](const CLI::Option* o) { return o->get_positional(); })) {
    const std::string name = name_of(*option) + (kind_of_value(*option).ends_with("...") ? "..." : "");
    words += option->get_required() ? " " + name : " [" + name + "]";
  }
  return words + "\n";
}

/// The arguments, or the options; those that say nothing of their own stand in one line.
std::string options_text(const CLI::App& app, bool arguments) {
  std::string text, shared;
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_positional() != arguments) continue;
    std::string name = name_of(*option), help = option->get_description();
    if (name == "-h,--help") name = "--help";
    if (!arguments && help == shared_option_help(name)) {
      shared += (shared.empty() ? "" : ", ") + name;
      continue;
    }
    if (const std::string kind = kind_of_value(*option); !arguments && !kind.empty()) name += " " + kind;
    for (const CLI::Option* other : option->get_needs()) help += "; with " + other->get_name();
    if (option->get_required() && !arguments) help += "; required";
    text += entry(name, help);
  }
  if (!shared.empty()) text += entry(shared, "as everywhere: hapbench --help");
  return text.empty() ? "" : fmt::format("\n{}\n{}", bold(stdout, arguments ? "Arguments:" : "Options:"), text);
}

/// The help of a command, as wide as prose is.
std::string help_text(const CLI::App& app) {
  std::string text =
      wrapped(app.get_description(), 0) + usage(app) + options_text(app, true) + options_text(app, false) + "\n";
  if (!app.get_footer().empty()) text += wrapped(app.get_footer(), 0) + "\n";
  LineReader examples(std::ranges::find(kCommands, app.get_name(), &CommandGuide::name)->examples);
  while (const auto example = examples.next()) text += fmt::format("  hapbench {}\n", *example);
  return text;
}

/// The commands in their groups, and what to do first.
std::string front() {
  std::string text = fmt::format("hapbench: {}\n\n", kDescription);
  std::string_view group;
  for (const CommandGuide& guide : kCommands) {
    text += entry(fmt::format("{:8}{}", guide.group == group ? "" : guide.group, guide.name), guide.answers, 0, 19);
    group = guide.group;
  }
  return text +
         "\n"
         "first   hapbench run drag_molar\n"
         "        hapbench new drag --from my.stl --extent 12mm\n"
         "        hapbench describe\n\n"
         "\"hapbench COMMAND --help\" explains a command, \"hapbench --help\" what all share.\n";
}

std::string program_help() {
  std::string text = front() + "\n" + bold(stdout, "Options:") + "\n";
  for (const auto& [name, help] : kSharedOptions) text += entry(name, help, 2, 14);
  return text + entry("--version", "print the version; with --json also what it was built from and promises", 2, 14) +
         "\n" +
         wrapped(
             "Exit status: 0 success, 1 internal fault, 2 bad input or usage, 3 a run did not end as its scenario "
             "expects, 130 stopped by Ctrl-C.",
             0);
}

std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

/// Tells a user who wrote a field of scenarios as an option how fields are given.
std::string field_hint(const std::string& option, const std::vector<std::string>& known) {
  const std::string field = option.substr(std::min(option.find_first_not_of('-'), option.size()));
  if (nearest_name(field, scenario_field_paths()).empty()) return "";
  if (std::ranges::count(known, "--vary") > 0) return "; fields are varied by --vary FIELD=VALUES";
  return std::ranges::count(known, "--set") > 0 ? "; fields are set by --set FIELD=VALUE" : "";
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
  std::vector<std::string> names = names_of(program.get_subcommands({}), &CLI::App::get_name);
  std::ranges::copy(option_names(program), std::back_inserter(names));
  return fmt::format("unknown command \"{}\"{}", word, nearest_name_hint(word, names));
}

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
  const std::string help = fmt::format("; \"hapbench {}--help\" explains", words);
  ProgramWords extra = program.remaining(true);
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

int fail(std::string_view what) {
  print_error(what);
  return kInternalFault;
}

}  // namespace

std::string shared_option_help(const std::string& name) {
  for (const auto& [option, help] : kSharedOptions)
    if (option == name) return std::string(help);
  return "";
}

void refuse_old_word(const std::string& command, const std::string& word) {
  const std::string name = word.substr(0, word.find('='));
  for (const OldWords& old : kOldWords) {
    const Words words = words_of(old.words);
    if (std::ranges::find(words, name) == words.end() || (old.command != command && old.command != "*")) continue;
    throw InputError(fmt::format("{}\"{}\" is no longer known; instead: {}", command.empty() ? "" : command + ": ",
                                 name, old.instead));
  }
}

void Command::add(const std::string& name, Variable variable, const std::string& help, const Takes& takes) {
  CLI::Option* option = std::visit([&](auto value) { return app_->add_option(name, value.get(), help); }, variable);
  option->required(takes.required);
  if (takes.several) option->allow_extra_args(false)->take_all();
  if (takes.comma_separated)
    option->delimiter(',')->transform([](const std::string& word) { return CLI::detail::trim_copy(word); });
  // CLI11's own checks word the errors differently, and show in the help.
  const auto problem = [range = takes.range, words = takes.one_of](const std::string& word) -> std::string {
    std::int64_t number = 0;
    if (range && !(CLI::detail::lexical_cast(word, number) && number >= range->first && number <= range->second))
      return fmt::format("got {}; allowed: {} ... {}", word, range->first, range->second);
    if (words.empty() || std::ranges::find(words, word) != words.end()) return "";
    return fmt::format("got \"{}\"{}; allowed: {}", word, nearest_name_hint(word, words), quoted_list(words));
  };
  option->check(CLI::Validator(problem, ""));
}

void Command::flag(const std::string& name, bool& value, const std::string& help) {
  app_->add_flag(name, value, help);
}

void Command::needs(const std::string& option, const std::string& other) {
  app_->get_option(option)->needs(app_->get_option(other));
}

void Command::footer(const std::string& text) {
  app_->footer(text);
}

CommandLine::CommandLine() : app_(std::make_shared<CLI::App>(kDescription, "hapbench")) {
  CLI::Option* json = app_->add_flag("--json");
  json->needs(app_->set_version_flag("--version", [json] { return version_text(json->count() > 0); }));
  add_module_option(*app_);
  app_->require_subcommand(1);
  for (const CommandGuide& command : kCommands)
    command.add != nullptr ? command.add(*this) : static_cast<void>(app_->add_subcommand(std::string(command.name)));
}

/// The program and each command have it, so that it may stand before or behind the command.
void CommandLine::add_module_option(CLI::App& app) {
  const auto add = [this](const std::vector<std::string>& files) {
    modules_.insert(modules_.end(), files.begin(), files.end());
  };
  app.add_option_function<std::vector<std::string>>("--module", add, shared_option_help("--module"))
      ->allow_extra_args(false)
      ->take_all();
}

Command CommandLine::add(const std::string& name, const std::string& summary, OutputOptions& output,
                         std::function<int()> action, const std::string& when_stopped) {
  CLI::App* app = app_->add_subcommand(name, summary);
  app->get_option("--help")->description(shared_option_help("--help"));
  app->callback([=, this] {
    action_ = action;
    when_stopped_ = when_stopped;
  });
  add_module_option(*app);
  outputs_.emplace_back(app, &output);
  return Command(app);
}

namespace {

/// The location with the override in place of its file, if the override gave its field. `pointer` is the override's.
void name_override(ErrorLocation& location, const std::string& override, const std::string& pointer) {
  constexpr std::size_t kMostTyped = 60;
  const bool is_long = override.size() > kMostTyped;
  const bool has_option = !location.option.empty();  // what else was typed, as --device
  location.option +=
      fmt::format("{}--set {}{}", has_option ? ": " : "", override.substr(0, kMostTyped), is_long ? "…" : "");
  location.file.clear();
  if (location.pointer == pointer) location.pointer.clear();  // the override says it
}

}  // namespace

InputError with_typed_places(const InputError& error, const std::vector<std::string>& overrides) {
  std::vector<InputError> faults;
  for (const InputError& fault : error.faults()) {
    ErrorLocation location = fault.location();
    for (const std::string& override : overrides) {
      std::string pointer = "/" + std::string(overridden_path(override));
      std::ranges::replace(pointer, '.', '/');
      const bool is_in_it = location.pointer == pointer || location.pointer.starts_with(pointer + "/");
      if (!is_in_it || location.file.empty()) continue;
      name_override(location, override, pointer);
      break;
    }
    faults.emplace_back(fault.kind(), location, fault.problem());
  }
  return InputError::all(faults);
}

int CommandLine::run(const ProgramWords& words) {
  const std::optional<StudyWords> study = StudyWords::in(words);
  if (!study) return parse_and_run(words);
  try {
    return parse_and_run(study->words);
  } catch (const InputError& error) {
    throw study->located(error);
  }
}

int CommandLine::parse_and_run(ProgramWords words) {
  if (words.empty()) {
    fmt::print("{}", front());
    return kSuccess;
  }
  const auto* guide = std::ranges::find(kCommands, words[0], &CommandGuide::name);
  if (guide != std::end(kCommands) && guide->add == nullptr) return run_python_command(words);
  for (const auto& [app, output] : outputs_) {
    app->add_flag("--quiet", output->quiet, shared_option_help("--quiet"));
    app->add_flag("--json", output->json, shared_option_help("--json"));
    app->add_flag("--wide", output_in_full(), shared_option_help("--wide"));
  }
  try {
    std::reverse(words.begin(), words.end());  // as CLI11 takes them
    app_->parse(std::move(words));
  } catch (const CLI::CallForHelp&) {
    const std::vector<CLI::App*> chosen = app_->get_subcommands();
    refuse_old_words(*app_, nullptr);
    fmt::print("{}", chosen.empty() ? program_help() : help_text(*chosen.front()));
    return kSuccess;
  } catch (const CLI::CallForVersion& version) {
    fmt::print("{}\n", version.what());
    return kSuccess;
  } catch (const CLI::ParseError& error) {
    throw InputError(problem_of(error, *app_));
  }
  load_modules(modules_);
  take_module_faults();  // forgets those of an earlier command of this process
  return status_with_faults(action_());
}

int run_program(const ProgramWords& words) {
  // Numbers are read and written without the language of a host such as Python, whose decimal point may be a comma.
  const locale_t plain = ::newlocale(LC_ALL_MASK, "C", nullptr), before = ::uselocale(plain);
  const std::shared_ptr<void> restored(nullptr, [=](void*) {
    ::uselocale(before);
    ::freelocale(plain);
  });
  CommandLine line;
  try {
    return line.run(words);
  } catch (const Stopped& stop) {
    print_note(fmt::format("stopped; {}", line.when_stopped()));
    return kStopped + stop.signal;
  }
}

int run_program_to_exit(const ProgramWords& words) {
  try {
    const int status = run_program(words);
    if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return status;
    return fail(fmt::format("cannot write standard output: {}", std::strerror(errno)));
  } catch (const InputError& error) {
    print_errors(error);
    return kBadInput;
  } catch (const IoError& error) {
    return fail(error.what());
  } catch (const std::bad_alloc&) {
    return fail("out of memory; allowed: three quarters of the machine's, or what \"ulimit -d\" sets");
  } catch (const std::exception& error) {
    return fail(one_line(fmt::format("internal fault: {}", error.what())));
  }
}

}  // namespace hapbench
