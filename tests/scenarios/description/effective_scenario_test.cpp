#include <gtest/gtest.h>

#include "results/io/json_text.hpp"
#include "scenarios/description/bundled_scenarios.hpp"
#include "scenarios/description/load_scenario.hpp"
#include "scenarios/input/json_file.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/errors.hpp"
#include "tests/scenarios/support/scenarios.hpp"

/// The effective scenario, every default filled in, is a scenario file that means the same.
namespace hapbench::effective_scenario_test {
namespace {

namespace fs = std::filesystem;

std::string content_hash(const Scenario& scenario) {
  return scenario_hash(scenario, NamedFiles(scenario));
}

void expect_fixed_point(const Scenario& scenario, const fs::path& directory) {
  const Json effective = effective_scenario(scenario, directory);
  // Through text, as the file is.
  const LoadedScenario again = read_scenario(parse_json(json_text(effective)), directory);
  EXPECT_EQ(json_text(effective_scenario(again.scenario, directory)), json_text(effective));
  EXPECT_EQ(again.warnings, std::vector<std::string>{});
  EXPECT_EQ(content_hash(again.scenario), content_hash(scenario));
}

TEST(EffectiveScenario, OfEveryBundledScenarioIsAFixedPoint) {
  for (const BundledScenario& bundled : bundled_scenarios()) {
    SCOPED_TRACE(bundled.name);
    expect_fixed_point(load_scenario(bundled.file).scenario, bundled.file.parent_path());
  }
}

TEST(EffectiveScenario, OfEveryKindOfFieldIsAFixedPoint) {
  for (const auto& list : {test::minimal_scenarios(), test::rich_scenarios()}) {
    for (const test::NamedScenario& scenario : list) {
      SCOPED_TRACE(scenario.name);
      expect_fixed_point(read_scenario(scenario.json, test::data_directory()).scenario, test::data_directory());
    }
  }
}

TEST(EffectiveScenario, KeepsGivenNumbersToTheLastBit) {
  Json json = test::minimal_scenario("plane");
  const double numbers[] = {0.1, 1.0 / 3.0, 1e-300, 123456789.123456789};
  for (const double number : numbers) {
    json["rendering"]["stiffness_N_per_m"] = number;
    const Json effective = effective_scenario(read_scenario(json, "").scenario, "");
    EXPECT_EQ(parse_json(json_text(effective))["rendering"]["stiffness_N_per_m"].get<double>(), number);
  }
}

class EffectivePaths : public testing::Test {
 protected:
  EffectivePaths() {
    fs::create_directories(directory_ / "scenes here/data");
    fs::create_directories(directory_ / "out/deep/er");
    fs::copy_file(test::data_directory() / "shell.csv", shell_);
    Json json = test::minimal_scenario("point_shell");
    json["environment"]["file"] = "data/shell.csv";
    test::write_plainly(scenario_, json.dump());
  }
  /// Where the file named in the effective scenario of `output` leads.
  fs::path file_from(const fs::path& output) const {
    const Json effective = effective_scenario(load_scenario(scenario_).scenario, output);
    return fs::canonical(output / effective["environment"]["file"].get<std::string>());
  }

  test::TemporaryDirectory directory_;
  fs::path scenario_ = directory_ / "scenes here/scene.json";
  fs::path shell_ = directory_ / "scenes here/data/shell.csv";
};

TEST_F(EffectivePaths, LeadFromTheOutputDirectoryToTheSameFile) {
  for (const char* output : {"out", "out/deep/er", "scenes here", "scenes here/data", "."}) {
    EXPECT_EQ(file_from(directory_ / output), fs::canonical(shell_)) << output;
  }
}

TEST_F(EffectivePaths, LeadThereThroughLinksToo) {
  fs::create_directory_symlink(directory_ / "out/deep/er", directory_ / "link");
  EXPECT_EQ(file_from(directory_ / "link"), fs::canonical(shell_));
  fs::create_directory_symlink(directory_ / "scenes here", directory_ / "out/scenes");
  const Json effective =
      effective_scenario(load_scenario(directory_ / "out/scenes/scene.json").scenario, directory_ / "link");
  EXPECT_EQ(fs::canonical(directory_ / "link" / effective["environment"]["file"].get<std::string>()),
            fs::canonical(shell_));
}

TEST_F(EffectivePaths, MayBeAbsolute) {
  Json json = test::minimal_scenario("point_shell");
  json["environment"]["file"] = shell_.string();
  test::write_plainly(scenario_, json.dump());
  EXPECT_EQ(file_from(directory_ / "out"), fs::canonical(shell_));
}

TEST_F(EffectivePaths, WorkForAScenarioOfTheCurrentDirectory) {
  // Its directory is the empty path.
  EXPECT_NO_THROW(effective_scenario(read_scenario(test::minimal_scenario("point_shell"), "").scenario, ""));
}

TEST(ScenarioHash, FollowsContentsNotPaths) {
  const test::TemporaryDirectory directory;
  const std::string shell = test::read_file(test::data_directory() / "shell.csv");
  test::write_plainly(directory / "a.csv", shell);
  test::write_plainly(directory / "b.csv", shell);
  const auto hash_with = [&directory](const char* file) {
    Json json = test::minimal_scenario("point_shell");
    json["environment"]["file"] = file;
    return content_hash(read_scenario(json, directory.path()).scenario);
  };
  const std::string hash = hash_with("a.csv");
  EXPECT_EQ(hash_with("b.csv"), hash);
  test::write_plainly(directory / "b.csv", shell + "0,0,0,0,0,1\n");
  EXPECT_NE(hash_with("b.csv"), hash);
}

TEST(ScenarioHash, FollowsTheContentsOfMeshes) {
  const test::TemporaryDirectory directory;
  const auto hash_of_text = [&directory](const std::string& text) {
    test::write_plainly(directory / "cube.obj", text);
    return content_hash(read_scenario(test::minimal_scenario("mesh"), directory.path()).scenario);
  };
  const std::string cube = test::read_file(test::data_directory() / "cube.obj");
  EXPECT_EQ(hash_of_text(cube), hash_of_text(cube));
  EXPECT_NE(hash_of_text(cube), hash_of_text(cube + "# more\n"));
}

TEST(ScenarioHash, DiffersWhenAnyFieldDiffers) {
  const auto hash_with = [](const char* patch) {
    Json json = test::minimal_scenario("plane");
    json.merge_patch(Json::parse(patch));
    return content_hash(read_scenario(json, "").scenario);
  };
  const std::string hash = hash_with("{}");
  EXPECT_EQ(hash_with(R"({"rendering": {"stiffness_N_per_m": 2e4}})"), hash);
  for (const char* patch : {R"({"rendering": {"stiffness_N_per_m": 20000.000000000004}})", R"({"seed": 2})",
                            R"({"time": {"steps": 21}})", R"({"record": {"contacts": true}})"}) {
    EXPECT_NE(hash_with(patch), hash) << patch;
  }
}

}  // namespace
}  // namespace hapbench::effective_scenario_test
