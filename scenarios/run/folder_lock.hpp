#pragma once

#include <filesystem>
#include <string>

#include "scenarios/run/new_directories.hpp"

namespace hapbench {

/// Names of sets of result files. A command writes such a set to a folder, and locks the set by its name.
inline constexpr const char *kRunFiles = "run", *kCompareFiles = "compare", *kReproduceFiles = "reproduce";

/// Exclusive right to write a set of files to a folder. While an instance exists, no other thread or process can create
/// an instance for the same folder and set. Locks for different sets do not exclude each other.
///
/// The lock is an OFD lock (fcntl) on the hidden file .SET.lock in the folder. The destructor releases the lock and
/// removes the file. If the process ends without the destructor, for example by SIGKILL, the kernel releases the lock.
/// The file then stays, and the next instance locks it. If another process removes the file between the opening and the
/// locking, the file is created and opened again.
///
/// Cost: one file descriptor; about 20 us.
class FolderLock {
 public:
  /// Creates the folder if necessary, with its missing parents, and locks the set. `set` and `writer`, such as "run",
  /// name the set and, in messages, the command that writes it. Throws IoError if the folder or the file cannot be
  /// created, or if the set is locked.
  FolderLock(NewDirectories& directories, std::filesystem::path folder, std::string set, const std::string& writer);
  ~FolderLock();
  FolderLock(FolderLock&& other) noexcept;
  FolderLock& operator=(FolderLock&&) = delete;

  /// Returns why the file system has not locked the set, such as "No locks available" on some network file systems;
  /// empty if it has locked the set. Without the lock, nothing excludes another writer.
  const std::string& problem() const { return problem_; }

  /// Returns true if another lock for this folder and set exists. Takes no lock and creates no file.
  static bool is_held(const std::filesystem::path& folder, const std::string& set);

  /// Throws the IoError that reports a locked set.
  [[noreturn]] static void refuse(const std::filesystem::path& folder, const std::string& writer);

 private:
  std::filesystem::path file_;
  int descriptor_ = -1;
  std::string problem_;
};

/// Throws IoError if one of the `levels` folders that contain `folder` is locked for this set. A command whose set
/// includes files of subfolders, such as `compare`, locks only the outer folder.
void require_unlocked_parents(const std::filesystem::path& folder, const std::string& set, int levels);

}  // namespace hapbench
