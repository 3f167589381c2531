#include "scenarios/batch/csv_cells.hpp"

#include <gtest/gtest.h>

#include "results/io/columns.hpp"

namespace hapbench::csv_cells_test {
namespace {

using Rows = std::vector<std::string>;

TEST(CsvCells, AreWhatTheyWereWithCommasAndQuotes) {
  for (const Rows& cells : {Rows{""}, Rows{"a", "", "b"}, Rows{R"({"a":[1,2]})", "\"", ",", "\",\"", "x"},
                            Rows{"=1+1", "-x", "+a", "@b", "'=c", "''-d", "'quoted'", "-", "-1.5", "\tx"}}) {
    std::string line;
    for (const std::string& cell : cells) line += (line.empty() && &cell == &cells[0] ? "" : ",") + csv_cell(cell);
    EXPECT_EQ(csv_cells(line), cells) << line;
  }
}

TEST(CsvCells, AreNoFormulasOfASpreadsheet) {
  for (const char* text : {"=1+1", "-x", "+a", "@b", "'=c", "\tx", "-1.5.2", "-1 N", "=HYPERLINK(\"x\")"}) {
    const std::string cell = csv_cell(text);
    EXPECT_EQ(cell[cell[0] == '"' ? 1 : 0], '\'') << cell;
  }
  for (const char* text : {"-1.5", "+3", "-inf", "-nan", "1e-05", "-1e-05", "-1e999", "-", "", "a=b", "it's", "'a'"})
    EXPECT_EQ(csv_cell(text), text);
}

}  // namespace
}  // namespace hapbench::csv_cells_test
