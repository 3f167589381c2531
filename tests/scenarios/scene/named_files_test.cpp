#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "algorithms/registry.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/json_file.hpp"
#include "scenarios/input/shared_cache.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/checked_scenario.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "scenarios/scene/named_files.hpp"
#include "sim/core/hash.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/scenarios.hpp"

namespace hapbench::named_files_test {
namespace {

namespace fs = std::filesystem;

class NamedFilesOfAScenario : public testing::Test {
 protected:
  NamedFilesOfAScenario() {
    for (const char* name : {"cube.obj", "shell.csv", "stroke.csv"})
      test::write_plainly(directory_ / name, test::read_file(test::data_directory() / name));
  }
  LoadedScenario load(const char* environment, const char* patch = "{}") const {
    Json json = test::minimal_scenario(environment);
    json.merge_patch(Json::parse(patch));
    return read_scenario(json, directory_.path());
  }

  test::TemporaryDirectory directory_;
};

constexpr const char* kStroke = R"({"motion": {"position": {"type": "file", "file": "stroke.csv"}}})";

TEST_F(NamedFilesOfAScenario, AreThoseItNames) {
  const NamedFiles none = load("plane").files;
  EXPECT_TRUE(none.all().empty());
  const NamedFiles both = load("point_shell", kStroke).files;
  ASSERT_EQ(both.all().size(), 2u);
  ASSERT_NE(both.find(kEnvironmentFile), nullptr);
  ASSERT_NE(both.find(kMotionFile), nullptr);
  EXPECT_EQ(both.find(kToolFile), nullptr);
  EXPECT_EQ(both.at(kEnvironmentFile).path(), directory_ / "shell.csv");
  for (const auto& file : both.all()) EXPECT_EQ(file->hash(), hash_text(hash_of(test::read_file(file->path()))));
}

// Checks that a loaded scenario does not read its files again: if a file is missing later, a run and the provenance
// that it reports are the same.
TEST_F(NamedFilesOfAScenario, AreReadOnce) {
  for (const char* environment : {"mesh", "point_shell"}) {
    const CheckedScenario scene = checked(load(environment, kStroke));
    const Result report = run_scenario(scene, directory_ / "out", false);
    for (const char* name : {"cube.obj", "shell.csv", "stroke.csv"})
      fs::rename(directory_ / name, directory_ / (std::string(name) + ".gone"));
    const Result again = run_scenario(scene, directory_ / "again", false);
    EXPECT_EQ(again.state_hash, report.state_hash);
    EXPECT_EQ(again.scenario_hash, report.scenario_hash);
    EXPECT_THROW(checked(load(environment, kStroke)), InputError);
    for (const char* name : {"cube.obj", "shell.csv", "stroke.csv"})
      fs::rename(directory_ / (std::string(name) + ".gone"), directory_ / name);
  }
}

// Checks that parallel laws share the parsed mesh, the shell and the solid. The unusual scale avoids cached values of
// other tests.
TEST_F(NamedFilesOfAScenario, AreParsedOnceForAllLaws) {
  const std::size_t before = shared_cache().made();
  for (const AlgorithmEntry& algorithm : algorithms()) {
    Json patch = {{"environment", {{"scale", 0.00123}}}, {"rendering", {{"algorithm", algorithm.info->name}}}};
    run_scenario(checked(load("mesh", patch.dump().c_str())), {}, false);
  }
  EXPECT_EQ(shared_cache().made() - before, 3u);
}

}  // namespace
}  // namespace hapbench::named_files_test
