#include "scenarios/batch/cases.hpp"

#include <gtest/gtest.h>

#include <set>

#include "tests/results/files.hpp"
#include "tests/scenarios/support/scenarios.hpp"

namespace hapbench::cases_test {
namespace {

using Values = std::vector<std::string>;

Cases cases_of(const Values& vary, std::optional<Sampling> sampling = {}) {
  std::vector<Axis> axes;
  for (const std::string& text : vary) axes.push_back(parse_axis(text, sampling.has_value()));
  return {{}, {}, std::move(axes), sampling};
}

TEST(Cases, OfAGridHaveAllCombinationsTheLastAxisFastest) {
  const Cases grid = cases_of({"a=1,2", "b=x", "c=p,q,r"});
  ASSERT_EQ(grid.size(), 6u);
  EXPECT_EQ(grid.values(0), (Values{"1", "x", "p"}));
  EXPECT_EQ(grid.values(3), (Values{"2", "x", "p"}));
  EXPECT_EQ(grid.values(5), (Values{"2", "x", "r"}));
  EXPECT_EQ(grid.changes(4), (Values{"a=2", "b=x", "c=q"}));
}

TEST(Cases, RefuseAFieldWhosePartIsVariedToo) {
  for (const Values& vary :
       {Values{"integrator=leapfrog,rk4", "integrator.type=rk4"}, Values{"a=1,2", "b=1", "a.b.c=3"},
        Values{"a.b=1,2", R"(a={"b":3},{"b":4})"}, Values{R"(a={"b":3},4)", "a.b=1"}})
    EXPECT_TRUE(test::input_error_of([&] { cases_of(vary); })) << vary.front();
  EXPECT_EQ(cases_of({R"(a={"b":3},{"b":4})", "a.c=1,2"}).size(), 4u) << "the second axis adds to the objects";
  EXPECT_EQ(cases_of({"a.b=1", "a.bc=1", "a.c=1,2"}).size(), 2u) << "fields beside each other";
}

TEST(Cases, AreThePointsOfAFile) {
  const test::TemporaryDirectory directory;
  const auto read = [&](const std::string& text) {
    test::write_plainly(directory / "points.csv", text);
    std::vector<Axis> axes;
    Sampling sampling = read_points(directory / "points.csv", axes);
    return Cases({}, {}, std::move(axes), std::move(sampling));
  };
  const Cases cases = read("environment.spacing_m,device\r\n2e-3,\"{\"\"type\"\": \"\"ideal\"\"}\"\n1e-3,x\n2e-3,x\n");
  ASSERT_EQ(cases.size(), 3u);
  EXPECT_EQ(cases.changes(0), (Values{"environment.spacing_m=0.002", R"(device={"type":"ideal"})"}));
  EXPECT_EQ(cases.values(2), (Values{"0.002", "x"}));
  EXPECT_EQ(cases.at(1), 2u) << "neighbours share an environment";
  EXPECT_EQ(read("a\n1\n\n2,\n").size(), 2u) << "an empty line and a separator at the end of a row";
  for (const auto& [text, says] :
       {std::pair{"a,b\n1\n", "points.csv, line 2: got 1 values"},
        std::pair{"a\n1\n,\n", "points.csv, line 3: a: got an empty value"},
        std::pair{"a,b\n1,2,3\n", "points.csv, line 2: got 3 values"}, std::pair{"a\n", "points.csv: has no rows"},
        std::pair{"", "has no rows"}, std::pair{"a,a\n1,2\n", "columns 1 and 2 are both named \"a\""}}) {
    const auto error = test::input_error_of([&, bad = text] { read(bad); });
    ASSERT_TRUE(error) << text;
    EXPECT_NE(std::string(error->what()).find(says), std::string::npos) << error->what();
  }
}

TEST(Cases, RefuseMoreRunsThanTheyMayHaveHoweverMany) {
  EXPECT_EQ(cases_of({"a=0:1:1000", "b=0:1:1000"}).size(), kMaxRuns);
  // Check a number of cases that exceeds 64 bits: 1000^7.
  Values vary;
  for (const char path : std::string("abcdefg")) vary.push_back(std::string(1, path) + "=0:1:1000");
  EXPECT_TRUE(test::input_error_of([&] { cases_of(vary); }));
}

using Numbers = std::vector<std::size_t>;

/// Returns the indices of the cases in the order of their runs.
Numbers order_of(const Cases& cases) {
  Numbers order;
  for (std::size_t place = 0; place < cases.size(); ++place) order.push_back(cases.at(place));
  return order;
}

TEST(Cases, OfOneEnvironmentFollowEachOther) {
  EXPECT_EQ(order_of(cases_of({"a=1,2", "b=1,2"})), (Numbers{0, 1, 2, 3}));
  EXPECT_EQ(order_of(cases_of({"a=1,2", "environment.spacing_m=1e-3,2e-3,3e-3", "environment.width_m=1,2"})),
            (Numbers{0, 6, 1, 7, 2, 8, 3, 9, 4, 10, 5, 11}));
  EXPECT_EQ(order_of(cases_of({"environment.width_m=1,2", "scenario=x,y"})), (Numbers{0, 2, 1, 3}));
}

TEST(Cases, OfASampleFollowEachOtherByTheListedFields) {
  const Cases cases =
      cases_of({"environment.file=x.stl,y.stl", "environment.scale=1:2", "a=1:2"}, Sampling{kLatinHypercube, 40, 1});
  const Numbers order = order_of(cases);
  EXPECT_EQ(std::set<std::size_t>(order.begin(), order.end()).size(), 40u);
  for (std::size_t i = 0; i < 40; ++i) EXPECT_EQ(cases.values(order[i])[0], i < 20 ? "x.stl" : "y.stl");
}

}  // namespace
}  // namespace hapbench::cases_test
