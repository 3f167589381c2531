#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sim/geometry/point_shell.hpp"

namespace hapbench {

/// Point shells on disk, each under the text that defines it, for those that take longer to build than to read.
///
/// A file is named by a hash of its definition and holds the definition, points and cells as they lie in memory and a
/// checksum of all that. What does not agree in every part (damaged, half of it, another definition with the same hash)
/// is not there for `find`, and the next `keep` replaces it. Several processes may use one directory at once: files
/// appear whole (results/io/atomic_file.hpp), and of two that build the same shell the later replaces the earlier by
/// the same bytes.
///
/// Nothing here fails: a cache that cannot be read or written is one without entries. The checksum tells damage, not
/// forgery: whoever may write into the directory may write into the user's other files, too.
class ShellCache {
 public:
  /// Bound of all entries together [bytes], more than the largest shell needs.
  static constexpr std::uintmax_t kLargest = std::uintmax_t{1} << 30;

  /// No caching.
  ShellCache() = default;
  /// A cache in this directory, which is created when it is first written to; no caching when the path is empty.
  explicit ShellCache(std::filesystem::path directory, std::uintmax_t largest = kLargest);

  /// The shell kept under this definition, bit for bit. O(points): reads and checks the whole file.
  std::optional<ShellPoints> find(const std::string& definition) const noexcept;
  /// Keeps the shell for later processes and drops the entries used longest ago that are too many.
  void keep(const std::string& definition, const ShellPoints& shell) const noexcept;

  bool is_on() const { return !directory_.empty(); }
  const std::filesystem::path& directory() const { return directory_; }

  /// What lies in the directory.
  struct Contents {
    std::size_t shells = 0;
    std::uintmax_t bytes = 0;
  };
  Contents contents() const;

 private:
  std::filesystem::path entry(const std::string& definition) const;

  std::filesystem::path directory_;
  std::uintmax_t largest_ = kLargest;
};

/// Where the user's shells are: $HAPBENCH_CACHE_DIR, else $XDG_CACHE_HOME/hapbench, else $HOME/.cache/hapbench. Empty,
/// for no caching, when HAPBENCH_CACHE_DIR is empty or none of them is set.
std::filesystem::path shell_cache_directory();

}  // namespace hapbench
