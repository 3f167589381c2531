#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

#include "algorithms/registry.hpp"
#include "algorithms/penalty_rendering.hpp"

/// In a program of its own: what is added stays.
namespace hapbench::added_algorithm_test {
namespace {

std::unique_ptr<ForceAlgorithm> make_some(const RenderingConfig& config) {
  return std::make_unique<PenaltyRendering>(make_law("mean", config), config);
}

/// What is wrong with an algorithm, or an empty text; it has then been added.
std::string problem_with(const ModelInfo& info, std::vector<OwnParameter> parameters = {}) {
  try {
    add_algorithm({.info = &info, .make = make_some, .own_parameters = parameters});
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(AddedAlgorithm, IsFoundAndCanBeReplaced) {
  const std::size_t before = algorithms().size(), additions_before = additions();
  const AlgorithmEntry& mean = *find_algorithm("mean");
  {
    // Texts of its own, which need not stay.
    std::string name = "added", text = "text", parameter = "gain";
    const OwnParameter own[] = {{parameter.c_str(), {0, 2, "1"}, 0.5, text.c_str()}};
    const ModelInfo info{name.c_str(), text.c_str(), text.c_str(), text.c_str(), text.c_str()};
    add_algorithm({.info = &info, .make = make_some, .own_parameters = own});
    name = text = parameter = "other";
  }
  ASSERT_EQ(algorithms().size(), before + 1);
  EXPECT_EQ(algorithm_names().back(), "added");
  EXPECT_EQ(&mean, find_algorithm("mean"));
  const AlgorithmEntry& added = *find_algorithm("added");
  EXPECT_STREQ(added.info->summary, "text");
  RenderingConfig config;
  config.algorithm = "added";
  EXPECT_NE(make_algorithm(config), nullptr);
  EXPECT_EQ(own_values(config, added), std::vector<double>{0.5});
  config.parameters["added"]["gain"] = 2.0;
  EXPECT_EQ(own_values(config, added), std::vector<double>{2.0});

  EXPECT_EQ(problem_with({"added", "again", "a", "b", "c"}), "");
  EXPECT_EQ(algorithms().size(), before + 1);
  EXPECT_EQ(&added, find_algorithm("added"));
  EXPECT_STREQ(added.info->summary, "again");
  EXPECT_EQ(additions(), additions_before + 2);
}

TEST(AddedAlgorithm, IsRefusedWithTheReason) {
  const std::size_t before = algorithms().size();
  const auto named = [](const char* name) { return problem_with({name, "a", "b", "c", "d"}); };
  EXPECT_EQ(named("mean"), "\"mean\" is the name of a built-in algorithm");
  EXPECT_EQ(named("all"), "an algorithm is called \"all\", which means all of them");
  for (const char* name : {"", "a.b", "A", "1st", "with blank", "a,b", "a=b"})
    EXPECT_TRUE(named(name).starts_with("an algorithm is called \"" + std::string(name) + "\"; allowed: letters"));
  EXPECT_TRUE(named(nullptr).starts_with("an algorithm is called \"\""));
  EXPECT_EQ(problem_with({"x", nullptr, "b", "c", "d"}), "its summary is missing");
  EXPECT_EQ(problem_with({"x", "a", "", "c", "d"}), "its formula is missing");
  EXPECT_EQ(problem_with({"x", "a", "b", nullptr, "d"}), "its source is missing");
  EXPECT_EQ(problem_with({"x", "a", "b", "c", nullptr}), "its known failure is missing");

  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const auto with = [](std::vector<OwnParameter> own) {
    return problem_with({"x", "a", "b", "c", "d"}, std::move(own));
  };
  const OwnParameter good{"p", {0, 1, "1"}, 0.5, "meaning"};
  EXPECT_EQ(with({good, good}), "parameter \"p\" is there twice");
  EXPECT_TRUE(with({{"a b", good.range, 0.5, "m"}}).starts_with("a parameter is called \"a b\"; allowed"));
  EXPECT_EQ(with({{"p", good.range, 1.5, "m"}}), "parameter \"p\": its default is out of its range");
  EXPECT_EQ(with({{"p", {0, 1, "1", true}, 0.0, "m"}}), "parameter \"p\": its default is out of its range");
  EXPECT_EQ(with({{"p", good.range, std::numeric_limits<double>::quiet_NaN(), "m"}}),
            "parameter \"p\": its default is out of its range");
  for (const NumberRange range : {NumberRange{1, 0, "1"}, {1, 1, "1"}, {0, kInfinity, "1"}})
    EXPECT_EQ(with({{"p", range, 0.5, "m"}}), "parameter \"p\": a range needs two finite ends, the lower first");
  EXPECT_EQ(with({{"p", {0, 1, nullptr}, 0.5, "m"}}), "parameter \"p\": its unit is missing");
  EXPECT_EQ(with({{"p", good.range, 0.5, nullptr}}), "parameter \"p\": its meaning is missing");
  EXPECT_EQ(algorithms().size(), before);
}

}  // namespace
}  // namespace hapbench::added_algorithm_test
