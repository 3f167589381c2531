#pragma once

#include <vector>

#include "scenarios/program/columns.hpp"
#include "scenarios/program/describe/index.hpp"
#include "scenarios/program/layout.hpp"

/// The descriptions of names that results and printed tables have: metrics, files, columns, words, headings.
namespace hapbench {

/// All metrics of summary.json.
Description describe_metrics(const Layout& layout);
/// A table by its columns.
Description describe_table(const DescribedTable& table, const Layout& layout);
/// All files of tables.
Description describe_tables(const Layout& layout);
/// The words that the program prints.
Description describe_words(const Layout& layout);
/// Adds metrics as terms.
void add_metric_terms(Index& index, const Layout& layout);
/// The columns of all files, those of one name and meaning once.
void add_columns(Index& index, const std::vector<DescribedTable>& tables, const Layout& layout);
/// Adds the words that the program prints.
void add_words(Index& index, const Layout& layout);
/// Adds the headings of printed tables.
void add_headings(Index& index, const std::vector<DescribedTable>& tables, const Layout& layout);

}  // namespace hapbench
