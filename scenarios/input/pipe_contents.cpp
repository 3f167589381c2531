#include "scenarios/input/pipe_contents.hpp"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>

namespace hapbench {
namespace {

/// Returns a text that identifies a pipe and its last write; nothing for every other file.
std::optional<std::string> pipe_key(const std::filesystem::path& file) {
  struct stat s {};
  if (::stat(file.c_str(), &s) != 0 || !S_ISFIFO(s.st_mode)) return std::nullopt;
  return fmt::format("{} {} {} {}", s.st_dev, s.st_ino, s.st_mtim.tv_sec, s.st_mtim.tv_nsec);
}

}  // namespace

std::optional<std::string> PipeContents::find(const std::filesystem::path& file) const {
  const auto key = pipe_key(file);
  if (!key) return std::nullopt;
  const std::lock_guard lock(mutex_);
  const auto found = contents_.find(*key);
  return found == contents_.end() ? std::nullopt : std::optional(found->second);
}

void PipeContents::keep(const std::filesystem::path& file, const std::string& contents) {
  const auto key = pipe_key(file);
  if (!key) return;
  const std::lock_guard lock(mutex_);
  contents_[*key] = contents;
}

PipeContents& pipe_contents() {
  static PipeContents contents;
  return contents;
}

bool has_no_folder(const std::filesystem::path& file) {
  const std::string path = file.string();
  return path.starts_with("/dev/") || path.starts_with("/proc/");
}

}  // namespace hapbench
