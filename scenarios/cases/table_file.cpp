#include "scenarios/cases/table_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <utility>

#include "results/io/atomic_file.hpp"
#include "results/io/columns.hpp"
#include "scenarios/format/text_lines.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

fs::path with_ending(fs::path file, const std::string& ending) {
  return file += ending;
}

fs::path beside(fs::path table) {
  return table.replace_extension(".json");
}

/// The definition in the JSON next to a table; empty when there is none to be read.
std::string definition_in(const fs::path& about) {
  std::error_code ignored;
  if (!fs::is_regular_file(about, ignored)) return "";
  try {
    return read_json(about).value("definition", "");
  } catch (const std::exception&) {
    return "";
  }
}

/// The whole lines of a table: the header, then its rows with the numbers of their cases.
class TableLines {
 public:
  TableLines(const fs::path& file, std::size_t cases) : file_(file), cases_(cases), in_(file, std::ios::binary) {}

  /// The next line; false at the end, and where a line has no end.
  bool next() {
    begin_ = end_;
    if (!std::getline(in_, line_) || in_.eof()) return false;
    end_ += line_.size() + 1;
    ++number_;
    return true;
  }
  const std::string& line() const { return line_; }
  std::uintmax_t begin() const { return begin_; }
  /// Returns the offset of the end of the last whole line [bytes].
  std::uintmax_t end() const { return end_; }
  /// The number of the row's case. Throws InputError.
  std::size_t row() const {
    const auto row = whole_number(std::string_view(line_).substr(0, line_.find(',')));
    if (row && *row < cases_) return *row;
    refuse();
  }
  [[noreturn]] void refuse(const std::string& problem) const { fail_in_line(file_, number_, problem); }
  [[noreturn]] void refuse() const {
    refuse(fmt::format("got the row \"{}\"; allowed: rows of this table", line_.substr(0, 60)));
  }

 private:
  fs::path file_;
  std::size_t cases_;
  std::ifstream in_;
  std::string line_;
  std::uintmax_t begin_ = 0, end_ = 0;
  std::size_t number_ = 0;
};

/// Gives the table its rows, those of these files in the order of their numbers, of two of one case the later, and its
/// JSON. Returns their number; when it is not `rows`, writes nothing. Throws InputError for other tables, and IoError.
std::size_t put_in_order(const TableTitle& title, const std::vector<fs::path>& parts, std::size_t rows) {
  // Places as if one file followed the other; 0, where a header stands: no row.
  std::vector<std::uintmax_t> places(title.cases), begins = {0};
  for (const fs::path& part : parts) {
    TableLines lines(part, title.cases);
    if (lines.next() && lines.line() != title.header) lines.refuse();
    while (lines.next()) places[lines.row()] = begins.back() + lines.begin();
    begins.push_back(begins.back() + lines.end());
  }
  const std::size_t found = places.size() - static_cast<std::size_t>(std::ranges::count(places, 0u));
  if (found != rows) return found;
  AtomicFile table(title.file);
  table.append(title.header + "\n");
  std::ifstream in;
  std::size_t opened = parts.size();
  std::string line;
  for (const std::uintmax_t place : places) {
    if (place == 0) continue;
    const auto file = static_cast<std::size_t>(std::ranges::upper_bound(begins, place) - begins.begin()) - 1;
    const auto offset = static_cast<std::streamoff>(place - begins[file]);
    if (std::exchange(opened, file) != file) in = std::ifstream(parts[file], std::ios::binary);
    if (in.tellg() != offset) in.seekg(offset);
    if (!std::getline(in, line)) throw IoError("read", parts[file], std::make_error_code(std::errc::io_error));
    table.append(line + "\n");
  }
  FileSet together;
  together.write(beside(title.file), json_text(title.about));
  together.take(std::move(table));
  together.commit();
  return found;
}

/// The number of shards that the tables of a folder are of; 0 without any. Throws InputError when they are not of one.
std::size_t shards_in(const fs::path& folder) {
  std::size_t count = 0;
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored)) {
    std::size_t index = 0, of = 0;
    if (std::sscanf(entry.path().filename().c_str(), "sweep.%zu_of_%zu.csv", &index, &of) != 2) continue;
    if (entry.path().filename() != table_name(Shard{index, of}) || of > kMostRuns) continue;
    if (count != 0 && of != count) {
      fail_in_file(entry.path(),
                   fmt::format("is one of {} shards, another one of {}; allowed: shards of one division", of, count));
    }
    count = of;
  }
  return count;
}

}  // namespace

std::vector<std::string> csv_cells(std::string_view line) {
  if (line.ends_with('\r')) line.remove_suffix(1);
  std::vector<std::string> cells(1);
  bool in_quotes = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '"' && in_quotes && line.substr(i + 1).starts_with('"')) {
      cells.back() += line[++i];
    } else if (line[i] == '"') {
      in_quotes = !in_quotes;
    } else if (line[i] == ',' && !in_quotes) {
      cells.emplace_back();
    } else {
      cells.back() += line[i];
    }
  }
  return cells;
}

TableFile::TableFile(TableTitle title, const Keep& keep)
    : title_(std::move(title)),
      part_(with_ending(title_.file, ".part")),
      about_part_(with_ending(beside(title_.file), ".part")),
      out_(nullptr, std::fclose),
      has_(title_.cases) {
  std::error_code error;
  const std::size_t rows = rows_under_way(title_.file);
  if (keep) {
    resume(keep);
  } else if (rows > 0 && is_of_this_definition()) {
    fail_in_file(part_, fmt::format("holds {} finished runs of this sweep, which was interrupted; allowed: --resume to "
                                    "go on from there, another --out, or to begin anew without this file",
                                    rows));
  }
  const bool is_new = !keep || !fs::exists(part_, error) || fs::file_size(part_, error) == 0;
  if (is_new) {
    fs::remove(part_, error);  // first: a kill must not leave its rows beside another description
    write_file_atomically(about_part_, json_text(title_.about));
  }
  out_.reset(std::fopen(part_.c_str(), is_new ? "wbe" : "abe"));
  if (!out_) throw IoError("write", part_, {errno, std::generic_category()});
  std::setvbuf(out_.get(), nullptr, _IONBF, 0);  // so that a line is written at once
  if (is_new) append(title_.header + "\n");
}

/// True if the table under way, or else the finished one, has this definition.
bool TableFile::is_of_this_definition() const {
  std::error_code ignored;
  return definition_in(fs::exists(part_, ignored) ? about_part_ : beside(title_.file)) == title_.about.at("definition");
}

/// Finds the rows that are there, and leaves the part without its last line if that is torn.
void TableFile::resume(const Keep& keep) {
  std::error_code error;
  const bool is_part = fs::exists(part_, error);
  if (!is_part && !fs::exists(title_.file, error)) return;
  if (!is_of_this_definition()) {
    fail_in_file(
        is_part ? part_ : title_.file,
        "is not the table of this sweep; --resume needs the same scenario, --set, --vary, --shard, named files, "
        "plugins and program; without --resume the sweep begins anew");
  }
  if (!is_part) {
    write_file_atomically(about_part_, json_text(title_.about));
    fs::copy_file(title_.file, part_, error);
    if (error) throw IoError("write", part_, error);
  }
  TableLines lines(part_, title_.cases);
  if (lines.next() && lines.line() != title_.header) lines.refuse();
  while (lines.next()) {
    const std::size_t i = lines.row();
    try {
      has_[i] = keep(i, lines.line());
    } catch (const InputError& refusal) {
      lines.refuse(refusal.problem());
    }
  }
  count_ = static_cast<std::size_t>(std::count(has_.begin(), has_.end(), true));
  fs::resize_file(part_, lines.end(), error);
  if (error) throw IoError("write", part_, error);
}

std::size_t TableFile::rows_under_way(const fs::path& file) {
  std::size_t lines = 0;
  for (TableLines table(with_ending(file, ".part"), 0); table.next();) ++lines;
  return lines - std::min<std::size_t>(lines, 1);
}

void TableFile::append(const std::string& text) {
  if (std::fwrite(text.data(), 1, text.size(), out_.get()) != text.size())
    throw IoError("write", part_, {errno, std::generic_category()});
}

void TableFile::add(std::size_t i, std::string_view row) {
  append(std::string(row) + "\n");
  if (!has_[i]) ++count_;
  has_[i] = true;
}

void TableFile::finish() {
  out_.reset();
  if (put_in_order(title_, {part_}, count_) != count_)  // another process has begun it anew
    throw IoError("read", part_, std::make_error_code(std::errc::io_error));
  std::error_code ignored;
  for (const fs::path& part : {part_, about_part_}) fs::remove(part, ignored);
}

std::string table_name(const std::optional<Shard>& shard) {
  return shard ? fmt::format("sweep.{}_of_{}.csv", shard->index, shard->count) : "sweep.csv";
}

bool join_shards(const fs::path& folder) {
  constexpr std::size_t kMostShown = 10;
  const std::size_t count = shards_in(folder);
  const fs::path whole = folder / table_name(std::nullopt);
  std::error_code ignored;
  std::vector<fs::path> shards;
  std::vector<std::string> missing;
  for (std::size_t i = 0; i < count; ++i) {
    shards.push_back(folder / table_name(Shard{i, count}));
    if (!fs::exists(shards.back(), ignored)) missing.push_back(shard_text({i, count}));
  }
  if (count == 0 || (!missing.empty() && fs::exists(whole, ignored))) return false;
  if (const std::size_t lack = missing.size(); lack > 0) {
    missing.resize(std::min(lack, kMostShown));
    throw InputError(fmt::format("{}: {} of {} shards missing: {}{}", folder.string(), lack, count,
                                 fmt::join(missing, ", "), lack > kMostShown ? ", ..." : ""));
  }
  TableTitle title{whole, "", read_json(beside(shards[0]))};
  const std::string definition = title.about.value("definition", "");
  for (const fs::path& shard : shards) {
    if (const std::string other = definition_in(beside(shard)); other != definition) {
      fail_in_file(shard,
                   fmt::format("is of another sweep than {}: definition {}, there {}; allowed: shards of one sweep",
                               shards[0].string(), other, definition));
    }
  }
  title.cases = std::min(title.about.value("runs", std::size_t{0}), kMostRuns);
  title.about["shard"] = shard_text({});
  TableLines first(shards[0], 0);
  first.next();
  title.header = first.line();
  if (const std::size_t found = put_in_order(title, shards, title.cases); found != title.cases) {
    throw InputError(fmt::format("{}: the shards have {} of {} rows; allowed: complete tables", folder.string(), found,
                                 title.cases));
  }
  return true;
}

}  // namespace hapbench
