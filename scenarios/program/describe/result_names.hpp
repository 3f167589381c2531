#pragma once

#include <vector>

#include "scenarios/program/columns.hpp"
#include "scenarios/program/describe/index.hpp"
#include "scenarios/program/layout.hpp"

/// Descriptions of the names in results and printed tables: metrics, files, columns, words, headings.
namespace hapbench {

/// Kind of the members of a row that only the output of --json has. Field names such as "damping_ratio" may equal them.
inline constexpr const char* kJsonKey = "key of --json";

/// Describes all metrics of summary.json.
Description describe_metrics(const Layout& layout);
/// Describes a result file by its columns.
Description describe_table(const DescribedTable& table, const Layout& layout);
/// Describes all result files that are tables.
Description describe_tables(const Layout& layout);
/// Describes all words that the program prints, such as outcomes and verdicts.
Description describe_printed_names(const Layout& layout);
/// Adds the metrics of summary.json, each with the files of `tables` that have a column with its name and meaning.
void add_metric_terms(Index& index, const std::vector<DescribedTable>& tables, const Layout& layout);
/// Adds the columns of all files, except the columns of metrics, which add_metric_terms() adds. Columns with equal
/// names and meanings share an entry, which lists their files. Also adds the members that only the JSON of the rows
/// has, with the kind kJsonKey.
void add_columns(Index& index, const std::vector<DescribedTable>& tables, const Layout& layout);
/// Adds the words that the program prints.
void add_printed_names(Index& index, const Layout& layout);
/// Adds the headings of printed tables.
void add_headings(Index& index, const std::vector<DescribedTable>& tables, const Layout& layout);

}  // namespace hapbench
