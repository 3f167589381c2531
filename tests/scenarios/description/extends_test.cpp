#include "scenarios/description/extends.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "scenarios/description/scenario_text.hpp"
#include "scenarios/run/assemble.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/errors.hpp"
#include "tests/scenarios/support/scenarios.hpp"

/// "extends"
namespace hapbench::extends_test {
namespace {

namespace fs = std::filesystem;

constexpr const char* kBase = R"({
  "name": "the base", "description": "springs",
  "time": {"step_s": 0.0005, "steps": 20},
  "environment": {"type": "springs", "groups": [{"direction": [1, 0, 0], "count": 2}]},
  "hand": {"type": "force", "x_N": {"type": "ramp", "start": 1, "rate_per_s": 2}},
  "rendering": {"reduction": {"threshold": 0.9}, "stiffness_N_per_m": 1000},
  "expect": {"outcome": "diverges"}
})";

class Extends : public testing::Test {
 protected:
  fs::path write(const std::string& name, const std::string& text) const {
    fs::create_directories((directory_ / name).parent_path());
    test::write_plainly(directory_ / name, text);
    return directory_ / name;
  }
  Json merged(const std::string& text) const {
    write("base.json", kBase);
    return read_scenario_text(write("mine.json", text)).json;
  }
  std::string refusal(const fs::path& file, const std::vector<std::string>& overrides = {}) const {
    const auto error = test::input_error_of([&] { check_named_files(load_scenario(file, overrides)); });
    return error ? error->what() : "";
  }

  test::TemporaryDirectory directory_;
};

TEST_F(Extends, MergesObjectsFieldByField) {
  const Json json = merged(R"({"extends": "base.json", "rendering": {"stiffness_N_per_m": 5, "mass_kg": 1},
    "environment": {"bilateral": false}})");
  EXPECT_EQ(json["rendering"],
            Json::parse(R"({"reduction": {"threshold": 0.9}, "stiffness_N_per_m": 5, "mass_kg": 1})"));
  EXPECT_EQ(json["environment"]["type"], "springs");
  EXPECT_EQ(json["environment"]["bilateral"], false);
  EXPECT_EQ(json["time"], Json::parse(kBase)["time"]);
  EXPECT_FALSE(json.contains("extends"));
}

TEST_F(Extends, NullAndListsReplace) {
  const Json json =
      merged(R"({"extends": "base.json", "rendering": {"reduction": null}, "environment": {"groups": []}})");
  ASSERT_TRUE(json["rendering"].contains("reduction"));
  EXPECT_TRUE(json["rendering"]["reduction"].is_null());
  EXPECT_EQ(json["environment"]["groups"], Json::array());
}

TEST_F(Extends, AnObjectOfAnotherTypeReplacesAllOfIt) {
  EXPECT_EQ(merged(R"({"extends": "base.json", "environment": {"type": "plane"}})")["environment"],
            Json::parse(R"({"type": "plane"})"));
  EXPECT_EQ(merged(R"({"extends": "base.json", "hand": {"x_N": {"type": "sine", "mean": 1}}})")["hand"],
            Json::parse(R"({"type": "force", "x_N": {"type": "sine", "mean": 1}})"));
  EXPECT_EQ(merged(R"({"extends": "base.json", "hand": {"type": "force", "y_N": 3}})")["hand"],
            Json::parse(R"({"type": "force", "x_N": {"type": "ramp", "start": 1, "rate_per_s": 2}, "y_N": 3})"));
}

TEST_F(Extends, OneOfTwoFieldsThatExcludeEachOtherDrivesOutTheOther) {
  EXPECT_EQ(merged(R"({"extends": "base.json", "time": {"duration_s": 3}})")["time"],
            Json::parse(R"({"step_s": 0.0005, "duration_s": 3})"));
}

TEST_F(Extends, NeitherNameNorExpectIsTakenOver) {
  merged(R"({"extends": "base.json"})");
  const Scenario scenario = load_scenario(directory_ / "mine.json").scenario;
  EXPECT_EQ(scenario.name, "mine");
  EXPECT_EQ(scenario.description, "springs");
  EXPECT_EQ(scenario.expect.outcomes, Scenario{}.expect.outcomes);
}

TEST_F(Extends, KnowsBundledScenariosByName) {
  const Scenario scenario = load_scenario(write("mine.json", R"({"extends": "poke_plane"})")).scenario;
  EXPECT_TRUE(std::holds_alternative<Plane>(scenario.environment));
}

TEST_F(Extends, RelativePathsStartFromTheFileThatHasThem) {
  write("there/data/cube.obj", test::read_file(test::data_directory() / "cube.obj"));
  write("there/base.json", R"({"time": {"step_s": 0.0005, "steps": 20},
    "environment": {"type": "mesh", "file": "data/cube.obj", "scale": 0.001}})");
  write("between/middle.json", R"({"extends": "../there/base.json", "seed": 2})");
  const LoadedScenario loaded = load_scenario(write("mine.json", R"({"extends": "between/middle.json", "seed": 3})"));
  EXPECT_EQ(loaded.scenario.seed, 3);
  EXPECT_EQ(check_named_files(loaded), std::vector<std::string>{});
  // The effective scenario names it from where it stands, and extends nothing.
  const Json effective = effective_scenario(loaded.scenario, directory_.path());
  EXPECT_EQ(effective["environment"]["file"], "there/data/cube.obj");
  EXPECT_FALSE(effective.contains("extends"));
}

TEST_F(Extends, ErrorsNameTheFileThatTheValueComesFrom) {
  const fs::path base = write("base.json", R"({"time": {"step_s": 0.0005, "steps": 20},
    "environment": {"type": "plane", "size_m": -1}, "rendering": {"mass_kg": 0.1}})");
  const fs::path mine = write("mine.json", R"({"extends": "base.json", "rendering": {"stiffness_N_per_m": 5}})");
  EXPECT_TRUE(refusal(mine).starts_with(base.string() + ": /environment/size_m: got -1")) << refusal(mine);
  // What --set puts there is the business of the file that was given.
  EXPECT_TRUE(refusal(mine, {"environment.size_m=-2"}).starts_with(mine.string() + ": /environment/size_m: got -2"));
}

TEST_F(Extends, ErrorsAboutNamedFilesNameTheFileThatNamesThem) {
  const fs::path base = write("base.json", R"({"time": {"step_s": 0.0005, "steps": 20},
    "environment": {"type": "mesh", "file": "none.obj", "scale": 0.001}})");
  const fs::path mine = write("mine.json", R"({"extends": "base.json"})");
  EXPECT_TRUE(refusal(mine).starts_with(base.string() + ": /environment/file: ")) << refusal(mine);
  EXPECT_TRUE(refusal(mine, {"environment.file=other.obj"}).starts_with(mine.string() + ": /environment/file: "));
}

TEST_F(Extends, RefusesCirclesAndWhatItCannotExtend) {
  const fs::path a = write("a.json", R"({"extends": "sub/b.json"})");
  const fs::path b = write("sub/b.json", R"({"extends": "../a.json"})");
  EXPECT_TRUE(refusal(a).starts_with(b.string() + ": /extends: got a circle, " + a.string() + " -> " + b.string()))
      << refusal(a);
  const fs::path own = write("own.json", R"({"extends": "own.json"})");
  EXPECT_TRUE(refusal(own).starts_with(own.string() + ": /extends: got a circle")) << refusal(own);
  const fs::path typo = write("typo.json", R"({"extends": "poke_plan"})");
  EXPECT_NE(refusal(typo).find("nearest valid name: \"poke_plane\""), std::string::npos) << refusal(typo);
  EXPECT_TRUE(refusal(typo).starts_with(typo.string() + ": /extends: ")) << refusal(typo);
  const fs::path number = write("number.json", R"({"extends": 5})");
  EXPECT_TRUE(refusal(number).starts_with(number.string() + ": /extends: got 5; allowed: ")) << refusal(number);
  const fs::path list = write("list.json", "[1]");
  EXPECT_TRUE(refusal(write("of_list.json", R"({"extends": "list.json"})")).starts_with(list.string() + ": got [1]"));
}

TEST_F(Extends, AcceptsItselfInNoJsonInMemory) {
  Json json = Json::parse(kBase);
  json["extends"] = "poke_plane";
  const auto error = test::input_error_of([&] { read_scenario(json, ""); });
  ASSERT_TRUE(error);
  EXPECT_EQ(error->place(), "/extends");
}

}  // namespace
}  // namespace hapbench::extends_test
