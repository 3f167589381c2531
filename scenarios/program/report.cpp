#include "scenarios/program/report.hpp"

namespace hapbench {

std::string printed(const Cell& cell, const Shown& shown, const std::optional<double>& tolerance) {
  if (const auto* number = std::get_if<double>(&cell)) {
    return tolerance ? deserved(shown.factor * *number, shown.factor * *tolerance, shown.digits)
                     : significant(shown.factor * *number, shown.digits);
  }
  if (const auto* count = std::get_if<std::uint64_t>(&cell)) return std::to_string(*count);
  if (const auto* yes = std::get_if<bool>(&cell)) return *yes ? "yes" : "no";
  if (const auto* text = std::get_if<std::string>(&cell)) return *text;
  return "-";
}

void Report::fault(const std::string& text, int status) {
  faults_.push_back(text);
  status_ = status;
}

int Report::finish() {
  files_.commit();
  for (const std::string& fault : faults_) print_error(fault);
  print(output_, text_, json_);
  return status_;
}

}  // namespace hapbench
