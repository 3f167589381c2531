#include "scenarios/import/sample_source.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/input/mesh_formats.hpp"
#include "scenarios/input/text_lines.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostColumns = 1000;

/// A field of a HAPI log and the columns it takes.
struct HapiField {
  std::string_view name;
  std::size_t width;
};

constexpr HapiField kHapiFields[] = {
    {"TIME", 1},         {"TIMESTAMP", 1}, {"POSITION", 3},  {"ORIENTATION", 4},  {"VELOCITY", 3},
    {"FORCE", 3},        {"TORQUE", 3},    {"BUTTONS", 1},   {"RAW_POSITION", 3}, {"RAW_ORIENTATION", 4},
    {"RAW_VELOCITY", 3}, {"RAW_FORCE", 3}, {"RAW_TORQUE", 3}};

const HapiField& hapi_field(std::string_view name, const fs::path& file) {
  const auto found = std::find_if(std::begin(kHapiFields), std::end(kHapiFields),
                                  [name](const HapiField& field) { return field.name == name; });
  if (found != std::end(kHapiFields)) return *found;
  std::vector<std::string> valid;
  for (const HapiField& field : kHapiFields) valid.emplace_back(field.name);
  fail_in_line(file, 1,
               fmt::format("unknown field {}; allowed: the names of a HAPI log{}", quoted_word(name),
                           nearest_name_hint(name, valid)));
}

/// POSITION_x, POSITION_y, POSITION_z; ORIENTATION ends with _angle.
void add_hapi_columns(std::vector<std::string>& names, const HapiField& field, const fs::path& file) {
  constexpr const char* kEnds[] = {"_x", "_y", "_z", "_angle"};
  const std::string first = std::string(field.name) + (field.width > 1 ? kEnds[0] : "");
  if (std::find(names.begin(), names.end(), first) != names.end())
    fail_in_line(file, 1, fmt::format("field {} twice; allowed: once", quoted_word(field.name)));
  for (std::size_t i = 0; i < field.width; ++i)
    names.push_back(std::string(field.name) + (field.width > 1 ? kEnds[i] : ""));
}

std::string_view without_blanks(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r";
  const std::size_t first = text.find_first_not_of(kBlank);
  return first == std::string_view::npos ? "" : text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

class TextSource final : public SampleSource {
 public:
  TextSource(StrokeFormat format, std::string_view text, const fs::path& file)
      : lines_(text.starts_with("\xef\xbb\xbf") ? text.substr(3) : text) {
    LineReader before = lines_;
    if (!next_line()) fail_in_file(file, "no samples; allowed: a line for each");
    if (format == StrokeFormat::csv) {
      for (const char c : {',', ';', '\t'}) {
        if (separator_ == ' ' && line_.find(c) != std::string_view::npos) separator_ = c;
      }
    }
    const Words words = cells_of(line_);
    if (format == StrokeFormat::hapi) {
      for (const std::string_view word : words) add_hapi_columns(names_, hapi_field(word, file), file);
      return;
    }
    if (words.size() > kMostColumns)
      fail_in_line(file, lines_.line(), fmt::format("got {} columns; allowed: {}", words.size(), kMostColumns));
    const bool has_names = std::none_of(words.begin(), words.end(), [](auto word) { return finite_number(word); });
    for (const std::string_view word : words) names_.emplace_back(has_names ? word : "");
    if (!has_names) lines_ = before;
  }

  bool next() override {
    if (!next_line()) return false;
    cells_ = cells_of(line_);
    return true;
  }
  std::optional<double> value(std::size_t column) const override { return finite_number(cells_[column]); }
  std::string shown_value(std::size_t column) const override { return quoted_word(cells_[column]); }
  std::string problem() const override {
    if (cells_.size() == names_.size()) return "";
    return fmt::format("got {} values; allowed: {}", cells_.size(), names_.size());
  }
  std::size_t row() const override { return lines_.line(); }
  const char* row_word() const override { return "line"; }

 private:
  bool next_line() {
    while (const auto line = lines_.next()) {
      line_ = without_blanks(*line);
      if (!line_.empty() && line_[0] != '#' && line_[0] != '%') return true;
    }
    return false;
  }
  Words cells_of(std::string_view line) const {
    if (separator_ == ' ') return words_of(line);
    Words cells = parts_of(line, separator_);
    for (std::string_view& cell : cells) {
      cell = without_blanks(cell);
      if (cell.size() > 1 && cell.front() == '"' && cell.back() == '"') cell = cell.substr(1, cell.size() - 2);
    }
    return cells;
  }

  LineReader lines_;
  std::string_view line_;
  char separator_ = ' ';
  Words cells_;
};

class HapiBinarySource final : public SampleSource {
 public:
  HapiBinarySource(std::string_view bytes, const fs::path& file, bool floats)
      : number_bytes_(floats ? sizeof(float) : sizeof(double)) {
    rest_ = bytes;
    for (std::string_view name; !(name = take_name(file)).empty();) {
      const HapiField& field = hapi_field(name, file);
      add_hapi_columns(names_, field, file);
      for (std::size_t i = 0; i < field.width; ++i) {
        places_.push_back(sample_bytes_);
        sample_bytes_ += field.name == "BUTTONS" ? sizeof(std::int32_t) : number_bytes_;
      }
    }
    if (names_.empty()) fail_in_file(file, "no field names; allowed: those of a binary HAPI log, each ended by NUL");
  }

  bool next() override {
    if (rest_.size() < sample_bytes_) return false;
    sample_ = rest_.substr(0, sample_bytes_);
    rest_.remove_prefix(sample_bytes_);
    ++row_;
    return true;
  }
  std::optional<double> value(std::size_t column) const override {
    const double found = number(column);
    return std::isfinite(found) ? std::optional(found) : std::nullopt;
  }
  std::string shown_value(std::size_t column) const override { return fmt::format("{}", number(column)); }
  std::size_t row() const override { return row_; }
  const char* row_word() const override { return "sample"; }
  std::string remark() const override {
    if (rest_.empty()) return "";
    return fmt::format(
        "behind sample {} are {} bytes, less than the {} of a sample: the log was cut off, or its numbers are {}", row_,
        rest_.size(), sample_bytes_, number_bytes_ == sizeof(double) ? "floats (--floats)" : "doubles (no --floats)");
  }

 private:
  std::string_view take_name(const fs::path& file) {
    const std::size_t end = rest_.find('\0');
    constexpr std::size_t kLongestName = 64;
    if (end == std::string_view::npos || end > kLongestName)
      fail_in_file(file,
                   fmt::format("no NUL within {} bytes behind field name {}; allowed: a binary HAPI log (a text log "
                               "has --format hapi)",
                               kLongestName, names_.size() + 1));
    const std::string_view name = rest_.substr(0, end);
    rest_.remove_prefix(end + 1);
    return name;
  }
  double number(std::size_t column) const {
    ByteReader reader(sample_.substr(places_[column]), std::endian::little);
    if (names_[column] == "BUTTONS") return reader.take<std::int32_t>();
    return number_bytes_ == sizeof(float) ? static_cast<double>(reader.take<float>()) : reader.take<double>();
  }

  std::string_view rest_;
  std::size_t number_bytes_;
  std::size_t sample_bytes_ = 0;
  std::vector<std::size_t> places_;  ///< of each column in a sample [bytes]
  std::string_view sample_;
  std::size_t row_ = 0;
};

}  // namespace

std::unique_ptr<SampleSource> open_samples(StrokeFormat format, std::string_view bytes, const fs::path& file,
                                           bool floats) {
  if (format == StrokeFormat::hapi_binary) return std::make_unique<HapiBinarySource>(bytes, file, floats);
  return std::make_unique<TextSource>(format, bytes, file);
}

}  // namespace hapbench
