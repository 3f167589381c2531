#include <gtest/gtest.h>

#include <algorithm>

#include "scenarios/input/text_lines.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/mesh_texts.hpp"
#include "tests/scenarios/support/program.hpp"
#include "tests/scenarios/support/scenarios.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/scale.hpp"

namespace hapbench::run_test {
namespace {

namespace fs = std::filesystem;
using test::hapbench;
using test::lines_of;
using test::ProgramRun;

// Tests the files, tables and times of hapbench run. tests/data/golden/ends.txt has the ends of runs and the texts on
// standard error.

using Names = std::vector<std::string>;

class RunCommand : public testing::Test {
 protected:
  std::string write_scenario(const std::string& name, const Json& json) const {
    test::write_plainly(directory_ / name, json.dump());
    return (directory_ / name).string();
  }
  std::string out(const std::string& name = "out") const { return (directory_ / name).string(); }
  Json json_file(const std::string& name) const { return Json::parse(test::read_file(directory_ / name)); }
  Json summary(const std::string& directory = "out") const { return json_file(directory + "/summary.json"); }

  test::TemporaryDirectory directory_;
};

TEST_F(RunCommand, WritesWhatTheScenarioRecords) {
  Json json = test::minimal_scenario("plane");
  json["record"] =
      Json::parse(R"({"trajectory": false, "contacts": true, "ratio_iterations": [0, 3], "stiffness_tensor": true,
                      "timing": true})");
  EXPECT_EQ(hapbench({"run", write_scenario("a.json", json), "--out", out()}).status, 0);
  EXPECT_EQ(test::names_below(out()),
            (Names{"columns.json", "contact_trace.csv", "contacts.csv", "ratios.csv", "scenario.effective.json",
                   "stiffness_tensor.csv", "summary.json", "timing.json"}));
  // Another run into the same directory leaves only its own files.
  json["record"] = Json::object();
  EXPECT_EQ(hapbench({"run", write_scenario("a.json", json), "--out", out()}).status, 0);
  EXPECT_EQ(test::names_below(out()),
            (Names{"columns.json", "scenario.effective.json", "summary.json", "trajectory.csv"}));
}

TEST_F(RunCommand, ShowsSevenColumnsAndARowForEachScenario) {
  const auto lines = lines_of(hapbench({"run", "single_spring", "single_damper", "--out", out()}).out);
  ASSERT_EQ(lines.size(), 13u);
  EXPECT_EQ(words_of(lines[2]).size(), 7u) << lines[2];
  EXPECT_EQ(lines[3].find("single_spring  summation  completes"), 0u) << lines[3];
  EXPECT_EQ(lines[4].find("single_damper  summation  completes"), 0u) << lines[4];
  EXPECT_EQ(lines[6],
            "mean force: mean of the rendered force in settled contact; vibration: rms of this force above 30 Hz");
  EXPECT_EQ(lines[7].find("99 % of the time steps are computed within "), 0u) << lines[7];
  EXPECT_EQ(lines[9], "diagnosis of single_damper: damping (0.998, threshold 0.5)");
  EXPECT_EQ(lines.back(), "results in " + out());
  const auto wide = lines_of(hapbench({"run", "single_spring", "--wide", "--out", out()}).out);
  EXPECT_EQ(words_of(wide[2]).size(), 14u) << wide[2];
}

TEST_F(RunCommand, OverridesFieldsForEveryScenarioAndPrintsTheSummariesAsJson) {
  const ProgramRun run = hapbench({"run", "single_spring", "single_damper", "--out", out(), "--set", "time.steps=5",
                                   "--set", "initial.position_m=[0.002, 0, 0]", "--json"});
  EXPECT_EQ(run.status, 0) << run.err;
  const Json json = run.json();
  ASSERT_EQ(json.size(), 2u);
  for (const Json& one : json) EXPECT_EQ(one["steps"], 5);
  EXPECT_EQ(json[0], summary("out/single_spring"));
  const auto rows = lines_of(test::read_file(directory_ / "out/single_damper/trajectory.csv"));
  ASSERT_EQ(rows.size(), 6u);
  EXPECT_EQ(test::cells_of(rows[1])[2], "0.002");
}

TEST_F(RunCommand, ThatDivergesKeepsWhatWasRecorded) {
  EXPECT_EQ(hapbench({"run", "single_spring_unstable", "--out", out()}).status, 0) << "it is expected";
  const Json s = summary(), divergence = s["divergence"];
  EXPECT_EQ(s["outcome"], "diverges");
  EXPECT_GT(divergence["magnitude"], divergence["bound"]);
  // All steps before the step that diverged are written.
  const auto step = divergence["step"].get<std::size_t>();
  const auto rows = lines_of(test::read_file(directory_ / "out/trajectory.csv"));
  EXPECT_EQ(rows.size(), 1 + step);
  EXPECT_EQ(s["steps"], step);
  EXPECT_EQ(test::cells_of(rows.back())[0], std::to_string(step - 1));
  EXPECT_NEAR(divergence["time_s"].get<double>(), 0.0005 * static_cast<double>(step), 1e-12);
  // Check divergence in the first step.
  hapbench({"run", "single_spring", "--out", out(), "--set", "bounds.position_m=1e-9"});
  EXPECT_EQ(summary()["divergence"]["step"], 0);
  EXPECT_EQ(summary()["metrics"]["final_position_m"], nullptr);
  EXPECT_EQ(lines_of(test::read_file(directory_ / "out/trajectory.csv")).size(), 1u);
}

TEST_F(RunCommand, TakesTheBeginningOfSettledContactFromTheScenario) {
  const auto settled = [this](const char* from) {
    hapbench({"run", "single_spring", "--out", out(), "--set", from});
    return summary()["metrics"]["settled_s"].get<double>();
  };
  EXPECT_DOUBLE_EQ(settled("metrics={}"), 0.15) << "0.2 s in contact, of which 0.05 s are the landing";
  EXPECT_DOUBLE_EQ(settled("metrics.from_s=0"), 0.2);
  EXPECT_TRUE(summary()["metrics"]["landing_force_max_N"].is_null());
  EXPECT_DOUBLE_EQ(settled("metrics.settling_s=0.125"), 0.075);
}

TEST_F(RunCommand, ExpectsOfTheIdealTrajectoryWhatTheRecordedRowsAre) {
  const std::string tenth = write_scenario("tenth.json", Json::parse(R"({
    "extends": "rotate_in_hole",
    "time": {"step_s": 0.0005, "steps": 50},
    "record": {"every": 5, "ideal_trajectory": true},
    "expect": {"outcome": "completes", "metrics": {"ideal_trajectory.gentle.rows": {"min": 10, "max": 10}}}})"));
  EXPECT_EQ(hapbench({"run", tenth, "--out", out()}).status, 0);
  EXPECT_EQ(hapbench({"run", tenth, "--out", out(), "--set", "record.every=10"}).status, 0) << "another run";
}

TEST_F(RunCommand, KeepsItsWarnings) {
  const std::string text =
      hapbench({"run", "mesh_molar", "--out", out(), "--set", "environment.scale=1e-6", "--set", "expect={}"}).err;
  const Json warnings = summary()["warnings"];
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(text.find(warnings[0].get<std::string>()), std::string::npos) << text;
}

/// Fixture of the tests of `hapbench run --latency` and record.timing.
class Latency : public RunCommand {};

TEST_F(Latency, TimesEveryStepAndPrintsATable) {
  const ProgramRun run = hapbench({"run", "drill_in_hole", "single_damper", "--out", out(), "--latency"});
  EXPECT_EQ(run.status, 0) << run.err;
  const auto lines = lines_of(run.out);
  const auto header = std::ranges::find_if(lines, [](const auto& line) { return line.find("p99.9 us") != line.npos; });
  ASSERT_LT(header + 3, lines.end()) << run.out;
  EXPECT_EQ(run.out.find("99 % of the time steps"), std::string::npos) << "a second set of percentiles";
  EXPECT_EQ(header[2].find("drill_in_hole"), 0u);
  EXPECT_EQ(header[3].find("single_damper"), 0u);
  EXPECT_EQ(json_file("out/drill_in_hole/timing.json")["step_latency"]["steps"], summary("out/drill_in_hole")["steps"]);
}

TEST_F(Latency, IsPartOfTheJsonAndOfNoOtherFile) {
  const ProgramRun run = hapbench({"run", "single_spring", "--out", out("a"), "--latency", "--json"});
  EXPECT_EQ(run.json()[0]["step_latency"], json_file("a/timing.json")["step_latency"]);
  EXPECT_FALSE(summary("a").contains("step_latency"));
  // The option gives the same result as the field of the scenario. Without the option, all results except times are the
  // same.
  hapbench({"run", "single_spring", "--out", out("b"), "--set", "record.timing=true"});
  test::expect_same_files(directory_ / "a", directory_ / "b", {"timing.json"});
  hapbench({"run", "single_spring", "--out", out("c")});
  EXPECT_EQ(test::read_file(directory_ / "a/trajectory.csv"), test::read_file(directory_ / "c/trajectory.csv"));
}

// Tests hostile input with the real program: exit status 2, one line on standard error that names file and position, no
// output files, short time and bounded memory. tests/data/golden/refused_*.txt has the texts for ordinary mistakes,
// tests/scenarios/scene/scenario_schema_test.cpp the errors of every field, tests/scenarios/input/json_file_test.cpp
// texts that are no JSON.

/// Processor time within which bad input must be rejected. The optimized program takes less than a tenth of it; code
/// that is not optimized or is sanitized is up to thirty times slower.
#if defined(__OPTIMIZE__) && !HAPBENCH_TEST_SANITIZED
constexpr double kMaxSeconds = 10.0;
#else
constexpr double kMaxSeconds = 100.0;
#endif
/// Maximum address space of the program [bytes]. The largest file that the program reads has 64 MiB. Such a file has at
/// most 64 Mi values, and 16 bytes for each value are a gigabyte.
constexpr std::size_t kMaxMemory = HAPBENCH_TEST_SANITIZED ? 0 : std::size_t{3} << 30;

struct BadInput {
  std::string name;
  std::string (*scenario)();                            ///< returns the text of the scenario file
  std::string says;                                     ///< expected text of the message after the scenario's file
  std::pair<std::string, std::string (*)()> file = {};  ///< name and text of a file next to the scenario
};
void PrintTo(const BadInput& input, std::ostream* out) {  // NOLINT: GoogleTest's name
  *out << input.name;
}

/// Returns the text of the minimal scenario of a plane, with the text `value` at the JSON pointer `pointer`. `value`
/// may be invalid JSON.
std::string with(const std::string& pointer, const std::string& value) {
  Json json = test::minimal_scenario("plane");
  json[Json::json_pointer(pointer)] = "@@";
  std::string text = json.dump();
  return text.replace(text.find("\"@@\""), 4, value);
}

std::string repeated(std::size_t n, const std::string& text) {
  std::string all;
  for (std::size_t i = 0; i < n; ++i) all += text;
  return all;
}

std::string shell() {
  return with("/environment", R"({"type": "point_shell", "file": "s.ply"})");
}
template <char... kExtension>
std::string mesh() {
  return with("/environment",
              std::string(R"({"type": "mesh", "scale": 0.001, "file": "m.)") + std::string({kExtension...}) + "\"}");
}

/// Returns a PLY header of a binary mesh with three vertices.
std::string ply_header(const std::string& faces, const std::string& list = "property list uchar int vertex_indices\n") {
  return "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
         "z\nelement face " +
         faces + "\n" + list + "end_header\n";
}

const std::string kSyntax = "is not JSON: ";
const BadInput kInputs[] = {
    {"ZeroByteAtTheEnd", [] { return with("/seed", "1") + std::string(1, '\0'); }, kSyntax},
    {"InvalidUtf8InAKey", [] { return std::string("{\"ti\xffme\": 1}"); }, kSyntax},
    {"KeyWithSlashAndLineBreak", [] { return with("/time", R"({"step_s": 1, "steps": 1, "a/b~c": 1})"); },
     "/time/a~1b~0c: unknown field"},
    {"NestedAndClosedLists", [] { return std::string(200'000, '[') + std::string(200'000, ']'); }, "/0/0"},
    {"NestedObjects", [] { return repeated(200'000, "{\"a\":"); }, "/a/a"},
    {"HugeNumberOfDigits", [] { return with("/time/step_s", "1" + std::string(5000, '0')); }, "/time/step_s: "},
    {"TooManyRecordedRows", [] { return with("/time/steps", "30000000"); }, "/record/every: "},
    {"PlaneOfTinySpacing", [] { return with("/environment/spacing_m", "5e-324"); }, "got inf shell points"},
    {"HugeKey", [] { return with("/time", "{}, \"" + std::string(10'000'000, 'k') + "\": 1"); }, "/kkkkkkkkkk"},
    {"HugeText", [] { return with("/description", "\"" + std::string(10'000'000, 'x') + "\""); },
     "/description: got \"xxxxx"},
    {"HugeList", [] { return with("/time", "[0" + repeated(4'999'999, ",0") + "]"); },
     "/time: got a list of 5000000 entries"},
    {"TooManyWaypoints",
     [] {
       return with("/hand", R"({"type": "force", "x_N": {"type": "waypoints", "points": [[0,0])" +
                                repeated(1'000'000, ",[1,0]") + "]}}");
     },
     "/hand/x_N/points: got a list of 1000001 entries"},
    {"FileTooLarge", [] { return std::string((64 << 20) + 1, ' '); }, "is larger than 64 MiB"},
    {"FileIsADirectory", shell, "is a directory, not a file", {"s.ply/inside", [] { return std::string(); }}},
    {"MoebiusBand",
     mesh<'o', 'b', 'j'>,
     "is not orientable: no winding fits all faces around (",
     {"m.obj", [] { return test::obj_text(test::moebius_band(9)); }}},
    {"StlHugeCount",
     mesh<'s', 't', 'l'>,
     "is not an STL file, or cut short",
     {"m.stl",
      [] { return std::string(80, ' ') + "\xff\xff\xff\xff" + test::binary_stl_text(test::cube()).substr(84); }}},
    {"StlNanVertex",
     mesh<'s', 't', 'l'>,
     "triangle 1: a vertex is not finite",
     {"m.stl", [] { return test::binary_stl_text(test::cube()).replace(84 + 50 + 12, 4, "\xff\xff\xff\x7f"); }}},
    {"OffBinary",
     mesh<'o', 'f', 'f'>,
     "is a binary OFF file; allowed: a text, or binary PLY or STL",
     {"m.off", [] { return "OFF BINARY\n" + std::string("\x08\0\0\0\x0c\0\0\0\0\0\0\0", 12); }}},
    {"PlyMeshHugeCount",
     mesh<'p', 'l', 'y'>,
     "the file is cut short: it ends after 0 of its 4000000000 \"face\"",
     {"m.ply", [] { return ply_header("4000000000") + std::string(36, '\0'); }}},
    {"PlyMeshHugeFace",
     mesh<'p', 'l', 'y'>,
     "the file is cut short: it ends after 0 of its 1 \"face\"",
     {"m.ply",
      [] {
        return ply_header("1", "property list int int vertex_indices\n") + std::string(36, '\0') + "\xff\xff\xff\x7f";
      }}},
    {"PlyMeshNegativeList",
     mesh<'p', 'l', 'y'>,
     "got a list of -1 entries",
     {"m.ply",
      [] {
        return ply_header("1", "property list char int other\nproperty list uchar int vertex_indices\n") +
               std::string(36, '\0') + "\xff";
      }}},
};

class BadInputs : public testing::TestWithParam<BadInput> {};
INSTANTIATE_TEST_SUITE_P(Hostile, BadInputs, testing::ValuesIn(kInputs),
                         [](const auto& input) { return input.param.name; });

TEST_P(BadInputs, AreRefusedInOneLineAndNothingIsWritten) {
  const BadInput& input = GetParam();
  const test::TemporaryDirectory directory;
  const fs::path scenario = directory / "bad input.json";
  test::write_plainly(scenario, input.scenario());
  if (const auto& [name, text] = input.file; text != nullptr) {
    fs::create_directories((directory / name).parent_path());
    test::write_plainly(directory / name, text());
  }
  const auto before = test::names_below(directory.path());

  test::ProgramOptions options;
  options.memory_limit = kMaxMemory;
  const test::ProgramRun run =
      test::hapbench({"run", scenario.string(), "--out", (directory / "out/below").string()}, options);

  EXPECT_EQ(run.signal, 0);
  EXPECT_EQ(run.status, 2);
  EXPECT_EQ(run.out, "");
  EXPECT_LT(run.cpu_seconds, kMaxSeconds);
  EXPECT_LT(run.err.size(), 10'000u);
  const std::vector<std::string> lines = test::lines_of(run.err);
  ASSERT_FALSE(lines.empty());
  EXPECT_EQ(lines[0].find("hapbench: error: " + scenario.string() + ": "), 0u) << run.err;
  EXPECT_NE(lines[0].find(input.says), std::string::npos) << run.err;
  for (const std::string& line : lines) {
    for (const char c : line) ASSERT_FALSE(static_cast<unsigned char>(c) < 0x20) << "control character";
  }
  EXPECT_EQ(test::names_below(directory.path()), before);
}

}  // namespace
}  // namespace hapbench::run_test
