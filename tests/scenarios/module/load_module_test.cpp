#include "scenarios/run/load_module.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "algorithms/registry.hpp"
#include "scenarios/format/input_error.hpp"
#include "scenarios/format/load_scenario.hpp"
#include "scenarios/format/writer.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/environment_variable.hpp"
#include "tests/scenarios/support/errors.hpp"

namespace hapbench::load_module_test {
namespace {

namespace fs = std::filesystem;

fs::path module(const std::string& name) {
  return fs::path(HAPBENCH_TEST_MODULES) / (name + ".so");
}

/// Behind the file's name.
std::string problem_with(const fs::path& file) {
  const auto error = test::input_error_of([&] { load_law(file); });
  if (!error) return "";
  const std::string what = error->what(), start = file.string() + ": ";
  EXPECT_TRUE(what.starts_with(start)) << what;
  EXPECT_EQ(what.find('\n'), what.npos);
  return what.substr(start.size());
}

TEST(LoadModule, SaysWhatIsWrongWithAFile) {
  const std::size_t before = algorithms().size();
  EXPECT_EQ(problem_with("no/such.so"), "cannot be loaded as a law: No such file or directory");
  EXPECT_EQ(problem_with(fs::canonical(HAPBENCH_TEST_MODULES)), "is a directory, not a file");
  const test::TemporaryDirectory directory;
  std::ofstream(directory / "text.so") << "no library";
  EXPECT_EQ(problem_with(fs::canonical(directory / "text.so")), "is not a module: file too short");
  EXPECT_EQ(problem_with(module("no_entry_point")),
            "is not a module: it has no function \"hapbench_module\" (hapbench_module.h)");
  for (const char* old : {"law", "contacts"}) {
    const std::string header = old == std::string("law") ? "hapbench_plugin.h" : "hapbench_contacts.h";
    EXPECT_EQ(problem_with(module(std::string("old_") + old)),
              "is built for " + header + " of an earlier version; compile it anew against hapbench_module.h");
  }
  EXPECT_EQ(problem_with(module("sphere")),
            "holds a source of contacts, not a law; name it in rendering.contact_source of a scenario");
  EXPECT_EQ(algorithms().size(), before);
}

TEST(LoadModule, SaysWhatIsWrongWithALaw) {
  const std::size_t before = algorithms().size();
  const test::TemporaryDirectory directory;
  const fs::path file = fs::canonical(directory.path()) / "not_loaded_yet.so";
  fs::copy_file(module("hostile"), file);
  const auto hostile = [&file](const char* how) {
    const test::EnvironmentVariable chosen("HOSTILE", how);
    return problem_with(file);
  };
  EXPECT_EQ(hostile("refuses"),
            "does not support version 1 of the interface; allowed: built with the hapbench_module.h of this program");
  EXPECT_EQ(hostile("version"), "is built for version 2 of the interface; allowed: 1");
  EXPECT_EQ(hostile("kind"), "its kind is 5; allowed: HAPBENCH_LAW or HAPBENCH_CONTACTS");
  const std::string unusable = "is not a law that can be used: ";
  EXPECT_EQ(hostile("built in"), unusable + "\"mean\" is the name of a built-in algorithm");
  EXPECT_EQ(hostile("no table"), unusable + "its table of parameters is missing");
  EXPECT_EQ(hostile("no step"), unusable + "its function \"step\" is missing");
  EXPECT_EQ(hostile("many"), unusable + "it has 1099511627776 parameters; allowed: at most 1000");
  EXPECT_EQ(algorithms().size(), before);
}

TEST(LoadModule, LoadsAFileOnceAndALawOnce) {
  load_law(module("hostile"));
  const std::size_t after = algorithms().size();
  load_law(module("hostile"));
  EXPECT_EQ(algorithms().size(), after);
  EXPECT_EQ(find_algorithm("hostile")->origin.file, "hostile.so");
  EXPECT_EQ(find_algorithm("hostile")->origin.hash.size(), 16u);
  const test::TemporaryDirectory directory;
  const fs::path copy = fs::canonical(directory.path()) / "copy.so";
  fs::copy_file(module("hostile"), copy);
  EXPECT_EQ(problem_with(copy), "is not a law that can be used: \"hostile\" is the name of the law in " +
                                    fs::canonical(module("hostile")).string());
}

TEST(LoadModule, LeavesTheArithmeticAlone) {
  load_law(module("hostile"));
  volatile double least = std::numeric_limits<double>::min();
  EXPECT_GT(least / 2.0, 0.0);
}

TEST(LoadModule, LoadsFoldersInTheOrderOfNames) {
  const test::TemporaryDirectory directory;
  fs::copy_file(module("depth_weighted"), directory / "b.so");
  fs::copy_file(module("capped_summation"), directory / "a.so");
  std::ofstream(directory / "readme.txt") << "no module";
  load_laws_in("PATH", ":" + directory.path().string() + ":");
  ASSERT_GE(algorithm_names().size(), 2u);
  EXPECT_EQ(algorithm_names().back(), "depth_weighted");
  EXPECT_EQ(algorithm_names()[algorithm_names().size() - 2], "capped_summation");
  const auto error = test::input_error_of([] { load_laws_in("PATH", "/no/such/folder"); });
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

TEST(OwnParameters, AreWrittenWithTheirAlgorithmCheckedAndInTheSchema) {
  load_law(module("hostile"));
  const auto rendering_of = [](const std::string& text) {
    return effective_scenario(scenario_with(text).scenario, "")["rendering"];
  };
  EXPECT_FALSE(rendering_of(R"({"algorithm": "mean"})").contains("parameters"));
  const std::string given = R"({"algorithm": "hostile", "parameters": {"hostile": {"bias": 0.5}}})";
  EXPECT_EQ(rendering_of(given)["parameters"], Json::parse(R"({"hostile": {"gain": 1.0, "bias": 0.5}})"));
  // Another algorithm's, if given: a comparison changes the algorithm.
  const std::string others = R"({"algorithm": "mean", "parameters": {"hostile": {"bias": 0.5}}})";
  EXPECT_EQ(rendering_of(others)["parameters"]["hostile"]["bias"], 0.5);
  const Scenario scenario = with_algorithm(scenario_with(others).scenario, "hostile");
  EXPECT_EQ(own_values(scenario.rendering, *find_algorithm("hostile")), (std::vector<double>{1.0, 0.5}));

  const auto refusal = [](const std::string& parameters) {
    const auto error = test::input_error_of([&] { scenario_with(R"({"parameters": )" + parameters + "}"); });
    return error ? std::string(error->what()) : "";
  };
  EXPECT_EQ(refusal(R"({"hostile": {"gain": 3}})"),
            "/rendering/parameters/hostile/gain: got 3; allowed: a number >= 0 and <= 2 [1]");
  EXPECT_EQ(refusal(R"({"hostile": {"gian": 1}})"),
            "/rendering/parameters/hostile/gian: unknown field; nearest valid name: \"gain\"; allowed here: "
            "\"gain\", \"bias\"");
  const std::string unknown = refusal(R"({"hostil": {"gain": 1}})");
  EXPECT_NE(unknown.find("nearest valid name: \"hostile\""), std::string::npos) << unknown;

  const Json schema = scenario_guide().schema;
  const Json& gain =
      schema.at(Json::json_pointer("/properties/rendering/properties/parameters/properties/hostile/properties/gain"));
  EXPECT_EQ(gain["default"], 1.0);
  EXPECT_EQ(gain["maximum"], 2.0);
  EXPECT_EQ(gain["description"], "scales nothing");
}

}  // namespace
}  // namespace hapbench::load_module_test
