#include "scenarios/program/command_line.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <optional>

#include "algorithms/module/module.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/program/commands.hpp"
#include "scenarios/program/exit_status.hpp"
#include "scenarios/program/help.hpp"
#include "scenarios/program/output.hpp"
#include "scenarios/program/python_commands.hpp"
#include "scenarios/program/studies.hpp"
#include "scenarios/program/usage_errors.hpp"
#include "scenarios/program/version.hpp"
#include "scenarios/run/load_module.hpp"

namespace hapbench {

namespace {

/// Loads the modules of --module, then the modules in the folders of HAPBENCH_MODULE_PATH.
void load_modules(const std::vector<std::string>& files, const LoadingGuard& guard) {
  for (const std::string& file : files) load_module(file, guard);
  constexpr const char* kFolders = "HAPBENCH_MODULE_PATH";
  if (const char* folders = std::getenv(kFolders)) load_modules_in(kFolders, folders, guard);
}

/// Returns the exit status, changed from success to kUnexpectedOutcome if a module failed. Without this change the
/// command could succeed, because a failed module only makes its runs count as diverged. Prints the first failure.
int status_with_faults(int status, ProgramContext& context) {
  const ModuleFaults faults = take_module_faults();
  if (faults.count == 0) return status;
  std::fflush(stdout);
  print_error(context, fmt::format("a law or contact source of a module failed {}; its runs count as diverged: {}",
                                   faults.count == 1 ? "once" : fmt::format("{} times", faults.count), faults.first));
  return status == kSuccess ? kUnexpectedOutcome : status;
}

/// Returns the command with this name; null if no command has this name.
const CLI::App* command_named(const CLI::App& program, const std::string& name) {
  const std::vector<const CLI::App*> found =
      program.get_subcommands([&name](const CLI::App* command) { return command->get_name() == name; });
  return found.empty() ? nullptr : found.front();
}

/// Returns true if an option takes a value. Returns true for an unknown option too, because it may take a
/// value.
bool takes_next_argument(const CLI::App& command, const std::string& option) {
  const CLI::Option* found = command.get_option_no_throw(option);
  return found == nullptr || found->get_items_expected_min() > 0;
}

}  // namespace

CommandLine::CommandLine(ProgramContext& context)
    : context_(context), app_(std::make_shared<CLI::App>(kProgramSummary, "hapbench")) {
  CLI::Option* json = app_->add_flag("--json");
  json->needs(app_->set_version_flag("--version", [json] { return version_text(json->count() > 0); }));
  add_module_option(*app_);
  app_->require_subcommand(1);
  for (const CommandGuide& command : command_guides()) {
    if (command.add != nullptr) {
      command.add(*this);
    } else {
      app_->add_subcommand(std::string(command.name));  // a Python package parses its arguments
    }
  }
  // The shared output options come after the options that each command has added.
  for (const auto& [app, output] : outputs_) {
    app->add_flag("--quiet", output->quiet, shared_option_help("--quiet"));
    CLI::Option* as_json = app->add_flag("--json", output->json, shared_option_help("--json"));
    if (CLI::Option* table = app->get_option_no_throw("--table")) as_json->excludes(table);
    app->add_flag("--wide", context_.in_full, shared_option_help("--wide"));
  }
}

/// The program and each command have the options --module and --allow-modules, so that they may stand before or after
/// the command.
void CommandLine::add_module_option(CLI::App& app) {
  const auto add = [this](const std::vector<std::string>& files) {
    modules_.insert(modules_.end(), files.begin(), files.end());
  };
  app.add_option_function<std::vector<std::string>>("--module", add, shared_option_help("--module"))
      ->type_name("<file.so>")
      ->allow_extra_args(false)
      ->take_all();
  app.add_flag("--allow-modules", allow_modules_, shared_option_help("--allow-modules"));
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

std::vector<std::size_t> CommandLine::argument_indices(const ProgramArguments& arguments) const {
  std::vector<std::size_t> indices;
  const CLI::App* command = arguments.empty() ? nullptr : command_named(*app_, arguments[0]);
  if (command == nullptr) return indices;
  // Skip options and their values; after "--" all arguments are positional.
  bool are_options_over = false;  // true after "--"
  for (std::size_t i = 1; i < arguments.size(); ++i) {
    const std::string& argument = arguments[i];
    if (are_options_over || !argument.starts_with("-")) {
      indices.push_back(i);
    } else if (argument == "--") {
      are_options_over = true;
    } else if (argument.find('=') == std::string::npos && takes_next_argument(*command, argument)) {
      ++i;
    }
  }
  return indices;
}

int CommandLine::run(const ProgramArguments& arguments) {
  const std::optional<StudyArguments> study = StudyArguments::in(arguments, argument_indices(arguments));
  if (!study) return parse_and_run(arguments);
  try {
    return parse_and_run(study->arguments);
  } catch (const InputError& error) {
    throw study->located(error);
  }
}

int CommandLine::parse_and_run(ProgramArguments arguments) {
  if (arguments.empty()) {
    fmt::print("{}", front_text(context_.layout()));
    return kSuccess;
  }
  // Commands of Python packages parse their own arguments.
  const auto guide = std::ranges::find(command_guides(), arguments[0], &CommandGuide::name);
  if (guide != command_guides().end() && guide->add == nullptr) return run_python_command(arguments, context_);
  try {
    std::reverse(arguments.begin(), arguments.end());  // CLI11 expects the arguments in reverse order
    app_->parse(std::move(arguments));
  } catch (const CLI::CallForHelp&) {
    const std::vector<CLI::App*> chosen = app_->get_subcommands();
    const Layout layout = context_.layout();
    fmt::print("{}", chosen.empty() ? program_help(*app_, layout) : command_help(*chosen.front(), layout));
    return kSuccess;
  } catch (const CLI::CallForVersion& version) {
    fmt::print("{}\n", version.what());
    return kSuccess;
  } catch (const CLI::ParseError& error) {
    throw usage_error(error, *app_);
  }
  // Load the modules, then run the selected command.
  const ModulePermission permission(allow_modules_);
  load_modules(modules_, context_.guard_loading);
  take_module_faults();  // discards failures of an earlier command of this process
  return status_with_faults(action_(), context_);
}

}  // namespace hapbench
