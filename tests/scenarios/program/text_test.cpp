#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "algorithms/registry.hpp"
#include "scenarios/program/digits.hpp"
#include "scenarios/program/run_table.hpp"
#include "scenarios/program/table.hpp"
#include "scenarios/program/text.hpp"
#include "scenarios/scene/scenario_schema.hpp"

/// Tests tables, digits and the names of fields. The files in tests/data/golden contain the texts that the program
/// prints.
namespace hapbench::text_test {
namespace {

TEST(Wrapped, BreaksBetweenWordsAndNeverWithinOne) {
  EXPECT_EQ(wrapped("aa bb cc", 1, 6), " aa bb\n cc\n");
  EXPECT_EQ(wrapped("aaaaaaaaaa b", 2, 6), "  aaaaaaaaaa\n  b\n");
  EXPECT_EQ(wrapped("a", 0, 6), "a\n");
  EXPECT_EQ(wrapped("aa bb", 2, std::string::npos), "  aa bb\n") << "a width without bound";
  EXPECT_EQ(wrapped("a\nb\n\nc", 1, 6), " a\n b\n\n c\n");
}

TEST(Table, BreaksIntoBlocksThatBeginWithTheFirstColumn) {
  const Table table{{{"name", false}, {"one"}, {"two"}, {"three"}}, {{"a", "1", "2", "3"}}};
  EXPECT_EQ(table.text(21), table.text(std::string::npos));
  EXPECT_EQ(table.text(14),
            "name  one  two\n"
            "----  ---  ---\n"
            "a       1    2\n"
            "\n"
            "name  three\n"
            "----  -----\n"
            "a         3\n");
  EXPECT_EQ(table.text(1).find("name  one\n"), 0u) << "a column at least";
}

TEST(Table, WrapsALastColumnOfText) {
  const Table table{{{"name", false}, {"n"}, {"meaning", false}},
                    {{"a", "1", "one two three four five six seven"}, {"b", "2", "short"}}};
  EXPECT_EQ(table.text(34),
            "name  n  meaning\n"
            "----  -  -------------------------\n"
            "a     1  one two three four five\n"
            "         six seven\n"
            "b     2  short\n");
}

TEST(Fitted, BreaksWideLinesAtBlanksAndKeepsTheirIndent) {
  EXPECT_EQ(fitted("  aa bb cc dd\nshort\n", 9), "  aa bb\n    cc dd\nshort\n");
  EXPECT_EQ(fitted("aaaaaaaaaaaa\n", 5), "aaaaaaaaaaaa\n");
  EXPECT_EQ(fitted("a  b\n\n", 80), "a  b\n\n");
}

/// Checks that the laws with the same warning are named in one line. The warnings of the two runs with `proxy` contain
/// other numbers than the warning of `mean` and `summation`, so they are in a second line.
TEST(RunWarnings, QuoteEachLawsOwnNumber) {
  const auto run = [](const char* law, const char* text) {
    Result result;
    result.name = "scene";
    result.algorithm = law;
    result.warnings = {{"went_through", "", text}};
    return result;
  };
  const std::vector<Result> runs = {run("mean", "2 mm deep"), run("proxy", "1 mm deep"), run("summation", "2 mm deep"),
                                    run("proxy", "1.5 mm deep")};
  EXPECT_EQ(run_warnings(runs),
            (std::vector<std::string>{"scene, with mean, summation: 2 mm deep",
                                      "scene, with proxy: 1 mm deep (further runs with other numbers: 1)"}));
  EXPECT_EQ(run_warnings({runs.data(), 1}), std::vector<std::string>{"scene: 2 mm deep"});
}

TEST(Deserved, EndsWithTheLeadingDigitOfTheTolerance) {
  EXPECT_EQ(deserved(1537235.0, 154.0), "1537200");
  EXPECT_EQ(deserved(433731.6, 0.5), "433731.6");
  EXPECT_EQ(deserved(3718.0, 37.0), "3720");
  EXPECT_EQ(deserved(-0.012345, 0.0006), "-0.0123");
  EXPECT_EQ(deserved(1.0, 0.0012), "1.000") << "zeros say as much as other digits";
  EXPECT_EQ(deserved(1.23456e-6, 2e-9), "1.235e-06");
}

TEST(Deserved, HasItsUsualDigitsWithoutATolerance) {
  EXPECT_EQ(deserved(1.0 / 3.0, {}, 3), "0.333");
  EXPECT_EQ(deserved(1.0 / 3.0, 0.0, 3), "0.333");
  EXPECT_EQ(deserved(1.0 / 3.0, std::nan(""), 3), "0.333");
  EXPECT_EQ(deserved(std::nan(""), 1e-3), "-");
}

TEST(Deserved, IsOnTheSafeSideOfALimit) {
  EXPECT_EQ(deserved_on_side(3718.0, 37.0, 6, Rounding::down), "3710");
  EXPECT_EQ(deserved_on_side(3711.0, 37.0, 6, Rounding::up), "3720");
  EXPECT_EQ(deserved_on_side(3718.0, 37.0, 6, Rounding::nearest), deserved(3718.0, 37.0, 6));
  EXPECT_EQ(deserved_on_side(52565.8497, {}, 6, Rounding::down), "52565.8");
  EXPECT_EQ(deserved_on_side(2.0, {}, 6, Rounding::down), "2") << "a whole number is exact";
  EXPECT_EQ(deserved_on_side(2.0, 5.0, 6, Rounding::down), "2") << "it has at least one digit";
  EXPECT_EQ(deserved_on_side(0.3, {}, 6, Rounding::down), "0.3") << "no unit is lost by rounding errors";
  EXPECT_EQ(deserved_on_side(0.1 + 0.2, {}, 6, Rounding::up), "0.3");
  EXPECT_EQ(deserved_on_side(1.23456e-6, 2e-9, 6, Rounding::down), "1.234e-06");
  EXPECT_EQ(deserved_on_side(std::numeric_limits<double>::infinity(), {}, 6, Rounding::down), "-");
}

/// Checks the same cases as test_a_number_below_its_error_is_a_bound in tests/scripts/ranking_test.py, which checks how
/// the HTML page prints these numbers.
TEST(Deserved, IsABoundIfTheToleranceIsNotSmaller) {
  EXPECT_EQ(deserved(0.0730, 0.37), "<= 0.5");
  EXPECT_EQ(deserved(0.0730, 0.93), "<= 2");
  EXPECT_EQ(deserved(0.98, 0.99), "<= 2");
  EXPECT_EQ(deserved(0.0, 0.2), "<= 0.2");
  EXPECT_EQ(deserved(0.1, 0.2), "<= 0.3") << "0.1 + 0.2 is a little more than 0.3 in floating point";
  EXPECT_EQ(deserved(-0.1, 0.2), "0 +- 0.3");
  EXPECT_EQ(deserved(7.3e-5, 3.7e-4), "<= 0.0005");
  EXPECT_EQ(short_text(7.3e-5, 3.7e-4, 1e3), "<= 0.5");
  EXPECT_EQ(short_text(0.0, 0.0, 1.0), "0");
}

TEST(WithSpread, EndsWithTheSecondDigitOfTheSpread) {
  EXPECT_EQ(with_spread(1.23456, 0.0567, {}), "1.235 +- 0.057");
  EXPECT_EQ(with_spread(1.23456, 0.0567, 0.3), "1.2") << "a spread below the tolerance is not resolved";
  EXPECT_EQ(with_spread(1.23456, 0.0567, 0.05), "1.235 +- 0.057");
  EXPECT_EQ(with_spread(1234.56, 56.7, {}), "1235 +- 57");
  EXPECT_EQ(with_spread(12345.6, 567.0, {}), "12350 +- 570");
  EXPECT_EQ(with_spread(0.01, 0.4, {}), "0.01 +- 0.40");
  EXPECT_EQ(with_spread(7.3456e-6, 1.2e-7, {}), "7.35e-06 +- 1.2e-07");
  EXPECT_EQ(with_spread(1.5, 0.0, {}), "1.5 +- 0");
  EXPECT_EQ(with_spread(1.5, {}, 0.1), "1.5");
  EXPECT_EQ(with_spread(0.1302, 0.0003, 0.01), "0.13") << "a spread of 0.000 would look exact";
  EXPECT_EQ(with_spread(0.056, 2e-5, 0.37), "<= 0.5") << "the spread says nothing of an error that all seeds share";
}

TEST(Deserved, DigitsAreNeverNone) {
  EXPECT_EQ(deserved_digits(0.0612, 0.0112, 3), 1);
  EXPECT_EQ(deserved_digits(0.523, 0.02, 3), 2);
  EXPECT_EQ(deserved_digits(0.0416, 0.0003, 3), 3);
  EXPECT_EQ(deserved_digits(0.0416, 3e-9, 3), 3);
  EXPECT_EQ(deserved_digits(0.005, 0.0101, 3), 1) << "no more than its size is known";
  EXPECT_EQ(deserved_digits(1440.0, {}, 3), 3);
  EXPECT_EQ(deserved_digits(0.0, 1.0, 3), 3);
}

std::vector<const ModelInfo*> all_models() {
  std::vector<const ModelInfo*> models(stages().begin(), stages().end());
  for (const AlgorithmEntry& entry : algorithms()) models.push_back(entry.info);
  for (const DepthModelEntry& entry : depth_models()) models.push_back(entry.info);
  return models;
}

/// Checks that the parameters that models document are fields of scenarios, with the same units and ranges.
TEST(ParameterBlocks, NameFieldsOfScenariosWithTheirUnits) {
  EXPECT_FALSE(find_algorithm("shaped_stiffness")->info->parameters.empty());
  const std::vector<ScenarioField> fields = scenario_fields();
  for (const ModelInfo* model : all_models()) {
    for (const auto& [parameter, meaning] : model->parameters) {
      const std::string where = std::string(model->name) + ": " + parameter.field, unit = parameter.range.unit;
      const auto placed = std::ranges::find(fields, parameter.field, &ScenarioField::path);
      ASSERT_NE(placed, fields.end()) << where;
      const std::string allowed = placed->field->value.allowed;
      const bool is_number = allowed.find("a number") != std::string::npos;
      EXPECT_TRUE(is_number ? allowed.find("[" + unit + "]") != std::string::npos : unit == "1") << where << allowed;
      EXPECT_STRNE(meaning, "") << where;
    }
  }
}

}  // namespace
}  // namespace hapbench::text_test
