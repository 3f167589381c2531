#include "scenarios/batch/table_file.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstdint>
#include <fstream>
#include <optional>
#include <system_error>
#include <utility>

#include "results/io/atomic_file.hpp"
#include "results/io/columns.hpp"
#include "scenarios/batch/table_description.hpp"
#include "scenarios/batch/table_lines.hpp"
#include "scenarios/input/input_error.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

fs::path part_of(fs::path file) {
  return file += ".part";
}

}  // namespace

TableFile::TableFile(TableTitle title, const Keep& keep)
    : title_(std::move(title)),
      part_(part_of(title_.file)),
      about_part_(part_of(description_file(title_.file))),
      out_(nullptr, std::fclose),
      has_(title_.cases) {
  std::error_code error;
  // Continue the unfinished table, or refuse to overwrite it.
  const std::size_t rows = rows_in_progress(title_.file);
  if (keep) {
    resume(keep);
  } else if (rows > 0) {
    const bool is_same = has_same_definition();
    fail_in_file(
        part_,
        fmt::format(
            "holds {} finished runs of {} sweep, which was interrupted; allowed: {}another --out, or to start again "
            "after removing this file",
            rows, is_same ? "this" : "another", is_same ? "--resume to continue, " : ""));
  }
  // Start a new .part file, or append to it.
  const bool is_new = !keep || !fs::exists(part_, error) || fs::file_size(part_, error) == 0;
  if (is_new) {
    // Remove the old rows before the description is replaced: if the process is killed between these two operations,
    // old rows must not remain next to a new description.
    fs::remove(part_, error);
    write_file_atomically(about_part_, json_text(title_.about));
  }
  out_.reset(std::fopen(part_.c_str(), is_new ? "wbe" : "abe"));
  if (!out_) throw IoError("write", part_, {errno, std::generic_category()});
  std::setvbuf(out_.get(), nullptr, _IONBF, 0);  // unbuffered, so that a row is written immediately
  if (is_new) append(title_.header + "\n");
}

/// Returns true if the unfinished table has the same definition as title_. Without an unfinished table, checks the
/// finished table.
bool TableFile::has_same_definition() const {
  std::error_code ignored;
  const std::string found = definition_in(fs::exists(part_, ignored) ? about_part_ : description_file(title_.file));
  return title_.about.at("definition") == found;
}

/// Finds the rows that can be kept, and removes an incomplete last line from the .part file.
void TableFile::resume(const Keep& keep) {
  std::error_code error;
  const bool is_part = fs::exists(part_, error);
  if (!is_part && !fs::exists(title_.file, error)) return;
  if (is_part && !fs::exists(about_part_, error))
    fail_in_file(part_, fmt::format("its description {} is missing; allowed: another --out, or to start again after "
                                    "removing this file",
                                    about_part_.string()));
  if (!has_same_definition()) {
    fail_in_file(
        is_part ? part_ : title_.file,
        fmt::format("is not the table of this sweep; --resume needs the same scenario, --set, --vary, "
                    "--shard, named files, plugins and program; allowed: another --out, or {}",
                    is_part ? "to start again after removing this file" : "no --resume, which replaces this file"));
  }
  if (!is_part) {
    write_file_atomically(about_part_, json_text(title_.about));
    fs::copy_file(title_.file, part_, error);
    if (error) throw IoError("write", part_, error);
  }
  // Call `keep` for each complete row.
  TableLines lines(part_, title_.cases);
  if (lines.next() && lines.line() != title_.header) lines.refuse();
  while (lines.next()) {
    const std::size_t i = lines.row();
    if (has_[i]) lines.refuse(fmt::format("a second row of run {}; allowed: each run once", i));
    try {
      has_[i] = keep(i, lines.line());
    } catch (const InputError& refusal) {
      lines.refuse(refusal.problem());
    }
  }
  fs::resize_file(part_, lines.end(), error);
  if (error) throw IoError("write", part_, error);
}

std::size_t TableFile::rows_in_progress(const fs::path& file) {
  std::size_t lines = 0;
  for (TableLines table(part_of(file), 0); table.next();) ++lines;
  return lines - std::min<std::size_t>(lines, 1);
}

void TableFile::append(const std::string& text) {
  if (std::fwrite(text.data(), 1, text.size(), out_.get()) != text.size())
    throw IoError("write", part_, {errno, std::generic_category()});
}

void TableFile::add(std::size_t i, std::string_view row) {
  append(std::string(row) + "\n");
  has_[i] = true;
}

void TableFile::finish() {
  out_.reset();
  if (write_sorted_table(title_, {part_}, count()) != count())
    throw IoError("complete, because another process has restarted it,", part_,
                  std::make_error_code(std::errc::device_or_resource_busy));
  std::error_code ignored;
  for (const fs::path& part : {part_, about_part_}) fs::remove(part, ignored);
}

std::size_t write_sorted_table(const TableTitle& title, const std::vector<fs::path>& parts, std::size_t rows) {
  // Offset of the row of each case, counted as if all files were concatenated. 0 means that there is no row, because
  // the offset 0 belongs to a header.
  std::vector<std::uintmax_t> offsets(title.cases), file_starts = {0};
  for (const fs::path& part : parts) {
    TableLines lines(part, title.cases);
    if (lines.next() && lines.line() != title.header) lines.refuse();
    while (lines.next()) offsets[lines.row()] = file_starts.back() + lines.begin();
    file_starts.push_back(file_starts.back() + lines.end());
  }
  const std::size_t found = offsets.size() - static_cast<std::size_t>(std::ranges::count(offsets, 0u));
  if (found != rows) return found;
  // Copy the rows in the order of their cases.
  AtomicFile table(title.file);
  table.append(title.header + "\n");
  std::ifstream in;
  std::size_t opened = parts.size();
  std::string line;
  for (const std::uintmax_t row_offset : offsets) {
    if (row_offset == 0) continue;
    const auto file =
        static_cast<std::size_t>(std::ranges::upper_bound(file_starts, row_offset) - file_starts.begin()) - 1;
    const auto offset = static_cast<std::streamoff>(row_offset - file_starts[file]);
    if (std::exchange(opened, file) != file) in = std::ifstream(parts[file], std::ios::binary);
    if (in.tellg() != offset) in.seekg(offset);
    if (!std::getline(in, line)) throw IoError("read", parts[file], std::make_error_code(std::errc::io_error));
    table.append(line + "\n");
  }
  // Both files appear at the same time.
  FileSet files;
  files.write(description_file(title.file), json_text(title.about));
  files.take(std::move(table));
  files.commit();
  return found;
}

}  // namespace hapbench
