#include "scenarios/input/input_error.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

namespace hapbench {

std::string one_line(std::string text) {
  std::ranges::replace_if(
      text, [](unsigned char c) { return c < 0x20 || c == 0x7f; }, '?');
  return text;
}

std::string ErrorLocation::text() const {
  std::vector<std::string> parts;
  if (!option.empty()) parts.push_back(option);
  for (const std::filesystem::path& path : outer) parts.push_back(path.string());
  std::string in_file = file.string();
  if (line > 0) in_file += fmt::format(", line {}", line);
  if (!entry.empty()) in_file += ", " + entry;
  if (!in_file.empty()) parts.push_back(in_file);
  if (!pointer.empty()) parts.push_back(pointer);
  return fmt::format("{}", fmt::join(parts, ": "));
}

InputError::InputError(Kind kind, ErrorLocation location, std::string location_text, std::string problem)
    : std::runtime_error(one_line(location_text.empty() ? problem : location_text + ": " + problem)),
      kind_(kind),
      location_(std::move(location)),
      location_text_(std::move(location_text)),
      problem_(std::move(problem)) {}

InputError::InputError(Kind kind, ErrorLocation location, const std::string& problem)
    : InputError(kind, location, location.text(), problem) {}

InputError::InputError(Kind kind, const std::string& pointer, const std::string& problem)
    : InputError(kind, ErrorLocation{.pointer = pointer}, problem) {}

InputError::InputError(const std::string& problem) : InputError(Kind::relation, ErrorLocation{}, problem) {}

InputError InputError::all(const std::vector<InputError>& errors) {
  // Collect the faults of all errors.
  std::vector<InputError> faults;
  for (const InputError& error : errors) {
    const std::vector<InputError> more = error.faults();
    faults.insert(faults.end(), more.begin(), more.end());
  }
  // Put faults of kind `shape` first, and limit the number of faults.
  std::stable_partition(faults.begin(), faults.end(), [](const InputError& e) { return e.kind() == Kind::shape; });
  if (faults.size() > kMaxFaults) faults.erase(faults.begin() + kMaxFaults, faults.end());
  // The first fault gives the message and holds the other faults.
  InputError first = std::move(faults.front());
  first.more_.assign(faults.begin() + 1, faults.end());
  return first;
}

std::vector<InputError> InputError::faults() const {
  std::vector<InputError> faults = {InputError(kind_, location_, problem_)};
  faults.insert(faults.end(), more_.begin(), more_.end());
  return faults;
}

void fail_at(const std::string& pointer, const std::string& problem) {
  fail_in({.pointer = pointer}, problem);
}

void fail_in_file(const std::filesystem::path& file, const std::string& problem) {
  fail_in({.file = file}, problem);
}

void fail_in_line(const std::filesystem::path& file, std::size_t line, const std::string& problem) {
  fail_in({.file = file, .line = line}, problem);
}

void fail_in_option(const std::string& option, const std::string& problem) {
  fail_in({.about_options = {option}}, fmt::format("{}: {}", option, problem));
}

void fail_in(ErrorLocation location, const std::string& problem) {
  throw InputError(InputError::Kind::relation, std::move(location), problem);
}

}  // namespace hapbench
