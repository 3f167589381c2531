#include "results/io/atomic_file.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cassert>
#include <cerrno>
#include <utility>

namespace hapbench {
namespace {

namespace fs = std::filesystem;

/// Buffer size [bytes]: large enough that system calls cost little, small enough for the second-level cache.
constexpr std::size_t kBufferSize = 0x10000;

std::error_code last_error() {
  return {errno, std::generic_category()};
}

fs::path temporary_of(const fs::path& target) {
  return target.parent_path() / ("." + target.filename().string() + ".tmp");
}

/// Returns true if the path refers to the open file.
bool refers_to(const fs::path& path, int descriptor) {
  struct stat there {
  }, here{};
  return ::stat(path.c_str(), &there) == 0 && ::fstat(descriptor, &here) == 0 && there.st_ino == here.st_ino &&
         there.st_dev == here.st_dev;
}

}  // namespace

AtomicFile::AtomicFile(fs::path target)
    : target_(std::move(target)),
      temporary_(temporary_of(target_)),
      buffer_(std::make_unique_for_overwrite<char[]>(kBufferSize)) {
  // Reject devices and pipes as a target, because the renaming would replace them.
  if (std::error_code unknown; fs::exists(target_, unknown) && !fs::is_regular_file(target_, unknown))
    throw IoError("write", target_, std::make_error_code(std::errc::not_supported));
  // Open and lock the temporary file. If another writer renames the file between our open and our lock, open the
  // temporary file again.
  int descriptor = -1;
  do {
    descriptor = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
    file_.reset(descriptor < 0 ? nullptr : ::fdopen(descriptor, "w"));
    if (!file_) throw IoError("create", target_, last_error());
    if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
      file_.reset();
      throw IoError("write, because it is being written,", target_,
                    std::make_error_code(std::errc::device_or_resource_busy));
    }
  } while (!refers_to(temporary_, descriptor));
  std::setvbuf(file_.get(), buffer_.get(), _IOFBF, kBufferSize);
  if (::ftruncate(descriptor, 0) != 0) error_ = last_error();  // removes the bytes that a killed process wrote
}

AtomicFile::~AtomicFile() {
  if (file_) discard();
}

void AtomicFile::append(std::string_view bytes) noexcept {
  assert(file_);
  if (!error_ && ::fwrite_unlocked(bytes.data(), 1, bytes.size(), file_.get()) != bytes.size()) error_ = last_error();
}

void AtomicFile::complete() {
  assert(file_);
  if (!error_ && std::fflush(file_.get()) != 0) error_ = last_error();
  // Network file systems report some write errors only on close. Closing a duplicate of the descriptor reports these
  // errors and keeps the lock.
  if (!error_) {
    const int duplicate = ::dup(::fileno(file_.get()));
    if (duplicate < 0 || ::close(duplicate) != 0) error_ = last_error();
  }
  throw_error();
}

void AtomicFile::rename() {
  if (::rename(temporary_.c_str(), target_.c_str()) != 0) error_ = last_error();
  throw_error();
  file_.reset();
}

void AtomicFile::commit(FileSet* together) {
  if (together != nullptr) return together->take(std::move(*this));
  complete();
  rename();
}

void AtomicFile::throw_error() {
  if (!error_) return;
  discard();
  throw IoError("write", target_, error_);
}

void AtomicFile::discard() noexcept {
  ::unlink(temporary_.c_str());
  file_.reset();
}

void FileSet::commit() {
  for (AtomicFile& file : files_) file.complete();
  for (const fs::path& name : removed_) {
    if (::unlink(name.c_str()) != 0 && errno != ENOENT && errno != ENOTDIR) throw IoError("remove", name, last_error());
  }
  for (AtomicFile& file : files_) file.rename();
  // Remove the temporary files of the removed files, which a killed process may have left.
  for (const fs::path& name : removed_) ::unlink(temporary_of(name).c_str());
}

void write_file_atomically(const fs::path& target, std::string_view contents) {
  AtomicFile file(target);
  file.append(contents);
  file.commit();
}

}  // namespace hapbench
