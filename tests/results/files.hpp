#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace hapbench::test {

/// Creates a new empty directory, which is removed with its contents at the end of the test.
class TemporaryDirectory {
 public:
  TemporaryDirectory();
  ~TemporaryDirectory();
  TemporaryDirectory(const TemporaryDirectory&) = delete;
  TemporaryDirectory& operator=(const TemporaryDirectory&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  /// Returns the names of all entries, including hidden entries, sorted.
  std::vector<std::string> entries() const;

 private:
  std::filesystem::path path_;
};

/// Returns the bytes of a file. Fails the test if the file cannot be read.
std::string read_file(const std::filesystem::path& path);
void write_plainly(const std::filesystem::path& path, const std::string& contents);

/// Returns the contents of all files below a directory, including hidden files, by their path relative to the
/// directory.
std::map<std::string, std::string> files_below(const std::filesystem::path& directory);

/// Returns the relative paths of the files that files_below() returns.
std::vector<std::string> names_below(const std::filesystem::path& directory);

/// Fails the test unless both directories have the same files with the same bytes. Names in `ignored` are not compared.
void expect_same_files(const std::filesystem::path& a, const std::filesystem::path& b,
                       const std::vector<std::string>& ignored = {});

/// Return the lines of a text without line ends, and the cells of a line of CSV.
std::vector<std::string> lines_of(const std::string& text);
std::vector<std::string> cells_of(const std::string& line);
/// Returns the number in a cell. Fails the test if the cell is not exactly one number.
double number_in(const std::string& cell);

/// While a FileSizeLimit exists, no file of this process can grow beyond `bytes`: writing fails as on a full disk.
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

/// While an EnvironmentVariable exists, the environment variable `name` of this process and of programs that it starts
/// has the value `value`, or is unset if `value` is std::nullopt. The destructor restores the previous value.
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
