#include "scenarios/batch/journal.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <fstream>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/number_table.hpp"
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

/// The row of a line without its end, or nothing.
std::string_view row_in(std::string_view line) {
  if (line.size() <= kSumLength || line[kSumLength] != ' ') return {};
  const std::string_view row = line.substr(kSumLength + 1);
  return line.substr(0, kSumLength) == hash_text(hash_of(row)) ? row : std::string_view();
}

}  // namespace

Journal::Journal(std::filesystem::path file, const std::string& sweep, bool resume) : file_(std::move(file)) {
  // Non-blocking, or a pipe would wait for its other end.
  descriptor_ = ::open(file_.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0666);
  if (descriptor_ < 0) throw IoError("create", file_, last_error());
  try {
    struct stat status {};
    if (::fstat(descriptor_, &status) != 0 || !S_ISREG(status.st_mode)) fail_in_file(file_, "is no file");
    if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
      fail_in_file(file_, "another sweep is writing to this directory; allowed: one at a time");
    }
    const std::string first_line = title_line(sweep);
    if (resume) read(first_line);
    if (rows_.empty()) {
      if (::ftruncate(descriptor_, 0) != 0) throw IoError("write", file_, last_error());
      write(first_line);
    }
  } catch (...) {
    ::close(descriptor_);
    throw;
  }
}

Journal::~Journal() {
  ::close(descriptor_);
}

bool Journal::is_of(const std::filesystem::path& file, const std::string& sweep) {
  const std::string expected = title_line(sweep);
  std::string found(expected.size(), '\0');
  std::ifstream in(file, std::ios::binary);
  return in.read(found.data(), static_cast<std::streamsize>(found.size())) && found == expected;
}

void Journal::read(const std::string& first_line) {
  const std::string text = read_named_file(file_);
  std::size_t whole = text.find('\n') + 1;  // 0 when there is not even one line
  if (whole == 0) return;
  if (text.substr(0, whole) != first_line) {
    fail_in_file(
        file_,
        "is not the journal of this sweep; --resume needs the same scenario, --set, --vary, --shard, --keep-runs, "
        "named files and program; without --resume the sweep begins anew");
  }
  for (std::size_t end; (end = text.find('\n', whole)) != std::string::npos; whole = end + 1) {
    const std::string_view row = row_in(std::string_view(text).substr(whole, end - whole));
    if (row.empty()) break;
    rows_.emplace_back(row);
  }
  if (::ftruncate(descriptor_, static_cast<off_t>(whole)) != 0) throw IoError("write", file_, last_error());
}

void Journal::add(std::string_view row) {
  write(line_of(row));
}

void Journal::write(std::string_view text) {
  while (!text.empty()) {
    const ::ssize_t written = ::write(descriptor_, text.data(), text.size());
    if (written < 0 && errno != EINTR) throw IoError("write", file_, last_error());
    if (written > 0) text.remove_prefix(static_cast<std::size_t>(written));
  }
}

void Journal::remove() noexcept {
  ::unlink(file_.c_str());
}

}  // namespace hapbench
