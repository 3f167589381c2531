#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "scenarios/program/limit_cases.hpp"
#include "scenarios/program/report.hpp"

/// What `limit` found: its tables, and the sentences beside them.
namespace hapbench {

/// A limit over that of the first scene and algorithm in the same row; none where either has no value.
struct LimitRatio {
  std::optional<double> value;     ///< of the limits
  std::optional<double> rendered;  ///< of K lambda_max(S), the stiffness that the hand meets
};

class LimitAnswers {
 public:
  /// `limits`: of all cases, in their order. Both must outlive this.
  LimitAnswers(const LimitCases& asked, const std::vector<FieldLimit>& limits) : asked_(asked), limits_(limits) {}

  const LimitCases& asked() const { return asked_; }
  const FieldLimit& at(std::size_t row, std::size_t column) const { return limits_[row * asked_.columns() + column]; }
  LimitRatio ratio(std::size_t row, std::size_t column) const;
  bool have_inequality() const {
    return std::ranges::any_of(limits_, [](const FieldLimit& limit) { return limit.closed_form.has_value(); });
  }
  bool have_closed_forms() const {
    return std::ranges::any_of(limits_, [](const FieldLimit& limit) { return !limit.closed_forms.empty(); });
  }

  std::string text() const;

 private:
  std::string detailed_text() const;
  std::string grid_text() const;
  Table grid() const;
  std::string ends_text() const;
  std::string notes_text() const;
  std::string title(std::size_t column) const { return asked_.scene_name(column) + "\n" + asked_.algorithm(column); }
  std::string row_name(std::size_t row) const;

  const LimitCases& asked_;
  const std::vector<FieldLimit>& limits_;
};

/// A line of limit.csv: a row and a column of the cases.
struct LimitRow {
  const LimitAnswers& answers;
  std::size_t row, column;

  const LimitCase& asked() const { return answers.asked().at(row, column); }
  const FieldLimit& found() const { return answers.at(row, column); }
};
std::vector<LimitRow> rows_of(const LimitAnswers& answers);

/// The columns of limit.csv for these answers; without any all that there may be, for `describe`.
Columns<LimitRow> limit_columns(const LimitAnswers* answers);

/// The tables of the command.
std::vector<DescribedTable> limit_tables();

/// Writes limit.csv and limit_runs.csv, and tells what was found.
void tell_limits(const LimitAnswers& answers, Report& report);

}  // namespace hapbench
