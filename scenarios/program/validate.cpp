#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cstdio>
#include <memory>

#include "scenarios/description/bundled_scenarios.hpp"
#include "scenarios/description/load_scenario.hpp"
#include "scenarios/program/command.hpp"
#include "scenarios/run/assemble.hpp"

namespace hapbench {
namespace {

struct ValidateOptions {
  std::vector<std::string> files;
  OutputOptions output;
};

int validate(const ValidateOptions& options) {
  std::string text;
  Json verdicts = Json::array();
  int status = kSuccess;
  for (const std::string& argument : options.files) {
    try {
      const LoadedScenario loaded = load_scenario(find_scenario(argument));
      const std::vector<std::string> warnings = check_named_files(loaded);
      print_warnings(loaded.warnings);
      print_warnings(warnings);
      text += fmt::format("{}: valid\n", argument);
      verdicts.push_back({{"file", argument}, {"valid", true}});
    } catch (const InputError& error) {
      fmt::print(stderr, "hapbench: error: {}\n", error.what());
      verdicts.push_back({{"file", argument}, {"valid", false}, {"error", error.what()}});
      status = kBadInput;
    }
  }
  print(options.output, text, verdicts);
  return status;
}

}  // namespace

void add_validate(CommandLine& line) {
  auto options = std::make_shared<ValidateOptions>();
  Command command = line.command("validate", "Check scenario files and the files they name, without running them");
  command.add("files", options->files, "scenario files").required();
  add_output_options(command, options->output);
  command.runs([options] { return validate(*options); });
}

}  // namespace hapbench
