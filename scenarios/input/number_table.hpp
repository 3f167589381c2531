#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace hapbench {

/// Largest table read [bytes].
inline constexpr std::uintmax_t kLargestTable = std::uintmax_t{4} << 30;

/// The bytes of a file that a scenario names. Throws InputError that names the file.
std::string read_named_file(const std::filesystem::path& file);

/// A CSV file of numbers with one of a few headers.
struct NumberTable {
  std::size_t columns = 0;
  std::vector<double> values;  ///< row by row

  std::size_t rows() const { return columns == 0 ? 0 : values.size() / columns; }
  std::span<const double> row(std::size_t i) const { return {values.data() + i * columns, columns}; }
};

/// The table in the contents of a CSV file, whose first line is exactly one of `headers`; blank lines are skipped, line
/// ends may be CR LF. Throws InputError that names file, line and column for another header, a wrong number of cells, a
/// cell that is no finite number, or more than `most_rows` rows.
NumberTable number_table_in(std::string_view text, const std::filesystem::path& file,
                            std::span<const std::string_view> headers, std::size_t most_rows);
/// The same with one header.
NumberTable number_table_in(std::string_view text, const std::filesystem::path& file, std::string_view header,
                            std::size_t most_rows);

}  // namespace hapbench
