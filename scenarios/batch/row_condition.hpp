#pragma once

#include <functional>
#include <string>
#include <vector>

/// The conditions of --where on rows of sweep.csv.
namespace hapbench {

/// Returns true if a row, given by its cells, meets the condition.
using RowCondition = std::function<bool(const std::vector<std::string>& row)>;

/// Parses a condition such as "inside_max_m<3e-4": a column of `columns`, one of < <= > >= = !=, and a number or, with
/// = and !=, a text. Numbers are compared by value. Two texts are equal only if all characters are equal, including
/// upper and lower case. A row whose cell is no number, such as an empty cell, meets no condition on numbers. If the
/// text is not a condition, or the column does not exist, throws InputError that names --where.
RowCondition parse_row_condition(const std::string& text, const std::vector<std::string>& columns);

/// Parses several conditions. A row meets the returned condition if it meets all of them.
RowCondition parse_row_conditions(const std::vector<std::string>& texts, const std::vector<std::string>& columns);

}  // namespace hapbench
