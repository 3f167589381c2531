#include <gtest/gtest.h>

#include <algorithm>

#include "tests/results/files.hpp"
#include "tests/scenarios/support/file_tree.hpp"
#include "tests/scenarios/support/mesh_texts.hpp"
#include "tests/scenarios/support/program.hpp"
#include "tests/scenarios/support/scenarios.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/scale.hpp"

/// Hostile input, given to the real program: exit status 2, one line on standard error that names file and place,
/// nothing written, soon, in bounded memory. The wording for ordinary mistakes is in tests/data/golden/refused_*.txt,
/// refusals of every field in tests/scenarios/format/schema_agreement_test.cpp, of texts that are no JSON in
/// tests/scenarios/format/json_file_test.cpp.
namespace hapbench::bad_input_test {
namespace {

namespace fs = std::filesystem;

/// Processor time within which bad input must be refused; it takes less than a tenth of it as people run the program.
/// Code that is not optimised or is sanitized is up to thirty times slower.
#if defined(__OPTIMIZE__) && !HAPBENCH_TEST_SANITIZED
constexpr double kMostSeconds = 10.0;
#else
constexpr double kMostSeconds = 100.0;
#endif
/// Address space it may take: the largest file read is 64 MiB, and 16 bytes a value of it are a gigabyte.
constexpr std::size_t kMostMemory = HAPBENCH_TEST_SANITIZED ? 0 : std::size_t{3} << 30;

struct BadInput {
  std::string name;
  std::string (*scenario)();                            ///< makes the text of the scenario file
  std::string says;                                     ///< in the message, behind the scenario's file
  std::pair<std::string, std::string (*)()> file = {};  ///< name and text of a file beside the scenario
};
void PrintTo(const BadInput& input, std::ostream* out) {  // NOLINT: GoogleTest's name
  *out << input.name;
}

/// The minimal scenario of a plane with `value`, JSON or not, at the pointer.
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

/// A PLY header of a binary mesh of three vertices.
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
     "the file ends before its 4000000000 \"face\"",
     {"m.ply", [] { return ply_header("4000000000") + std::string(36, '\0'); }}},
    {"PlyMeshHugeFace",
     mesh<'p', 'l', 'y'>,
     "the file ends before its 1 \"face\"",
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
  options.memory_limit = kMostMemory;
  const test::ProgramRun run =
      test::hapbench({"run", scenario.string(), "--out", (directory / "out/below").string()}, options);

  EXPECT_EQ(run.signal, 0);
  EXPECT_EQ(run.status, 2);
  EXPECT_EQ(run.out, "");
  EXPECT_LT(run.cpu_seconds, kMostSeconds);
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
}  // namespace hapbench::bad_input_test
