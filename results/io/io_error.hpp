#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>
#include <system_error>

namespace hapbench {

/// A result file that could not be written: says what was tried, on which file, and why it failed.
class IoError : public std::runtime_error {
 public:
  /// `attempt` completes "cannot …", e.g. "write".
  IoError(const std::string& attempt, std::filesystem::path path, const std::error_code& reason)
      : std::runtime_error("cannot " + attempt + " " + path.string() + ": " + reason.message()),
        path_(std::move(path)),
        reason_(reason) {}

  /// The file as its reader knows it, not the temporary behind it.
  const std::filesystem::path& path() const noexcept { return path_; }
  const std::error_code& reason() const noexcept { return reason_; }

 private:
  std::filesystem::path path_;
  std::error_code reason_;
};

}  // namespace hapbench
