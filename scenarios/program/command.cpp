#include "scenarios/program/command.hpp"

#include <fmt/format.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdio>
#include <set>

#include "algorithms/registry.hpp"
#include "results/io/atomic_file.hpp"
#include "results/io/json_text.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/program/terminal.hpp"
#include "scenarios/run/quantity_text.hpp"

namespace hapbench {

namespace fs = std::filesystem;

namespace {

thread_local CapturedOutput* captured = nullptr;

}  // namespace

void capture_output(CapturedOutput* output) noexcept {
  captured = output;
}

void add_output_options(Command& command, OutputOptions& options) {
  command.flag("--quiet", options.quiet, "nothing on standard output, no progress bar");
  command.flag("--json", options.json, "JSON on standard output instead of a table");
  command.flag("--wide", output_in_full, "tables in full, however narrow the terminal");
}

void add_skip_option(Command& command, Skips& skips) {
  command.flag(
      "--no-skip", [&skips] { skips = Skips::off; },
      "compute everything, also what cannot change the results, by brute force");
}

void print(const OutputOptions& options, const std::string& text, const Json& json) {
  if (options.quiet) return;
  const std::string output = options.json ? json_text(json) : fitted(text);
  if (captured != nullptr) {
    captured->text += output;
    return;
  }
  std::fwrite(output.data(), 1, output.size(), stdout);
}

void print_warnings(const std::vector<std::string>& warnings) {
  if (captured != nullptr) {
    captured->warnings.insert(captured->warnings.end(), warnings.begin(), warnings.end());
    return;
  }
  std::fflush(stdout);  // where both go to one pipe, in the order of printing
  for (const std::string& warning : warnings) fmt::print(stderr, "hapbench: warning: {}\n", warning);
}

void print_note(std::string_view text) {
  if (captured != nullptr) {
    captured->warnings.emplace_back(text);
    return;
  }
  std::fflush(stdout);  // what it is about comes first, where both go to one pipe
  fmt::print(stderr, "hapbench: {}\n", text);
}

void print_error(std::string_view text) {
  if (captured != nullptr) {
    captured->errors.emplace_back(text);
    return;
  }
  std::fflush(stdout);
  fmt::print(stderr, "{} {}\n", bold(stderr, "hapbench: error:"), text);
}

void print_errors(const InputError& error) {
  const std::vector<InputError> faults = error.faults();
  for (const InputError& fault : faults) print_error(fault.what());
  if (faults.size() == kMostFaults) print_error(fmt::format("no more than {} are shown", kMostFaults));
}

void announce_large_output(double bytes) {
  constexpr double kLarge = 1e8;
  if (bytes <= kLarge) return;
  print_note(fmt::format("about {} will be written; \"--set record.every=10\" makes it a tenth", bytes_text(bytes)));
}

std::vector<std::string> all_algorithms() {
  return algorithm_names();
}

void require_names(std::string_view got, const std::vector<std::string>& names, const std::vector<std::string>& valid) {
  std::set<std::string> seen;
  for (const std::string& name : names) {
    require_valid_name(got, name, valid);
    if (!seen.insert(name).second) throw InputError(fmt::format("{} \"{}\" twice; allowed: once", got, name));
  }
}

std::vector<std::string> chosen_names(std::string_view got, const std::vector<std::string>& given,
                                      const std::vector<std::string>& all) {
  if (given == std::vector<std::string>{"all"}) return all;
  if (std::find(given.begin(), given.end(), "all") != given.end())
    throw InputError(fmt::format("{} \"all\" beside other names; allowed: \"all\" alone", got));
  std::vector<std::string> valid = all;
  valid.insert(valid.begin(), "all");
  require_names(got, given, valid);
  return given;
}

void require_algorithms(const std::vector<std::string>& names) {
  require_names("--algorithms: got", names, all_algorithms());
}

std::vector<fs::path> output_directories(const std::string& out, const std::vector<LoadedScenario>& scenarios,
                                         const std::string& prefix, const std::string& allowed) {
  std::vector<fs::path> directories;
  std::set<std::string> stems;
  for (const LoadedScenario& scenario : scenarios) {
    const std::string stem = scenario.file.stem().string();
    if (!stems.insert(stem).second) {
      throw InputError(
          fmt::format("{}: a second scenario named \"{}\"; allowed: {}", scenario.file.string(), stem, allowed));
    }
    directories.push_back(out.empty()             ? fs::path("results") / "out" / (prefix + stem)
                          : scenarios.size() == 1 ? fs::path(out)
                                                  : fs::path(out) / stem);
  }
  return directories;
}

void require_writable_directory(const fs::path& directory) {
  static NewDirectories directories;  // until the program ends, with or without results
  std::error_code error;
  directories.create(directory, error);
  if (error) throw InputError(fmt::format("--out {}: cannot be created: {}", directory.string(), error.message()));
  if (!fs::is_directory(directory)) throw InputError(fmt::format("--out {}: is not a directory", directory.string()));
  if (access(directory.c_str(), W_OK | X_OK) != 0) {
    throw InputError(fmt::format("--out {}: cannot be written to", directory.string()));
  }
}

}  // namespace hapbench
