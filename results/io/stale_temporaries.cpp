#include "results/io/stale_temporaries.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <string_view>

namespace hapbench {
namespace {

namespace fs = std::filesystem;

/// ".<name>.<pid>.tmp"
bool is_temporary_name(std::string_view name) {
  constexpr std::string_view end = ".tmp";
  if (name.size() <= end.size() || !name.starts_with('.') || !name.ends_with(end)) return false;
  name.remove_prefix(1);
  name.remove_suffix(end.size());
  const std::size_t dot = name.rfind('.');
  return dot != std::string_view::npos && dot > 0 && dot + 1 < name.size() &&
         name.find_first_not_of("0123456789", dot + 1) == std::string_view::npos;
}

/// Removes the file if nobody holds its lock; a writer holds it until the file has its final name.
bool remove_if_abandoned(const fs::path& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  if (descriptor < 0) return false;
  const bool removed = ::flock(descriptor, LOCK_EX | LOCK_NB) == 0 && ::unlink(path.c_str()) == 0;
  ::close(descriptor);
  return removed;
}

}  // namespace

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

}  // namespace hapbench
