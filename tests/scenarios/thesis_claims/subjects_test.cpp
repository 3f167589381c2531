#include "scenarios/thesis_claims/subjects.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "scenarios/input/installed_folder.hpp"

namespace hapbench::subjects_test {
namespace {

namespace fs = std::filesystem;

PublishedNumbers published() {
  return PublishedNumbers(installed_folder("results/reference") / "published");
}

TEST(Subjects, TheDistanceIsInSpreadsOfASingleSubjectAndEndsAtFive) {
  const PublishedNumbers p = published();
  // 7.78 ± 0.66 s of six subjects, printed to 0.01 s.
  const std::string time = "D1.time.original_averaging";
  const double s = std::sqrt(6.0 * 0.66 * 0.66 + 0.005 * 0.005);
  EXPECT_EQ(standardised_difference(p, time, 7.78), 0.0);
  EXPECT_NEAR(standardised_difference(p, time, 5.78), 2.0 / s, 1e-12);
  EXPECT_EQ(standardised_difference(p, time, -1e3), 5.0);
  EXPECT_EQ(standardised_difference(p, time, std::nan("")), 5.0);
  // All succeed, with no spread, printed as 1.0: what is left is the scatter of three targets, 1 / 12.
  EXPECT_NEAR(standardised_difference(p, "D3.success.shaped_stiffness", 0.8), 0.2 / std::sqrt(0.25 / 3.0 + 0.05 * 0.05),
              1e-12);
}

TEST(Subjects, SamplesLieInTheirRangesAndFillThem) {
  const SubjectsPlan plan = plan_subjects(published(), 8);
  ASSERT_EQ(plan.samples(), 8u);
  const auto unknowns = subject_unknowns();
  for (std::size_t i = 0; i < unknowns.size(); ++i) {
    const auto& [field, low, high, logarithmic, source] = unknowns[i];
    const double middle = logarithmic ? std::sqrt(low * high) : 0.5 * (low + high);
    int lower_half = 0;
    for (const auto& values : plan.values) {
      // Values have four digits.
      EXPECT_GE(values[i], low * (1 - 1e-3)) << field;
      EXPECT_LE(values[i], high * (1 + 1e-3)) << field;
      lower_half += values[i] < middle ? 1 : 0;
    }
    EXPECT_EQ(lower_half, 4) << field << ": a net in base two";
    EXPECT_GT(std::string(source).size(), 5u);
  }
}

TEST(Subjects, AreTheSameForAnyNumberOfJobsAndGoOnWhereTheyStopped) {
  const SubjectsPlan plan = plan_subjects(published(), 2);
  std::vector<std::string> tables;
  for (const std::size_t jobs : {1u, 2u}) {
    const fs::path directory = fs::path(testing::TempDir()) / ("subjects_" + std::to_string(jobs));
    fs::create_directories(directory);
    const SubjectsReport report = run_subjects(plan, directory, jobs, true);
    EXPECT_EQ(report.done, 2u);
    tables.push_back(subjects_table(plan, report.samples));
    const SubjectsReport again = run_subjects(plan, directory, jobs);
    EXPECT_EQ(subjects_table(plan, again.samples), tables.back());
    fs::remove_all(directory);
  }
  EXPECT_EQ(tables[0], tables[1]);
}

}  // namespace
}  // namespace hapbench::subjects_test
