#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/scenarios/import/recordings.hpp"

/// Logs as HAPI writes them, and the presets that come with the program.
namespace hapbench::import_hapi_test {
namespace {

using test::hapi;
using test::hapi_binary;
using test::imported;
using test::kHapiSamples;
using test::kScenarios;
using test::refusal;

TEST(ImportHapi, TextAndBinaryAreTheSameStroke) {
  const std::vector<const char*> names = {"TIME", "POSITION", "ORIENTATION", "FORCE"};
  std::string text = "TIME POSITION ORIENTATION FORCE\n";
  for (const auto& sample : kHapiSamples) {
    for (const double value : sample) text += fmt::format("{} ", value);
    text += "\r\n";
  }
  ImportOptions options = hapi();
  const StrokeSamples expected = imported(text, options).samples;
  ASSERT_EQ(expected.size(), 2u);
  EXPECT_NEAR((expected.position[1] - Vec3(0.001, -0.004, 0.002)).norm(), 0.0, 1e-15);
  EXPECT_EQ(expected.force[1], Vec3(1, -4, 2));
  EXPECT_TRUE(expected.has_roll);
  set_format(options, "hapi-binary");
  EXPECT_EQ(stroke_text(imported(hapi_binary<double>(names, kHapiSamples), options).samples), stroke_text(expected));
  options.floats = true;
  const auto floats = imported(hapi_binary<float>(names, kHapiSamples), options).samples;
  EXPECT_NEAR((floats.position[1] - expected.position[1]).norm(), 0.0, 1e-9);
}

TEST(ImportHapi, ButtonsAreFourBytes) {
  ImportOptions options = hapi();
  set_format(options, "hapi-binary");
  std::string bytes = hapi_binary<double>({"BUTTONS", "TIME", "POSITION"}, {});
  for (const double t : {1.0, 1.25}) {
    const std::int32_t button = 3;
    bytes.append(reinterpret_cast<const char*>(&button), sizeof button);
    bytes += hapi_binary<double>({}, {{t, 0.001 * t, 0.002, 0.003}}).substr(1);
  }
  const auto [stroke, report] = imported(bytes, options);
  EXPECT_EQ(stroke.time[1], 0.25);
  EXPECT_TRUE(stroke.force.empty());
  EXPECT_FALSE(stroke.has_roll);
  EXPECT_EQ(report.warnings.size(), 2u) << "neither orientation nor force";
}

TEST(ImportHapi, ACutOffLogLosesItsLastSampleWithAWord) {
  ImportOptions options = hapi();
  set_format(options, "hapi-binary");
  std::string bytes = hapi_binary<double>({"TIME", "POSITION"}, {{0, 0, 0, 0}, {1, 0, 0, 0}, {2, 0, 0, 0}});
  bytes.resize(bytes.size() - 3);
  options.longest_gap = 2.0;
  const auto [stroke, report] = imported(bytes, options);
  EXPECT_EQ(stroke.size(), 2u);
  ASSERT_FALSE(report.warnings.empty());
  EXPECT_NE(report.warnings[2].find("behind sample 2 are 29 bytes"), std::string::npos) << report.warnings[2];
}

TEST(ImportHapi, RefusesWhatIsNoLog) {
  ImportOptions options = hapi();
  EXPECT_EQ(refusal("TIME POSITON\n0 0 0 0\n", options).find("rec.csv, line 1: unknown field \"POSITON\""), 0u);
  EXPECT_EQ(refusal("TIME TIME\n0 0\n", options), "rec.csv, line 1: field \"TIME\" twice; allowed: once");
  set_format(options, "hapi-binary");
  EXPECT_NE(
      refusal("TIME POSITION\n0 0 0 0\n0 0 0 0\n0 0 0 0\n0 0 0 0\n0 0 0 0\n0 0 0 0\n", options).find("--format hapi"),
      std::string::npos);
  EXPECT_NE(refusal(std::string(1, '\0'), options).find("no field names"), std::string::npos);
}

TEST(ImportPreset, AllThatComeWithTheProgramAreRead) {
  std::size_t presets = 0;
  for (const auto& entry : std::filesystem::directory_iterator(kScenarios / "import/presets")) {
    ImportOptions options;
    apply_preset(options, entry.path().string());
    EXPECT_TRUE(options.columns.contains("position")) << entry.path();
    ++presets;
  }
  EXPECT_GE(presets, 4u);
}

TEST(ImportPreset, OfTwoNamesTheOneInTheFileCounts) {
  ImportOptions options;
  apply_preset(options, (kScenarios / "import/presets/falcon_traces.json").string());
  const auto stroke = imported("h_pos_x,h_pos_y,h_pos_z\n0,0,0\n0.001,0,0\n", options).samples;
  EXPECT_EQ(stroke.time[1], 0.001);
}

}  // namespace
}  // namespace hapbench::import_hapi_test
