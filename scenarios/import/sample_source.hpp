#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hapbench {

/// How a recording is laid out.
///
/// csv: one line a sample, numbers separated by commas, semicolons or tabs, with or without a line of names.
/// traj: the same separated by blanks.
/// hapi: the text log of HAPI and H3D: a line of field names, then numbers separated by blanks; ORIENTATION has four,
/// other vectors three (POSITION is POSITION_x, POSITION_y, POSITION_z here).
/// hapi_binary: the same in bytes: names that end with NUL, one more NUL, then samples without separators, every number
/// a double or a float and BUTTONS an int32, little-endian.
///
/// In text, blank lines and those that begin with # or % are passed over.
enum class StrokeFormat { csv, traj, hapi, hapi_binary };

/// The samples of a recording, one by one, in the columns of the file.
class SampleSource {
 public:
  virtual ~SampleSource() = default;
  /// The columns' names, empty where the file gives none. Their number is that of a sample's values.
  const std::vector<std::string>& names() const { return names_; }
  /// Goes to the next sample; false at the end.
  virtual bool next() = 0;
  /// The sample's value in a column, or none if that is no finite number. Precondition: no `problem`.
  virtual std::optional<double> value(std::size_t column) const = 0;
  /// The value as an error message shows it.
  virtual std::string shown_value(std::size_t column) const = 0;
  /// What is wrong with the whole sample (too few values), or empty.
  virtual std::string problem() const { return ""; }
  /// Where the sample is: its line, or its number; from 1.
  virtual std::size_t row() const = 0;
  /// "line" or "sample": what `row` counts.
  virtual const char* row_word() const = 0;
  /// What is to be said of the file when all samples have been read; empty for nothing.
  virtual std::string remark() const { return ""; }

 protected:
  std::vector<std::string> names_;
};

/// Opens a recording. `bytes` and `file`, which stands in messages, must outlive it. `floats`: numbers of a hapi_binary
/// file have four bytes instead of eight. Throws InputError when the file is not of this format.
std::unique_ptr<SampleSource> open_samples(StrokeFormat format, std::string_view bytes,
                                           const std::filesystem::path& file, bool floats);

}  // namespace hapbench
