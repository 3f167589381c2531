#include <gtest/gtest.h>

#include "tests/results/files.hpp"
#include "tests/scenarios/support/program.hpp"

namespace hapbench::bad_sweeps_test {
namespace {

namespace fs = std::filesystem;
using test::hapbench;
using test::lines_of;
using test::ProgramRun;
using Words = std::vector<std::string>;

struct BadSweep {
  const char* name;
  Words words;
  const char* says;
};
void PrintTo(const BadSweep& sweep, std::ostream* out) {  // NOLINT: GoogleTest's name
  *out << sweep.name;
}

class BadSweeps : public testing::TestWithParam<BadSweep> {};

TEST_P(BadSweeps, AreRefusedInOneLineAndNothingIsWritten) {
  const test::TemporaryDirectory directory;
  Words words = {"sweep", "single_spring", "--out", (directory / "out").string()};
  words.insert(words.end(), GetParam().words.begin(), GetParam().words.end());
  const ProgramRun run = hapbench(words);
  EXPECT_EQ(run.status, 2);
  EXPECT_EQ(run.out, "");
  EXPECT_EQ(lines_of(run.err).size(), 1u) << run.err;
  EXPECT_EQ(run.err.find("hapbench: error: "), 0u) << run.err;
  EXPECT_NE(run.err.find(GetParam().says), std::string::npos) << run.err;
  EXPECT_NE(run.err.find("allowed"), std::string::npos) << run.err;
  EXPECT_LT(run.err.size(), 2000u);
  EXPECT_FALSE(fs::exists(directory / "out"));
}

Words vary(const std::string& text) {
  return {"--vary", text};
}

const BadSweep kBadSweeps[] = {
    {"NoPath", vary("1:2:3"), "--vary \"1:2:3\": has no path"},
    {"EmptyPath", vary("=1:2:3"), "has no path"},
    {"NoValue", vary("time.steps="), "got an empty value"},
    {"EmptyValue", vary("time.steps=1,,2"), "got an empty value"},
    {"UnknownField", vary("time.stepss=1,2"), "/time/stepss: unknown field; allowed here: "},
    {"UnknownSection", vary("tyme.steps=1,2"), "/tyme: unknown field"},
    {"ListIndex", vary("environment.groups.7.count=1,2"), "environment.groups.7.count: got list index \"7\""},
    {"TwoParts", vary("time.step_s=1:2"), "got 2 parts between colons"},
    {"FiveParts", vary("time.step_s=1:2:3:log:log"), "got 5 parts between colons"},
    {"TextForAnEnd", vary("time.step_s=a:2:3"), "got \"a\" for an end of the range"},
    {"NoEnd", vary("time.step_s=:2:3"), "got \"\" for an end of the range"},
    {"NaN", vary("time.step_s=nan:2:3"), "got \"nan\" for an end of the range"},
    {"InfiniteEnd", vary("time.step_s=0:inf:3"), "got \"inf\" for an end of the range"},
    {"EndBeyondDouble", vary("time.step_s=0:1e999:3"), "got \"1e999\" for an end of the range"},
    {"OneValue", vary("time.step_s=1e-4:2e-4:1"), "got \"1\" values"},
    {"NegativeCount", vary("time.step_s=1e-4:2e-4:-5"), "got \"-5\" values"},
    {"FractionalCount", vary("time.step_s=1e-4:2e-4:2.5"), "got \"2.5\" values"},
    {"HugeCount", vary("time.step_s=1e-4:2e-4:1000000000000"), "allowed: an integer 2 ... 1000000"},
    {"NotLog", vary("time.step_s=1e-4:2e-4:5:lin"), "got \"lin\"; allowed: \"log\""},
    {"LogFromZero", vary("time.step_s=0:2e-4:5:log"), "of a logarithmic range; allowed: numbers > 0"},
    {"OutOfRange", vary("time.step_s=-0.1:0.1:3"), "/time/step_s: got -0.1"},
    {"NoInteger", vary("time.steps=1:10:3"), "/time/steps: got 5.5"},
    {"NoSuchAlgorithm", vary("rendering.algorithm=mean,meen"), "got \"meen\""},
    {"ListedNumberBeyondDouble", vary("time.step_s=0.1,1e999"), "/time/step_s"},
    {"Quotes", vary("name=\"a\",b"), "quotes or control characters"},
    {"LineBreak", vary("name=a\nb,c"), "quotes or control characters"},
    {"CommaInThePath", vary("a,b=1,2"), "has no path"},
    {"OneFieldTwice", {"--vary", "seed=1,2", "--vary", "seed=3,4"}, "got \"seed\" twice"},
    {"TooManyRuns",
     {"--vary", "seed=1:1000:1000", "--vary", "time.steps=1:1001:1001"},
     "got a grid of 1001000 runs; allowed: at most 1000000"},
    {"RangeWithACountBesideASample", {"--vary", "seed=1:9:9", "--sample", "lhs:4"}, "beside --sample"},
    {"RangeWithoutACount", vary("time.step_s=1e-4:2e-4"), "a:b and a:b:log with --sample"},
    {"NoSuchSample", {"--vary", "seed=1,2", "--sample", "halton:4"}, "--sample: got \"halton:4\""},
    {"ShardBeyondTheLast", {"--vary", "seed=1,2", "--shard", "2/2"}, "--shard: got \"2/2\""},
    {"ShardWithoutCount", {"--vary", "seed=1,2", "--shard", "1"}, "--shard: got \"1\""},
    {"NegativeJobs", {"--vary", "seed=1,2", "--jobs=-1"}, "--jobs: got -1"},
    {"TooManyJobs", {"--vary", "seed=1,2", "--jobs", "100000"}, "--jobs: got 100000"},
    {"MoreShardsThanRuns", {"--vary", "seed=1,2", "--slurm", "3", "--dry-run"}, "--slurm: got 3 shards of 2 runs"},
    {"TimeThatIsNone", {"--vary", "seed=1,2", "--slurm", "2", "--time", "1 h"}, "--time, --partition: got \"1 h\""},
    {"BadSet", {"--vary", "seed=1,2", "--set", "time.steps=0"}, "/time/steps: got 0"},
};

INSTANTIATE_TEST_SUITE_P(Texts, BadSweeps, testing::ValuesIn(kBadSweeps),
                         [](const auto& sweep) { return std::string(sweep.param.name); });

}  // namespace
}  // namespace hapbench::bad_sweeps_test
