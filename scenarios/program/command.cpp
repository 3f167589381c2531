#include "scenarios/program/command.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <set>

#include "results/io/columns.hpp"
#include "scenarios/cases/league.hpp"
#include "scenarios/format/input_error.hpp"
#include "scenarios/program/table.hpp"
#include "scenarios/run/result_folder.hpp"

namespace hapbench {

namespace fs = std::filesystem;

namespace {

/// Prints a line on standard error, or adds it to what the host collects of that kind.
void tell(std::vector<std::string> CapturedOutput::*kind, std::string_view head, std::string_view text) {
  if (CapturedOutput* host = captured_output()) {
    (host->*kind).emplace_back(text);
    return;
  }
  std::fflush(stdout);  // keeps the order of printing where both streams go to one pipe
  fmt::print(stderr, "{} {}\n", head, text);
}

}  // namespace

CapturedOutput*& captured_output() noexcept {
  thread_local CapturedOutput* captured = nullptr;
  return captured;
}

void add_overrides(Command& command, std::vector<std::string>& overrides) {
  command.add("--set", overrides, shared_option_help("--set"), {.several = true});
}

void add_jobs(Command& command, unsigned& jobs, const std::string& help) {
  command.add("--jobs", jobs, help, {.range = {{1, 1024}}});
}

void add_out(Command& command, std::string& out, const std::string& name) {
  command.add("--out", out, fmt::format("directory of the results (default: results/out/{})", name));
}

void add_algorithms(Command& command, std::vector<std::string>& algorithms, const std::string& otherwise) {
  command.add("--algorithms", algorithms, fmt::format("names separated by commas, or all (default: {})", otherwise),
              {.comma_separated = true});
}

void add_common(Command& command, CommonOptions& options, const std::string& name) {
  add_jobs(command, options.jobs);
  add_out(command, options.out, name);
  add_overrides(command, options.overrides);
}

void print(const OutputOptions& options, const std::string& text, const Json& json) {
  if (options.quiet) return;
  const std::string output = options.json ? json_text(json) : fitted(text);
  if (CapturedOutput* host = captured_output()) {
    host->text += output;
    return;
  }
  std::fwrite(output.data(), 1, output.size(), stdout);
}

void print_warnings(const std::vector<std::string>& warnings) {
  for (const std::string& warning : warnings) tell(&CapturedOutput::warnings, "hapbench: warning:", warning);
}

void print_warnings(const LoadedScenario& loaded, const std::vector<Warning>& warnings) {
  print_warnings(with_files(loaded, warnings));
}

void print_note(std::string_view text) {
  tell(&CapturedOutput::warnings, "hapbench:", text);
}

void print_error(std::string_view text) {
  tell(&CapturedOutput::errors, bold(stderr, "hapbench: error:"), text);
}

void print_errors(const InputError& error) {
  const std::vector<InputError> faults = error.faults();
  for (const InputError& fault : faults) print_error(fault.what());
  if (faults.size() == kMostFaults) print_error(fmt::format("no more than {} are shown", kMostFaults));
}

std::vector<std::string> first_few(std::vector<std::string> texts, std::size_t most) {
  if (texts.size() <= most) return texts;
  const std::string rest = fmt::format("{} more like these", texts.size() - most);
  texts.resize(most);
  texts.push_back(rest);
  return texts;
}

void require_names(std::string_view got, const std::vector<std::string>& names, const std::vector<std::string>& valid,
                   std::string_view shown_by) {
  std::set<std::string> seen;
  for (const std::string& name : names) {
    require_valid_name(got, name, valid, shown_by);
    if (!seen.insert(name).second) throw InputError(fmt::format("{} \"{}\" twice; allowed: once", got, name));
  }
}

std::vector<std::string> chosen_names(std::string_view got, const std::vector<std::string>& given,
                                      const std::vector<std::string>& all, std::string_view shown_by) {
  if (given == std::vector<std::string>{"all"}) return all;
  if (std::find(given.begin(), given.end(), "all") != given.end())
    throw InputError(fmt::format("{} \"all\" together with other names; allowed: \"all\" alone", got));
  std::vector<std::string> valid = all;
  valid.insert(valid.begin(), "all");
  require_names(got, given, valid, shown_by);
  return given;
}

std::string chosen_metric(const std::vector<std::string>& metrics, const std::string& asked_for) {
  if (!asked_for.empty()) {
    require_valid_name("--metric: got", asked_for, metrics);
    return asked_for;
  }
  const auto has = [&](std::string_view name) { return std::ranges::find(metrics, name) != metrics.end(); };
  return std::string(*std::find_if(std::begin(kDefaultMetrics), std::end(kDefaultMetrics) - 1, has));
}

fs::path results_directory(const std::string& out, const std::string& name) {
  return out.empty() ? fs::path("results") / "out" / name : fs::path(out);
}

void require_writable_directory(const fs::path& directory, std::string_view option) {
  static NewDirectories directories;  // lives until the program ends, which removes empty ones
  std::error_code error;
  directories.create(directory, error);
  if (error) throw InputError(fmt::format("{} {}: cannot be created: {}", option, directory.string(), error.message()));
  if (!fs::is_directory(directory))
    throw InputError(fmt::format("{} {}: is not a directory", option, directory.string()));
  if (access(directory.c_str(), W_OK | X_OK) != 0) {
    throw InputError(fmt::format("{} {}: cannot be written to", option, directory.string()));
  }
}

JobOptions job_options(const CommonOptions& options, const std::string& label) {
  return {options.jobs == 0 ? static_cast<unsigned>(available_threads()) : options.jobs,
          options.output.quiet ? "" : label};
}

std::string shell_line(const std::vector<std::string>& words) {
  constexpr std::string_view kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./:=,+@%";
  std::string line;
  for (const std::string& word : words) {
    if (!line.empty()) line += ' ';
    const bool is_plain = !word.empty() && word.find_first_not_of(kPlain) == std::string::npos;
    if (!is_plain) line += '\'';
    for (const char c : word) line += c == '\'' ? std::string("'\\''") : std::string(1, c);
    if (!is_plain) line += '\'';
  }
  return line;
}

fs::path& this_program() {
  std::error_code ignored;
  static fs::path program = fs::read_symlink("/proc/self/exe", ignored);
  return program;
}

}  // namespace hapbench
