#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace hapbench::test {

/// A new empty directory, removed with its contents at the end of the test.
class TemporaryDirectory {
 public:
  TemporaryDirectory();
  ~TemporaryDirectory();
  TemporaryDirectory(const TemporaryDirectory&) = delete;
  TemporaryDirectory& operator=(const TemporaryDirectory&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  /// Names of all entries, hidden ones included, sorted.
  std::vector<std::string> entries() const;

 private:
  std::filesystem::path path_;
};

/// The bytes of a file; fails the test when it cannot be read.
std::string read_file(const std::filesystem::path& path);
void write_plainly(const std::filesystem::path& path, const std::string& contents);

/// Contents of all files below a directory, hidden ones included, by their path from there.
std::map<std::string, std::string> files_below(const std::filesystem::path& directory);

/// The paths of those files alone.
std::vector<std::string> names_below(const std::filesystem::path& directory);

/// Fails the test unless both directories hold the same files with the same bytes; `ignored` names are not compared.
void expect_same_files(const std::filesystem::path& a, const std::filesystem::path& b,
                       const std::vector<std::string>& ignored = {});

/// The text's lines without their ends, and a line's cells.
std::vector<std::string> lines_of(const std::string& text);
std::vector<std::string> cells_of(const std::string& line);
/// The number a cell holds; fails the test when anything else is in it.
double number_in(const std::string& cell);

/// While it lives, no file of this process may grow beyond `bytes`: writing fails as it does on a full disk.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(unsigned long bytes);
  ~FileSizeLimit();
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  unsigned long before_;
  void (*handler_before_)(int);
};

/// An environment variable of this process and the programs it starts, set or (without a value) unset while this lives.
class EnvironmentVariable {
 public:
  EnvironmentVariable(std::string name, const std::optional<std::string>& value);
  ~EnvironmentVariable() { set(before_); }
  EnvironmentVariable(const EnvironmentVariable&) = delete;
  EnvironmentVariable& operator=(const EnvironmentVariable&) = delete;

 private:
  void set(const std::optional<std::string>& value) const;

  std::string name_;
  std::optional<std::string> before_;
};

}  // namespace hapbench::test
