#include "results/io/atomic_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cassert>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <thread>
#include <utility>

namespace hapbench {
namespace {

namespace fs = std::filesystem;

/// Large enough that system calls do not count, small enough for the second-level cache.
constexpr std::size_t kBufferSize = 0x10000;

std::error_code last_error() {
  return {errno, std::generic_category()};
}

fs::path temporary_name(const fs::path& target) {
  return target.parent_path() / fmt::format(".{}.{}.tmp", target.filename().string(), ::getpid());
}

/// True when `path` still leads to the open file, that is, nobody removed it between open and lock.
bool is_file_at(int descriptor, const fs::path& path) {
  struct stat open_file {};
  struct stat named_file {};
  return ::fstat(descriptor, &open_file) == 0 && ::stat(path.c_str(), &named_file) == 0 &&
         open_file.st_ino == named_file.st_ino && open_file.st_dev == named_file.st_dev;
}

/// Opens `path` for writing and locks it; -1 with errno set when that fails. Where the file system knows no locks the
/// file stays unlocked, and remove_stale_temporaries then leaves it alone.
int open_locked(const fs::path& path) {
  const int descriptor = ::open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
  if (descriptor < 0) return -1;
  if (::flock(descriptor, LOCK_EX | LOCK_NB) == 0 ? is_file_at(descriptor, path) : errno != EWOULDBLOCK) {
    return descriptor;
  }
  ::close(descriptor);
  errno = EBUSY;
  return -1;
}

}  // namespace

AtomicFile::AtomicFile(fs::path target)
    : target_(std::move(target)),
      temporary_(temporary_name(target_)),
      buffer_(std::make_unique_for_overwrite<char[]>(kBufferSize)) {
  // A clean-up may hold the new file for an instant; another writer holds it for good.
  constexpr int attempts = 20;
  for (int i = 0; i < attempts && descriptor_ < 0; ++i) {
    if (i > 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    descriptor_ = open_locked(temporary_);
    if (descriptor_ < 0 && errno != EBUSY) break;
  }
  if (descriptor_ < 0) throw IoError("create", target_, last_error());
  // Leavings of a killed run whose process number has come round again.
  if (::ftruncate(descriptor_, 0) != 0) error_ = last_error();
}

AtomicFile::~AtomicFile() {
  if (descriptor_ >= 0) discard();
}

void AtomicFile::append(std::string_view bytes) noexcept {
  assert(descriptor_ >= 0);
  while (!bytes.empty() && !error_) {
    if (used_ == kBufferSize) flush();
    const std::size_t n = bytes.size() < kBufferSize - used_ ? bytes.size() : kBufferSize - used_;
    std::memcpy(buffer_.get() + used_, bytes.data(), n);
    used_ += n;
    bytes.remove_prefix(n);
  }
}

void AtomicFile::flush() noexcept {
  const char* from = buffer_.get();
  std::size_t left = used_;
  used_ = 0;
  while (left > 0 && !error_) {
    const ::ssize_t written = ::write(descriptor_, from, left);
    if (written < 0) {
      if (errno != EINTR) error_ = last_error();
      continue;
    }
    from += written;
    left -= static_cast<std::size_t>(written);
  }
}

void AtomicFile::commit() {
  assert(descriptor_ >= 0);
  flush();
  // Network file systems report late errors on close; closing a duplicate asks for them and keeps the lock.
  if (!error_) {
    const int duplicate = ::dup(descriptor_);
    if (duplicate < 0 || ::close(duplicate) != 0) error_ = last_error();
  }
  if (!error_ && ::rename(temporary_.c_str(), target_.c_str()) != 0) error_ = last_error();
  if (error_) {
    discard();
    throw IoError("write", target_, error_);
  }
  ::close(std::exchange(descriptor_, -1));
}

void AtomicFile::discard() noexcept {
  ::unlink(temporary_.c_str());
  ::close(std::exchange(descriptor_, -1));
}

void write_file_atomically(const fs::path& target, std::string_view contents) {
  AtomicFile file(target);
  file.append(contents);
  file.commit();
}

}  // namespace hapbench
