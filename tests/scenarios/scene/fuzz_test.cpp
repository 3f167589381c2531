#include <gtest/gtest.h>

#include <algorithm>
#include <ctime>

#include "results/io/columns.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/input/mesh_file.hpp"
#include "scenarios/input/point_shell_file.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "scenarios/scene/recordings.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/mesh_texts.hpp"
#include "tests/scenarios/support/mutation.hpp"
#include "tests/scenarios/support/scenarios.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/scale.hpp"

/// Tests valid files with a few bytes changed at random. Each changed file must be accepted or rejected: no crash, no
/// other exception, and no partly read content.
namespace hapbench::fuzz_test {
namespace {

namespace fs = std::filesystem;

/// Counts of accepted and rejected mutants of one kind of file.
struct Tally {
  std::size_t accepted = 0, refused = 0;
};

/// Calls `read` with mutants of the texts. `read` must return normally or throw an InputError of one line.
template <class Read>
Tally fuzz(const std::vector<std::string>& texts, std::size_t mutants, std::uint64_t seed, Read read) {
  Random random(seed);
  Tally tally;
  for (std::size_t i = 0; i < mutants && !testing::Test::HasFailure(); ++i) {
    const std::string mutant = test::mutated_text(texts[random.below(texts.size())], random);
    try {
      read(mutant);
      ++tally.accepted;
    } catch (const InputError& error) {
      ++tally.refused;
      const std::string message = error.what();
      EXPECT_EQ(message.find_first_of(std::string("\n\r\0\x1b", 4)), std::string::npos) << message;
      EXPECT_LT(message.size(), 3000u);
    } catch (const std::exception& error) {
      ADD_FAILURE() << error.what() << " for\n" << mutant;
    }
  }
  return tally;
}

/// Checks that the mutants are often accepted and often rejected, because otherwise they would test little.
void expect_mixture(const Tally& tally) {
  const std::size_t total = tally.accepted + tally.refused;
  EXPECT_GT(tally.accepted, total / 50);
  EXPECT_GT(tally.refused, total / 10);
}

TEST(Fuzz, ScenarioTextsAreReadOrRefused) {
  std::vector<std::string> texts;
  for (const auto& scenario : test::bundled_scenario_files()) texts.push_back(json_text(scenario.json));
  for (const auto& scenario : test::rich_scenarios()) texts.push_back(scenario.json.dump());
  expect_mixture(fuzz(texts, test::cases(40'000), 1, [](const std::string& text) {
    const Json json = parse_json(text);
    const Json effective = effective_scenario(read_scenario(json, "").scenario, "");
    // An accepted text is a scenario: reading its effective form gives the same effective form.
    EXPECT_EQ(effective_scenario(read_scenario(effective, "").scenario, ""), effective) << text;
  }));
}

TEST(Fuzz, PointShellsInCsvAreReadOrRefused) {
  const std::vector<std::string> texts = {test::read_file(test::data_directory() / "shell.csv"),
                                          "x_m,y_m,z_m,nx,ny,nz\r\n0,0,0,0,0,1\r\n1e-3,-2.5,0.125,0.6,0,-0.8"};
  expect_mixture(fuzz(texts, test::cases(10'000), 2, [](const std::string& text) {
    const auto points = parse_point_shell(text, "shell.csv");
    EXPECT_FALSE(points.empty());
    for (const SurfacePoint& point : points) {
      EXPECT_TRUE(point.position.cwiseAbs().maxCoeff() <= 1000.0) << text;
      EXPECT_NEAR(point.normal.norm(), 1.0, 1e-12) << text;
    }
  }));
}

TEST(Fuzz, PointShellsInPlyAreReadOrRefused) {
  const auto points = parse_point_shell(test::read_file(test::data_directory() / "shell.csv"), "shell.csv");
  const std::string text = format_point_shell({points[0], points[40], points[80]}, "x.ply");
  std::string binary =
      "ply\nformat binary_little_endian 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n"
      "property double nx\nproperty short ny\nproperty uchar nz\nelement face 1\nproperty list uchar int "
      "vertex_indices\nend_header\n";
  const std::string vertex = std::string(20, '\0') + std::string("\0\0\1", 3);  // normal (0, 0, 1)
  binary += vertex + vertex + std::string("\3\0\0\0\0\1\0\0\0\1\0\0\0", 13);
  expect_mixture(fuzz({text, binary}, test::cases(20'000), 3, [](const std::string& mutant) {
    for (const SurfacePoint& point : parse_point_shell(mutant, "shell.ply")) {
      EXPECT_TRUE(point.position.cwiseAbs().maxCoeff() <= 1000.0) << mutant;
      EXPECT_NEAR(point.normal.norm(), 1.0, 1e-12) << mutant;
    }
  }));
}

class MeshFuzz : public testing::TestWithParam<test::NamedText> {};
INSTANTIATE_TEST_SUITE_P(Formats, MeshFuzz, testing::ValuesIn(test::mesh_texts(test::sphere(1.0, 1))),
                         [](const auto& format) {
                           std::string name = format.param.name;
                           std::replace(name.begin(), name.end(), '.', '_');
                           return name;
                         });

TEST_P(MeshFuzz, MeshesAreReadOrRefusedSoon) {
  const Tally tally = fuzz({GetParam().text}, test::cases(2000), 6, [](const std::string& mutant) {
    const std::clock_t start = std::clock();
    const auto points = MeshFile(mutant, GetParam().name, {}).points();
    // Processor time does not depend on the load of the machine. A mutant takes some milliseconds.
    EXPECT_LT(std::clock() - start, 30 * CLOCKS_PER_SEC);
    EXPECT_FALSE(points.empty());
    for (const SurfacePoint& point : points) {
      EXPECT_TRUE(point.position.cwiseAbs().maxCoeff() <= 1000.0);
      EXPECT_NEAR(point.normal.norm(), 1.0, 1e-12);
    }
  });
  // If a byte is added or removed, most binary files no longer have their declared size and are rejected.
  EXPECT_GT(tally.accepted, 0u);
  EXPECT_GT(tally.refused, tally.accepted / 4);
}

TEST(Fuzz, RecordedMotionsAreReadOrRefused) {
  const std::string with_force = test::read_file(HAPBENCH_SCENARIOS "/examples/data/wipe.csv").substr(0, 3000);
  const std::vector<std::string> texts = {test::read_file(test::data_directory() / "stroke.csv"),
                                          with_force.substr(0, with_force.rfind('\n') + 1)};
  expect_mixture(fuzz(texts, test::cases(10'000), 4, [](const std::string& text) {
    const auto [motion, force] = parse_stroke(text, "stroke.csv");
    const auto sample = force ? force->at(0.01) : std::nullopt;
    EXPECT_TRUE(!sample || sample->allFinite());
    EXPECT_NEAR(motion.axis_at(-1.0).norm(), 1.0, 1e-12) << text;
    EXPECT_NEAR(motion.axis_at(1e9).norm(), 1.0, 1e-12) << text;
  }));
}

TEST(Fuzz, TracesAreReadOrRefused) {
  expect_mixture(fuzz({test::read_file(test::data_directory() / "trace.csv")}, test::cases(10'000), 4,
                      [](const std::string& text) {
                        const ContactTrace trace = parse_contact_trace(text, "trace.csv");
                        std::size_t from = 0;
                        for (std::size_t i = 0; i < trace.times.size(); ++i) {
                          EXPECT_EQ(trace.times[i].first == from, i == 0) << text;
                          EXPECT_TRUE(i == 0 || trace.times[i - 1].time < trace.times[i].time) << text;
                          from = trace.times[i].first;
                        }
                        for (const ContactTrace::Contact& contact : trace.contacts) {
                          EXPECT_NEAR(contact.gradient.norm(), 1.0, 2e-12) << text;
                          EXPECT_GE(contact.depth, 0.0) << text;
                        }
                      }));
}

TEST(Fuzz, GarbageIsRefused) {
  Random random(5);
  for (std::size_t i = 0; i < test::cases(2000); ++i) {
    std::string garbage;
    for (std::uint64_t n = random.below(300); n > 0; --n) garbage += static_cast<char>(random.below(256));
    EXPECT_THROW(read_scenario(parse_json(garbage), ""), InputError);
    for (const char* name : {"g.csv", "g.ply"}) EXPECT_THROW(parse_point_shell(garbage, name), InputError);
    EXPECT_THROW(parse_stroke(garbage, "g.csv"), InputError);
    EXPECT_THROW(parse_contact_trace(garbage, "g.csv"), InputError);
    for (const char* name : {"g.obj", "g.off", "g.stl", "g.ply"}) EXPECT_THROW(MeshFile(garbage, name, {}), InputError);
  }
}

}  // namespace
}  // namespace hapbench::fuzz_test
