#include "scenarios/run/folder_lock.hpp"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>
#include <utility>

#include "results/io/atomic_file.hpp"

namespace hapbench {
namespace {

namespace fs = std::filesystem;

fs::path lock_file(const fs::path& folder, const std::string& set) {
  return folder / ("." + set + ".lock");
}

std::error_code last_error() {
  return {errno, std::generic_category()};
}

/// Returns true if the path refers to the open file.
bool refers_to(const fs::path& path, int descriptor) {
  struct stat there {
  }, here{};
  return ::stat(path.c_str(), &there) == 0 && ::fstat(descriptor, &here) == 0 && there.st_ino == here.st_ino &&
         there.st_dev == here.st_dev;
}

/// Returns a description of an exclusive lock of the whole file for fcntl().
struct flock whole_file() {
  struct flock lock {};
  lock.l_type = F_WRLCK;
  lock.l_whence = SEEK_SET;
  return lock;
}

/// Raises the number of files that this process may open to the allowed maximum. Returns false if the number already is
/// the maximum or cannot be changed.
bool raise_file_limit() {
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0 || limit.rlim_cur == limit.rlim_max) return false;
  limit.rlim_cur = limit.rlim_max;
  return ::setrlimit(RLIMIT_NOFILE, &limit) == 0;
}

/// Opens or creates a file. If another process has removed the file's folder, creates the folder first. Throws IoError.
int opened(NewDirectories& directories, const fs::path& folder, const fs::path& file) {
  constexpr int kMaxAttempts = 1000;
  for (int attempt = 0;; ++attempt) {
    if (const auto error = directories.create(folder)) throw IoError("create", folder, error);
    const int descriptor = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
    if (descriptor >= 0) return descriptor;
    if (errno == EMFILE && raise_file_limit()) continue;
    if (errno != ENOENT || attempt == kMaxAttempts) throw IoError("create", file, last_error());
  }
}

}  // namespace

FolderLock::FolderLock(NewDirectories& directories, fs::path folder, std::string set, const std::string& writer)
    : file_(lock_file(folder, set)) {
  for (;;) {
    descriptor_ = opened(directories, folder, file_);
    struct flock lock = whole_file();
    const int error = ::fcntl(descriptor_, F_OFD_SETLK, &lock) == 0 ? 0 : errno;
    const bool is_busy = error == EAGAIN || error == EACCES;
    // Another holder of the lock may have removed the file after it was opened above. Then open or create the file
    // again.
    if (refers_to(file_, descriptor_)) {
      if (is_busy) {
        ::close(descriptor_);
        refuse(folder, writer);
      }
      if (error != 0) problem_ = std::generic_category().message(error);
      return;
    }
    ::close(descriptor_);
  }
}

FolderLock::~FolderLock() {
  if (descriptor_ < 0) return;
  // Remove the file while it is locked, because otherwise another process could lock the file just before it is
  // removed.
  if (refers_to(file_, descriptor_)) ::unlink(file_.c_str());
  ::close(descriptor_);
}

FolderLock::FolderLock(FolderLock&& other) noexcept
    : file_(std::move(other.file_)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      problem_(std::move(other.problem_)) {}

bool FolderLock::is_held(const fs::path& folder, const std::string& set) {
  const fs::path file = lock_file(folder, set);
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
  if (descriptor < 0) return false;
  struct flock lock = whole_file();
  const bool held =
      ::fcntl(descriptor, F_OFD_GETLK, &lock) == 0 && lock.l_type != F_UNLCK && refers_to(file, descriptor);
  ::close(descriptor);
  return held;
}

void FolderLock::refuse(const fs::path& folder, const std::string& writer) {
  throw IoError("write, because another " + writer + " writes to", folder,
                std::make_error_code(std::errc::device_or_resource_busy));
}

void require_unlocked_parents(const fs::path& folder, const std::string& set, int levels) {
  std::error_code ignored;
  fs::path parent = fs::weakly_canonical(folder, ignored);
  for (int level = 0; level < levels && parent.has_relative_path(); ++level) {
    parent = parent.parent_path();
    if (FolderLock::is_held(parent, set)) FolderLock::refuse(parent, set);
  }
}

}  // namespace hapbench
