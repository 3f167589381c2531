#include "results/io/atomic_file.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fmt/format.h>
#include <cassert>
#include <cerrno>
#include <cstring>
#include <random>
#include <set>
#include <utility>

namespace hapbench {
namespace {

namespace fs = std::filesystem;

/// Large enough that the cost of system calls is negligible, small enough for the second-level cache.
constexpr std::size_t kBufferSize = 0x10000;

std::error_code last_error() {
  return {errno, std::generic_category()};
}

/// ".<name>.<random number in hexadecimal>.tmp"
fs::path temporary_name(const fs::path& target) {
  std::random_device random;
  return target.parent_path() / fmt::format(".{}.{:08x}{:08x}.tmp", target.filename().string(), random(), random());
}

bool is_temporary_name(std::string_view name) {
  constexpr std::string_view end = ".tmp";
  if (name.size() <= end.size() || !name.starts_with('.') || !name.ends_with(end)) return false;
  name.remove_prefix(1);
  name.remove_suffix(end.size());
  const std::size_t dot = name.rfind('.');
  return dot != std::string_view::npos && dot > 0 && dot + 1 < name.size() &&
         name.find_first_not_of("0123456789abcdef", dot + 1) == std::string_view::npos;
}

/// Removes the file if nobody holds its lock; a writer holds it until the file has its final name.
bool remove_if_abandoned(const fs::path& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  if (descriptor < 0) return false;
  const bool removed = ::flock(descriptor, LOCK_EX | LOCK_NB) == 0 && ::unlink(path.c_str()) == 0;
  ::close(descriptor);
  return removed;
}

/// Removes what killed processes left in a folder that is about to be written to.
void clean_up(const fs::path& folder) {
  try {
    remove_stale_temporaries(folder.empty() ? "." : folder);
  } catch (const IoError&) {
    // A folder that may be written but not listed.
  }
}

}  // namespace

AtomicFile::AtomicFile(fs::path target)
    : target_(std::move(target)), buffer_(std::make_unique_for_overwrite<char[]>(kBufferSize)) {
  // Renaming over a device or a pipe would replace it.
  if (std::error_code unknown; fs::exists(target_, unknown) && !fs::is_regular_file(target_, unknown))
    throw IoError("write", target_, std::make_error_code(std::errc::not_supported));
  // A clean-up may remove the file before it is locked; then create another one.
  for (struct stat status{}; status.st_nlink == 0;) {
    if (descriptor_ >= 0) ::close(descriptor_);
    temporary_ = temporary_name(target_);
    descriptor_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor_ < 0) throw IoError("create", target_, last_error());
    ::flock(descriptor_, LOCK_EX);
    if (::fstat(descriptor_, &status) != 0) break;
  }
}

AtomicFile::AtomicFile(AtomicFile&& other) noexcept
    : target_(std::move(other.target_)),
      temporary_(std::move(other.temporary_)),
      buffer_(std::move(other.buffer_)),
      used_(other.used_),
      descriptor_(std::exchange(other.descriptor_, -1)),
      error_(other.error_) {}

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

void AtomicFile::complete() {
  assert(descriptor_ >= 0);
  flush();
  // Network file systems report late errors on close; closing a duplicate asks for them and keeps the lock.
  if (!error_) {
    const int duplicate = ::dup(descriptor_);
    if (duplicate < 0 || ::close(duplicate) != 0) error_ = last_error();
  }
  throw_error();
}

std::error_code AtomicFile::rename() {
  if (::rename(temporary_.c_str(), target_.c_str()) != 0) return last_error();
  ::close(std::exchange(descriptor_, -1));
  return {};
}

void AtomicFile::commit() {
  complete();
  error_ = rename();
  throw_error();
}

void AtomicFile::commit(FileSet* together) {
  if (together == nullptr) {
    commit();
  } else {
    together->take(std::move(*this));
  }
}

void AtomicFile::throw_error() {
  if (!error_) return;
  discard();
  throw IoError("write", target_, error_);
}

void AtomicFile::discard() noexcept {
  ::unlink(temporary_.c_str());
  ::close(std::exchange(descriptor_, -1));
}

void FileSet::write(const fs::path& target, std::string_view contents) {
  files_.emplace_back(target).append(contents);
}

void FileSet::commit() {
  for (AtomicFile& file : files_) file.complete();
  std::set<fs::path> folders;
  for (const AtomicFile& file : files_) folders.insert(file.target().parent_path());
  for (const fs::path& name : removed_) folders.insert(name.parent_path());
  for (const fs::path& folder : folders) clean_up(folder);
  // Earlier files step aside under temporary names, so that they can come back.
  struct Aside {
    fs::path name, place;
  };
  std::vector<Aside> aside;
  std::size_t placed = 0;
  const auto undo_and_throw = [&](const fs::path& at, const std::error_code& error) {
    while (placed > 0) ::unlink(files_[--placed].target().c_str());
    for (auto file = aside.rbegin(); file != aside.rend(); ++file) ::rename(file->place.c_str(), file->name.c_str());
    throw IoError("write", at, error);
  };
  const auto set_aside = [&](const fs::path& name) {
    const fs::path place = temporary_name(name);
    if (::rename(name.c_str(), place.c_str()) == 0) {
      aside.push_back({name, place});
    } else if (errno != ENOENT && errno != ENOTDIR) {
      undo_and_throw(name, last_error());
    }
  };
  for (const fs::path& name : removed_) set_aside(name);
  for (const AtomicFile& file : files_) set_aside(file.target());
  for (; placed < files_.size(); ++placed) {
    if (const std::error_code error = files_[placed].rename(); error) undo_and_throw(files_[placed].target(), error);
  }
  for (const Aside& file : aside) ::unlink(file.place.c_str());
}

void write_file_atomically(const fs::path& target, std::string_view contents) {
  clean_up(target.parent_path());
  AtomicFile file(target);
  file.append(contents);
  file.commit();
}

std::size_t remove_stale_temporaries(const fs::path& directory) {
  std::error_code error;
  fs::directory_iterator entry(directory, error);
  if (error == std::errc::no_such_file_or_directory) return 0;
  std::size_t removed = 0;
  for (; !error && entry != fs::directory_iterator(); entry.increment(error)) {
    std::error_code unknown_type;
    if (!is_temporary_name(entry->path().filename().native()) || !entry->is_regular_file(unknown_type)) continue;
    if (remove_if_abandoned(entry->path())) ++removed;
  }
  if (error) throw IoError("list", directory, error);
  return removed;
}

namespace fs = std::filesystem;

void NewDirectories::create(const fs::path& directory, std::error_code& error) {
  std::vector<fs::path> missing;
  std::error_code unknown;
  for (fs::path path = directory; !path.empty() && path != path.root_path() && !fs::exists(path, unknown);
       path = path.parent_path()) {
    missing.push_back(path);
  }
  made_.insert(made_.end(), missing.rbegin(), missing.rend());
  fs::create_directories(directory, error);
}

NewDirectories::~NewDirectories() {
  std::error_code not_empty;
  for (auto path = made_.rbegin(); path != made_.rend(); ++path) fs::remove(*path, not_empty);
}

}  // namespace hapbench
