#include "scenarios/program/output.hpp"

#include <fmt/format.h>

#include <cstdio>

#include "scenarios/input/writer.hpp"
#include "scenarios/program/table_format.hpp"
#include "scenarios/program/text.hpp"
#include "scenarios/scene/field_files.hpp"

namespace hapbench {

namespace {

void write_line(std::string_view head, std::string_view text) {
  std::fflush(stdout);  // keeps the output in order if both streams go to the same pipe
  fmt::print(stderr, "{} {}\n", head, text);
}

std::string error_head() {
  return bold(stderr, "hapbench: error:");
}

/// If a host captures the output, appends `text` to the list `kind` of the captured output. Otherwise prints `head` and
/// `text` as a line on standard error.
void report(const ProgramContext& context, std::vector<std::string> CapturedOutput::*kind, std::string_view head,
            std::string_view text) {
  if (context.captured != nullptr) {
    (context.captured->*kind).emplace_back(text);
    return;
  }
  write_line(head, text);
}

/// If a host captures the output, appends `output` to the captured text. Otherwise prints `output` on standard output.
void print_as_is(const ProgramContext& context, const std::string& output) {
  if (context.captured != nullptr) {
    context.captured->text += output;
    return;
  }
  std::fwrite(output.data(), 1, output.size(), stdout);
}

}  // namespace

void print(const ProgramContext& context, const OutputOptions& options, const std::string& text, const Json& json) {
  if (options.quiet) return;
  print_as_is(context, options.json ? json_text(json) : fitted(text, context.layout().width()));
}

void print_tables(const ProgramContext& context, const OutputOptions& options, std::span<const Table> tables) {
  if (options.quiet) return;
  if (tables.empty()) fail_in_option("--table", "there is no table to print; without --table, the text says why");
  print_as_is(context, formatted_tables(tables, options.table));
  if (options.table == "csv" && tables.size() > 1)
    print_note(context, fmt::format("printed {} CSV tables with an empty line between them", tables.size()));
}

void print_warnings(const ProgramContext& context, const std::vector<std::string>& warnings) {
  for (const std::string& warning : warnings) report(context, &CapturedOutput::warnings, "hapbench: warning:", warning);
}

void print_warnings(const ProgramContext& context, const CheckedScenario& checked) {
  for (const auto& warnings : {checked.loaded().warnings, checked.file_warnings()})
    print_warnings(context, with_files(checked.loaded(), warnings));
}

void print_note(const ProgramContext& context, std::string_view text) {
  report(context, &CapturedOutput::warnings, "hapbench:", text);
}

void print_error(const ProgramContext& context, std::string_view text) {
  report(context, &CapturedOutput::errors, error_head(), text);
}

void write_error(std::string_view text) {
  write_line(error_head(), text);
}

void print_errors(const ProgramContext& context, const InputError& error) {
  const std::vector<InputError> faults = error.faults();
  for (const InputError& fault : faults) print_error(context, fault.what());
  if (faults.size() == kMaxFaults) print_error(context, fmt::format("at most {} errors are shown", kMaxFaults));
}

}  // namespace hapbench
