#include "scenarios/plugins/load_plugin.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "algorithms/registry.hpp"
#include "scenarios/description/load_scenario.hpp"
#include "scenarios/description/writer.hpp"
#include "scenarios/input/input_error.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/environment_variable.hpp"
#include "tests/scenarios/support/errors.hpp"

namespace hapbench::load_plugin_test {
namespace {

namespace fs = std::filesystem;

fs::path plugin(const std::string& name) {
  return fs::path(HAPBENCH_TEST_PLUGINS) / (name + ".so");
}

/// Behind the file's name.
std::string problem_with(const fs::path& file) {
  const auto error = test::input_error_of([&] { load_plugin(file); });
  if (!error) return "";
  const std::string what = error->what(), start = file.string() + ": ";
  EXPECT_TRUE(what.starts_with(start)) << what;
  EXPECT_EQ(what.find('\n'), what.npos);
  return what.substr(start.size());
}

TEST(LoadPlugin, SaysWhatIsWrongWithAFile) {
  const std::size_t before = algorithms().size();
  EXPECT_EQ(problem_with("no/such.so"), "cannot be loaded as a plugin: No such file or directory");
  EXPECT_EQ(problem_with(fs::canonical(HAPBENCH_TEST_PLUGINS)), "is a directory, not a file");
  const test::TemporaryDirectory directory;
  std::ofstream(directory / "text.so") << "no library";
  EXPECT_EQ(problem_with(fs::canonical(directory / "text.so")), "is no plugin: file too short");
  EXPECT_EQ(problem_with(plugin("no_entry_point")),
            "is no plugin: it has no function \"hapbench_plugin\" (hapbench_plugin.h)");
  EXPECT_EQ(algorithms().size(), before);
}

TEST(LoadPlugin, SaysWhatIsWrongWithAPlugin) {
  const std::size_t before = algorithms().size();
  const test::TemporaryDirectory directory;
  const fs::path file = fs::canonical(directory.path()) / "not_loaded_yet.so";
  fs::copy_file(plugin("hostile"), file);
  const auto hostile = [&file](const char* how) {
    const test::EnvironmentVariable chosen("HOSTILE", how);
    return problem_with(file);
  };
  EXPECT_EQ(hostile("refuses"),
            "does not support version 1 of the interface; allowed: built with the hapbench_plugin.h of this program");
  EXPECT_EQ(hostile("version"), "is built for version 2 of the interface; allowed: 1");
  const std::string unusable = "is no plugin that can be used: ";
  EXPECT_EQ(hostile("built in"), unusable + "\"mean\" is the name of a built-in algorithm");
  EXPECT_TRUE(hostile("no name").starts_with(unusable + "an algorithm is called \"\"; allowed: letters"));
  EXPECT_EQ(hostile("no failure"), unusable + "its known failure is missing");
  EXPECT_EQ(hostile("no table"), unusable + "its table of parameters is missing");
  EXPECT_EQ(hostile("no create"), unusable + "its function \"create\" is missing");
  EXPECT_EQ(hostile("no evaluate"), unusable + "its function \"evaluate\" is missing");
  EXPECT_EQ(hostile("gives"), unusable + "\"gives\" is 5; allowed: HAPBENCH_WEIGHTS or HAPBENCH_FORCE");
  EXPECT_EQ(hostile("many"), unusable + "it has 1099511627776 parameters; allowed: at most 1000");
  const std::string unprintable = " has characters that cannot be printed: ";
  EXPECT_EQ(hostile("escape"), unusable + "its summary" + unprintable + "\"red: \\u001b[31m\"");
  EXPECT_EQ(hostile("csi"), unusable + "its source" + unprintable + "\"\\u009b31m\"");
  EXPECT_EQ(hostile("latin"), unusable + "the meaning of parameter \"gain\"" + unprintable + "\"caf\\ufffd\"");
  EXPECT_EQ(algorithms().size(), before);
}

TEST(LoadPlugin, LoadsAFileOnceAndALawOnce) {
  load_plugin(plugin("hostile"));
  const std::size_t after = algorithms().size();
  load_plugin(plugin("hostile"));
  EXPECT_EQ(algorithms().size(), after);
  EXPECT_EQ(find_algorithm("hostile")->origin.file, "hostile.so");
  EXPECT_EQ(find_algorithm("hostile")->origin.hash.size(), 16u);
  const test::TemporaryDirectory directory;
  const fs::path copy = fs::canonical(directory.path()) / "copy.so";
  fs::copy_file(plugin("hostile"), copy);
  EXPECT_EQ(problem_with(copy), "is no plugin that can be used: \"hostile\" is the name of the law in " +
                                    fs::canonical(plugin("hostile")).string());
}

TEST(LoadPlugin, LeavesTheArithmeticAlone) {
  load_plugin(plugin("hostile"));
  volatile double least = std::numeric_limits<double>::min();
  EXPECT_GT(least / 2.0, 0.0);
}

TEST(LoadPlugin, LoadsFoldersInTheOrderOfNames) {
  const test::TemporaryDirectory directory;
  fs::copy_file(plugin("depth_weighted"), directory / "b.so");
  fs::copy_file(plugin("capped_summation"), directory / "a.so");
  std::ofstream(directory / "readme.txt") << "no plugin";
  load_plugins_in("PATH", ":" + directory.path().string() + ":");
  ASSERT_GE(algorithm_names().size(), 2u);
  EXPECT_EQ(algorithm_names().back(), "depth_weighted");
  EXPECT_EQ(algorithm_names()[algorithm_names().size() - 2], "capped_summation");
  const auto error = test::input_error_of([] { load_plugins_in("PATH", "/no/such/folder"); });
  ASSERT_TRUE(error);
  EXPECT_STREQ(error->what(), "PATH: /no/such/folder: No such file or directory");
}

// ---- Parameters in scenarios.

LoadedScenario scenario_with(const std::string& rendering) {
  return read_scenario(
      Json::parse(R"({"time": {"step_s": 0.001, "steps": 10}, "environment": {"type": "plane"}, "rendering": )" +
                  rendering + "}"),
      "");
}

class OwnParameters : public testing::Test {
 protected:
  static void SetUpTestSuite() { load_plugin(plugin("hostile")); }
  static Json rendering_of(const std::string& text) {
    return effective_scenario(scenario_with(text).scenario, "")["rendering"];
  }
  static std::string refusal(const std::string& text) {
    const auto error = test::input_error_of([&] { scenario_with(text); });
    return error ? error->what() : "";
  }
};

TEST_F(OwnParameters, AreWrittenWithTheirAlgorithmAlone) {
  EXPECT_FALSE(rendering_of(R"({"algorithm": "mean"})").contains("parameters"));
  EXPECT_EQ(rendering_of(R"({"algorithm": "hostile"})")["parameters"],
            Json::parse(R"({"hostile": {"gain": 1.0, "bias": 0.0}})"));
  const std::string given = R"({"algorithm": "hostile", "parameters": {"hostile": {"bias": 0.5}}})";
  EXPECT_EQ(rendering_of(given)["parameters"], Json::parse(R"({"hostile": {"gain": 1.0, "bias": 0.5}})"));
  // Another algorithm's, if given: a comparison changes the algorithm.
  const std::string others = R"({"algorithm": "mean", "parameters": {"hostile": {"bias": 0.5}}})";
  EXPECT_EQ(rendering_of(others)["parameters"]["hostile"]["bias"], 0.5);
  const Scenario scenario = with_algorithm(scenario_with(others).scenario, "hostile");
  EXPECT_EQ(own_values(scenario.rendering, *find_algorithm("hostile")), (std::vector<double>{1.0, 0.5}));
}

TEST_F(OwnParameters, AreCheckedWithPointerRangeAndNearestName) {
  EXPECT_EQ(refusal(R"({"parameters": {"hostile": {"gain": 3}}})"),
            "/rendering/parameters/hostile/gain: got 3; allowed: a number >= 0 and <= 2 [1]");
  EXPECT_EQ(refusal(R"({"parameters": {"hostile": {"gian": 1}}})"),
            "/rendering/parameters/hostile/gian: unknown field; allowed here: \"gain\", \"bias\"; nearest valid name: "
            "\"gain\"");
  const std::string unknown = refusal(R"({"parameters": {"hostil": {"gain": 1}}})");
  EXPECT_TRUE(unknown.starts_with("/rendering/parameters/hostil: unknown field; allowed here: ")) << unknown;
  EXPECT_TRUE(unknown.ends_with("nearest valid name: \"hostile\"")) << unknown;
}

TEST_F(OwnParameters, AreInTheSchema) {
  const Json schema = scenario_guide().schema;
  const Json& gain =
      schema.at(Json::json_pointer("/properties/rendering/properties/parameters/properties/hostile/properties/gain"));
  EXPECT_EQ(gain["default"], 1.0);
  EXPECT_EQ(gain["maximum"], 2.0);
  EXPECT_EQ(gain["description"], "scales nothing");
}

}  // namespace
}  // namespace hapbench::load_plugin_test
