#include "scenarios/batch/table_lines.hpp"

#include <fmt/format.h>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/text_lines.hpp"

namespace hapbench {

TableLines::TableLines(const std::filesystem::path& file, std::size_t cases)
    : file_(file), cases_(cases), in_(file, std::ios::binary) {}

bool TableLines::next() {
  begin_ = end_;
  if (!std::getline(in_, line_) || in_.eof()) return false;
  end_ += line_.size() + 1;
  ++number_;
  return true;
}

std::size_t TableLines::row() const {
  const auto row = whole_number(std::string_view(line_).substr(0, line_.find(',')));
  if (row && *row < cases_) return *row;
  refuse();
}

void TableLines::refuse(const std::string& problem) const {
  fail_in_line(file_, number_, problem);
}

void TableLines::refuse() const {
  refuse(fmt::format("got the row \"{}\"; allowed: rows of this table", line_.substr(0, 60)));
}

}  // namespace hapbench
