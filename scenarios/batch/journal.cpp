#include "scenarios/batch/journal.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <iterator>
#include <utility>

#include "scenarios/input/input_error.hpp"
#include "sim/core/hash.hpp"

namespace hapbench {
namespace {

constexpr std::size_t kSumLength = 16;

std::error_code last_error() {
  return {errno, std::generic_category()};
}

std::string title_line(const std::string& sweep) {
  return "hapbench sweep journal 1, " + sweep + "\n";
}

std::string line_of(std::string_view row) {
  return hash_text(hash_of(row)) + " " + std::string(row) + "\n";
}

/// The row in a line without its end; empty if the line is damaged.
std::string_view row_in(std::string_view line) {
  if (line.size() <= kSumLength || line[kSumLength] != ' ') return {};
  const std::string_view row = line.substr(kSumLength + 1);
  return line.substr(0, kSumLength) == hash_text(hash_of(row)) ? row : std::string_view();
}

/// Reports the rows of a file from the current line, which begins at `place`, to the first torn or damaged one. Returns
/// the place of the end of the last.
Journal::Place read_intact(std::istream& in, Journal::Place place, const Journal::Found& found) {
  for (std::string line; std::getline(in, line) && !in.eof(); place += line.size() + 1) {
    const std::string_view row = row_in(line);
    if (row.empty()) break;
    if (found) found(place, row);
  }
  return place;
}

}  // namespace

Journal::Journal(std::filesystem::path file, const std::string& sweep, bool resume, const Found& found)
    : file_(std::move(file)) {
  // Non-blocking, because opening a pipe would wait for its other end.
  descriptor_ = ::open(file_.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0666);
  if (descriptor_ < 0) throw IoError("create", file_, last_error());
  try {
    struct stat status {};
    if (::fstat(descriptor_, &status) != 0 || !S_ISREG(status.st_mode)) fail_in_file(file_, "is no file");
    if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)
      fail_in_file(file_, "another sweep is writing to this directory; allowed: one at a time");
    const std::string first_line = title_line(sweep);
    if (resume) this->resume(first_line, found);
    if (::ftruncate(descriptor_, static_cast<off_t>(end_)) != 0) throw IoError("write", file_, last_error());
    if (end_ == 0) {
      unwritten_ = first_line;
      flush();
    }
  } catch (...) {
    ::close(descriptor_);
    throw;
  }
}

Journal::~Journal() {
  try {
    flush();
  } catch (const IoError&) {
    // The runs can be repeated.
  }
  ::close(descriptor_);
}

bool Journal::is_of(const std::filesystem::path& file, const std::string& sweep) {
  const std::string expected = title_line(sweep);
  std::string found(expected.size(), '\0');
  std::ifstream in(file, std::ios::binary);
  return in.read(found.data(), static_cast<std::streamsize>(found.size())) && found == expected;
}

bool Journal::is_being_written(const std::filesystem::path& file) {
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) return false;
  const bool locked = ::flock(descriptor, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  ::close(descriptor);
  return locked;
}

std::size_t Journal::count_rows(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  const auto lines = std::count(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>(), '\n');
  return static_cast<std::size_t>(std::max<std::ptrdiff_t>(lines - 1, 0));
}

/// Finds the end of the last intact row, and reports all rows before it.
void Journal::resume(const std::string& first_line, const Found& found) {
  std::ifstream in(file_, std::ios::binary);
  std::string line;
  // A line without its end is torn.
  if (!std::getline(in, line) || in.eof()) return;
  if (line + "\n" != first_line) {
    fail_in_file(
        file_,
        "is not the journal of this sweep; --resume needs the same scenario, --set, --vary, --shard, --keep-runs, "
        "named files, plugins and program; without --resume the sweep begins anew");
  }
  end_ = read_intact(in, first_line.size(), found);
}

void Journal::read_rows(const Found& found) const {
  std::ifstream in(file_, std::ios::binary);
  std::string title;
  std::getline(in, title);
  if (read_intact(in, title.size() + 1, found) != end_)
    throw IoError("read", file_, std::make_error_code(std::errc::io_error));
}

Journal::Place Journal::add(std::string_view row) {
  const Place place = end_ + unwritten_.size();
  unwritten_ += line_of(row);
  return place;
}

void Journal::flush() {
  const std::string lines = std::exchange(unwritten_, {});  // are not written again after an error
  for (std::string_view text = lines; !text.empty();) {
    const ::ssize_t written = ::write(descriptor_, text.data(), text.size());
    if (written < 0 && errno != EINTR) throw IoError("write", file_, last_error());
    if (written > 0) text.remove_prefix(static_cast<std::size_t>(written));
  }
  end_ += lines.size();
}

std::string Journal::row_at(Place place) {
  if (!reader_.is_open()) reader_.open(file_, std::ios::binary);
  reader_.clear();
  std::string line;
  const auto offset = static_cast<std::streamoff>(place);
  if (reader_.tellg() != offset) reader_.seekg(offset);
  // A row without its line end has not been flushed.
  if (std::getline(reader_, line) && !reader_.eof()) return line.substr(kSumLength + 1);
  throw IoError("read", file_, std::make_error_code(std::errc::io_error));
}

void Journal::remove() noexcept {
  unwritten_.clear();
  ::unlink(file_.c_str());
}

}  // namespace hapbench
