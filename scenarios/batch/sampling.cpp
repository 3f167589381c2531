#include "scenarios/batch/sampling.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <numeric>
#include <optional>

#include "scenarios/batch/csv_cells.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/number_table.hpp"
#include "scenarios/input/text_file.hpp"
#include "scenarios/input/text_lines.hpp"
#include "sim/core/random.hpp"

namespace hapbench {

Sampling parse_sampling(const std::string& text, std::uint64_t seed) {
  const Words parts = parts_of(text, ':');
  const std::string_view name = parts[0];
  if (name == "sobol") {
    fail_in_option("--sample",
                   "\"sobol\" is no longer known; instead: lhs:N, or --points FILE.csv with the points of another "
                   "program");
  }
  const auto count = parts.size() == 2 ? whole_number(parts[1]) : std::nullopt;
  if ((name != kLatinHypercube && name != kRandomPoints) || !count || *count < 1 || *count > kMaxRuns) {
    fail_in_option("--sample", fmt::format("got \"{}\"; allowed: lhs:N or random:N with 1 <= N <= {}", text, kMaxRuns));
  }
  return {name == kLatinHypercube ? kLatinHypercube : kRandomPoints, *count, seed, {}};
}

std::vector<double> unit_sample(const Sampling& sampling, std::size_t axis) {
  if (sampling.method == kPointsOfFile) return sampling.of_file[axis];
  // Largest double below 1: rounding could otherwise move a point of the last interval to 1.
  constexpr double kLast = 1.0 - 0x1.0p-53;
  Random random(Random::derive(sampling.seed, axis));
  std::vector<double> points(sampling.count);
  if (sampling.method == kRandomPoints) {
    for (double& point : points) point = random.uniform();
    return points;
  }
  // Latin hypercube: shuffle the intervals, and draw a point in each.
  std::vector<std::size_t> strata(sampling.count);
  std::iota(strata.begin(), strata.end(), std::size_t{0});
  random.shuffle(strata);
  for (std::size_t i = 0; i < points.size(); ++i)
    points[i] =
        std::min((static_cast<double>(strata[i]) + random.uniform()) / static_cast<double>(points.size()), kLast);
  return points;
}

namespace {

/// Splits the lines of a file of --points into cells. Skips blank lines and comments.
class PointLines {
 public:
  /// Reads the header, which gives the paths of the fields. If the first line that is not a comment has paths, this
  /// line is the header. If it has values instead, the header is the last comment with paths above it.
  PointLines(std::string_view text, const std::filesystem::path& file) : lines_(text), file_(file) {
    std::string_view comment;
    std::size_t comment_line = 0;
    for (LineReader before = lines_; const auto line = lines_.next(); before = lines_) {
      if (words_of(*line).empty()) continue;
      header_line_ = lines_.line();
      if (is_comment(*line)) {
        const std::string_view names = line->substr(line->find_first_not_of(" \t#%"));
        if (has_paths(cells_of_header(names))) {
          comment = names;
          comment_line = header_line_;
        }
        continue;
      }
      const bool is_header = comment.empty() || has_paths(cells_of_header(*line));
      paths_ = cells_of_header(is_header ? *line : comment);
      if (!is_header) {
        header_line_ = comment_line;
        lines_ = before;
      }
      break;
    }
    if (paths_.empty()) fail_in_file(file, "has no rows; allowed: a header of fields, and rows of their values");
    check_paths();
  }

  const std::vector<std::string>& paths() const { return paths_; }
  std::size_t line() const { return lines_.line(); }

  /// Returns the cells of the next row; nothing at the end of the text.
  std::optional<std::vector<std::string>> next() {
    auto line = lines_.next();
    while (line && (words_of(*line).empty() || is_comment(*line))) line = lines_.next();
    if (!line) return std::nullopt;
    std::vector<std::string> cells = trimmed_cells(*line);
    while (cells.size() > paths_.size() && cells.back().empty()) cells.pop_back();
    return cells;
  }

  /// Returns the probable cause of a row with a wrong number of cells.
  std::string cause(const std::vector<std::string>& cells) const {
    return cause_of_cell_count(fmt::format("{}", fmt::join(cells, std::string(1, separator_))), separator_,
                               cells.size(), paths_.size());
  }

 private:
  /// Returns true if each cell may be the path of a field, and at least one path has a dot.
  static bool has_paths(const std::vector<std::string>& cells) {
    const auto is_path = [](const std::string& cell) {
      return !cell.empty() && std::isalpha(static_cast<unsigned char>(cell[0])) != 0;
    };
    const auto has_dot = [](const std::string& cell) { return cell.find('.') != std::string::npos; };
    return std::ranges::all_of(cells, is_path) && std::ranges::any_of(cells, has_dot);
  }

  std::vector<std::string> cells_of_header(std::string_view line) {
    separator_ = separator_in(line);
    std::vector<std::string> cells = trimmed_cells(line);
    while (cells.size() > 1 && cells.back().empty()) cells.pop_back();
    return cells;
  }

  std::vector<std::string> trimmed_cells(std::string_view line) const {
    if (separator_ == ' ') {
      const Words words = words_of(line);
      return {words.begin(), words.end()};
    }
    std::vector<std::string> cells = csv_cells(line, separator_);
    for (std::string& cell : cells) {
      cell.erase(0, std::min(cell.find_first_not_of(" \t\r"), cell.size()));
      cell.erase(cell.find_last_not_of(" \t\r") + 1);
    }
    return cells;
  }

  void check_paths() const {
    const auto outcome = std::ranges::find(paths_, "outcome");
    if (paths_.front() == "index" && outcome != paths_.end())
      fail_in_line(
          file_, header_line_,
          fmt::format("is the result of a sweep; allowed: a table of fields and their values: of this file, the "
                      "columns 2 to {}, before \"outcome\"",
                      outcome - paths_.begin()));
    for (std::size_t i = 0; i < paths_.size(); ++i) {
      if (paths_[i].find_first_of("[(") != std::string::npos)
        fail_in_line(file_, header_line_,
                     fmt::format("got {}; allowed: paths without units; the values have the unit of the field, which "
                                 "\"hapbench describe FIELD\" states",
                                 quoted_token(paths_[i])));
      if (paths_[i].empty())
        fail_in_line(file_, header_line_, fmt::format("column {} has no name; allowed: the path of a field", i + 1));
      const auto first = std::ranges::find(paths_, paths_[i]) - paths_.begin();
      if (first < static_cast<std::ptrdiff_t>(i))
        fail_in_line(file_, header_line_,
                     fmt::format("columns {} and {} are both named {}; allowed: each field once", first + 1, i + 1,
                                 quoted_token(paths_[i])));
    }
  }

  LineReader lines_;
  const std::filesystem::path& file_;
  char separator_ = ',';
  std::size_t header_line_ = 0;
  std::vector<std::string> paths_;
};

/// Returns the value of a cell of --points. Throws InputError if the value is missing, not finite, or a number with a
/// decimal comma.
std::string point_value(const std::string& cell, const std::string& path) {
  const std::string lower = lower_case(cell);
  if (has_decimal_comma(cell))
    throw InputError(
        fmt::format("{}: got {} with a decimal comma; allowed: a decimal point", path, quoted_token(cell)));
  if (lower == "nan" || lower == "-nan" || lower == "inf" || lower == "-inf")
    throw InputError(fmt::format("{}: got {}; allowed: a finite number", path, quoted_token(cell)));
  try {
    return axis_value(cell);
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", path, error.problem()));
  }
}

}  // namespace

Sampling read_points(const std::filesystem::path& file, std::vector<Axis>& axes) {
  const std::string text = read_named_file(file);
  PointLines lines(text, file);
  for (const std::string& path : lines.paths()) {
    axes.push_back({path});
    axes.back().option = "--points";
  }
  Sampling sampling{kPointsOfFile, 0, 0, std::vector<std::vector<double>>(axes.size()), file};
  std::vector<std::map<std::string, std::size_t>> value_indices(axes.size());
  RowFaults faults;
  // Collect the different values of each field. For each point, store the index of its value; the last loop replaces
  // the index by a coordinate.
  while (const auto cells = lines.next()) {
    if (cells->size() != axes.size() || sampling.count == kMaxRuns) {
      faults.add(lines.line(),
                 fmt::format("got {} values in row {}; allowed: {}, one of each field, in at most {} rows{}",
                             cells->size(), sampling.count + 1, axes.size(), kMaxRuns,
                             cells->size() == axes.size() ? "" : lines.cause(*cells)));
      continue;
    }
    ++sampling.count;
    sampling.lines.push_back(lines.line());
    try {
      for (std::size_t a = 0; a < cells->size(); ++a) {
        const std::string value = point_value((*cells)[a], axes[a].path);
        const auto [at, is_new] = value_indices[a].emplace(value, value_indices[a].size());
        if (is_new) axes[a].values.push_back(value);
        sampling.of_file[a].push_back(static_cast<double>(at->second));
      }
    } catch (const InputError& error) {
      faults.add(lines.line(), error.problem());
    }
  }
  faults.throw_if_any(file);
  if (const std::string cut = warning_of_cut_line(text); !cut.empty())
    sampling.warning = fmt::format("{}: {}", file.string(), cut);
  if (sampling.count == 0) fail_in_file(file, "has no rows; allowed: a header of fields, and rows of their values");
  // Replace each index by a coordinate: the middle of the part of [0, 1) that belongs to the value (Axis::index_at).
  for (std::size_t a = 0; a < axes.size(); ++a)
    for (double& coordinate : sampling.of_file[a])
      coordinate = (coordinate + 0.5) / static_cast<double>(axes[a].size());
  return sampling;
}

}  // namespace hapbench
