#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "scenarios/program/table.hpp"

/// Tables for papers, web pages and other programs: the formats of the option --table.
namespace hapbench {

/// Returns the names of the formats: markdown, latex and csv.
std::vector<std::string> table_format_names();

/// Returns the tables in a format, one after the other with an empty line between them. The head of each column is in
/// one line and ends with the column's unit. The numbers have the same digits as in the tables on the terminal.
///
/// - markdown: a table of GitHub's dialect, below its caption if there are several tables. Escapes characters that have
///   a meaning in Markdown.
/// - latex: a tabular environment with the rules of the package booktabs, below a comment with the caption. A column
///   of numbers has the type S of siunitx; a number with an error is "1.23 +- 0.04", and other texts in such a column
///   are in braces. Escapes characters that have a meaning in LaTeX.
/// - csv: comma-separated values. A column of numbers with errors becomes two columns. A missing value is empty.
///
/// Precondition: `format` is one of table_format_names(), and each row has a cell for each column.
std::string formatted_tables(std::span<const Table> tables, std::string_view format);

}  // namespace hapbench
