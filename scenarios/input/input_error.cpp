#include "scenarios/input/input_error.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace hapbench {

std::string one_line(std::string text) {
  std::ranges::replace_if(
      text, [](unsigned char c) { return c < 0x20 || c == 0x7f; }, '?');
  return text;
}

InputError InputError::all(const std::vector<InputError>& errors) {
  std::vector<InputError> faults;
  for (const InputError& error : errors) {
    const std::vector<InputError> more = error.faults();
    faults.insert(faults.end(), more.begin(), more.end());
  }
  std::stable_partition(faults.begin(), faults.end(), [](const InputError& e) { return e.kind() == Kind::shape; });
  if (faults.size() > kMostFaults) faults.erase(faults.begin() + kMostFaults, faults.end());
  InputError first = std::move(faults.front());
  first.more_.assign(faults.begin() + 1, faults.end());
  return first;
}

std::vector<InputError> InputError::faults() const {
  std::vector<InputError> faults = {InputError(kind_, place_, problem_)};
  faults.insert(faults.end(), more_.begin(), more_.end());
  return faults;
}

void fail_at(const std::string& place, const std::string& problem) {
  throw InputError(InputError::Kind::relation, place, problem);
}

void fail_in_file(const std::filesystem::path& file, const std::string& problem) {
  fail_at(file.string(), problem);
}

void fail_in_line(const std::filesystem::path& file, std::size_t line, const std::string& problem) {
  fail_at(fmt::format("{}, line {}", file.string(), line), problem);
}

}  // namespace hapbench
