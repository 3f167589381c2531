#include "scenarios/program/output.hpp"

#include <fmt/format.h>

#include <cstdio>

#include "scenarios/input/writer.hpp"
#include "scenarios/program/text.hpp"

namespace hapbench {

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

void print_warnings(const LoadedScenario& loaded) {
  for (const auto& warnings : {loaded.warnings, loaded.file_warnings}) print_warnings(with_files(loaded, warnings));
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

}  // namespace hapbench
