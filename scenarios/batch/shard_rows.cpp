#include "scenarios/batch/shard_rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>

#include "scenarios/batch/sweep_points.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/text_lines.hpp"

namespace hapbench {
namespace {

std::size_t cells_in(std::string_view line) {
  return static_cast<std::size_t>(std::count(line.begin(), line.end(), ',')) + 1;
}

}  // namespace

std::string title_line(const Shard& shard, std::size_t runs, std::string_view definition) {
  return fmt::format("# hapbench sweep, shard {} of {} runs, definition {}", shard_text(shard), runs, definition);
}

ShardRows::ShardRows(std::filesystem::path file, std::size_t piece) : piece_(piece) {
  title_.file = std::move(file);
  read_title(line().value_or(""));
  title_.header = line().value_or("");
  if (!title_.header.starts_with("index,")) fail_in_line(title_.file, 2, "is not the header of a sweep's table");
  columns_ = cells_in(title_.header);
  run_ = title_.shard.index;
}

/// Reads what `title_line` writes, and nothing that differs from it.
void ShardRows::read_title(std::string_view line) {
  const Words words = words_of(line);
  if (words.size() == 10) {
    const Words shard = parts_of(words[4], '/');
    const auto index = whole_number(shard.front()), count = whole_number(shard.back()), runs = whole_number(words[6]);
    if (index && count && runs && *index < *count && *count <= kMostRuns && *runs <= kMostRuns) {
      title_.shard = {*index, *count};
      title_.runs = *runs;
      title_.definition = words[9];
      if (line == title_line(title_.shard, title_.runs, title_.definition)) return;
    }
  }
  fail_in_line(title_.file, 1, "is not the table of a shard, as \"hapbench sweep --shard i/n\" writes it");
}

std::optional<std::string_view> ShardRows::next() {
  const auto row = line();
  if (run_ >= title_.runs) {
    if (row) fail_in_line(title_.file, lines_, "got a row behind the last one");
    return std::nullopt;
  }
  if (!row) {
    const std::size_t rows = title_.shard.size(title_.runs);
    fail_in_file(title_.file,
                 fmt::format("ends after {} of {} rows; allowed: complete tables", run_ / title_.shard.count, rows));
  }
  if (cells_in(*row) != columns_) {
    fail_in_line(title_.file, lines_, fmt::format("got {} cells; allowed: {}", cells_in(*row), columns_));
  }
  const std::string_view number = row->substr(0, row->find(','));
  if (whole_number(number) != run_) {
    fail_in_line(title_.file, lines_, fmt::format("got run \"{}\"; allowed: {}, the next of the shard", number, run_));
  }
  run_ += title_.shard.count;
  return row;
}

std::optional<std::string_view> ShardRows::line() {
  std::size_t end = 0;
  while ((end = text_.find('\n', given_)) == std::string::npos) {
    if (read_piece()) continue;
    if (given_ < text_.size()) fail_in_file(title_.file, "ends within a line; allowed: complete tables");
    return std::nullopt;
  }
  const auto line = std::string_view(text_).substr(given_, end - given_);
  given_ = end + 1;
  ++lines_;
  return line;
}

bool ShardRows::read_piece() {
  text_.erase(0, given_);
  given_ = 0;
  std::error_code error;
  std::ifstream in(title_.file, std::ios::binary);
  if (!in || !std::filesystem::is_regular_file(title_.file, error)) fail_in_file(title_.file, "cannot be read");
  in.seekg(static_cast<std::streamoff>(offset_));
  const std::size_t before = text_.size();
  text_.resize(before + piece_);
  in.read(text_.data() + before, static_cast<std::streamsize>(piece_));
  const auto length = static_cast<std::size_t>(in.gcount());
  text_.resize(before + length);
  offset_ += length;
  return length > 0;
}

}  // namespace hapbench
