#include <gtest/gtest.h>

#include "scenarios/input/motion_file.hpp"
#include "sim/core/random.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/import/recordings.hpp"
#include "tests/scenarios/support/mutation.hpp"
#include "tests/support/scale.hpp"

/// Whatever the bytes of a recording have become, they are read or refused.
namespace hapbench::import_fuzz_test {
namespace {

using test::hapi;
using test::hapi_binary;
using test::imported;
using test::kHapiSamples;
using test::kScenarios;

void expect_read_or_refused(const std::string& bytes, const ImportOptions& options) {
  try {
    const auto [stroke, report] = imported(bytes, options);
    for (std::size_t i = 0; i < stroke.size(); ++i) {
      ASSERT_TRUE(i == 0 || stroke.time[i - 1] < stroke.time[i]);
      ASSERT_NEAR(stroke.turn[i].norm(), 1.0, 1e-12);
      ASSERT_TRUE(stroke.position[i].allFinite());
    }
  } catch (const InputError& error) {
    const std::string message = error.what();
    EXPECT_EQ(message.find_first_of(std::string("\n\r\0\x1b", 4)), std::string::npos) << message;
    EXPECT_LT(message.size(), 3000u);
  }
}

TEST(ImportFuzz, LogsAreReadOrRefused) {
  const std::string text = test::read_file(kScenarios / "examples/data/wipe.hapi.txt").substr(0, 2000);
  const std::string binary = hapi_binary<double>({"TIME", "POSITION", "ORIENTATION", "FORCE"}, kHapiSamples);
  Random random(4);
  for (std::size_t i = 0; i < test::cases(4000) && !testing::Test::HasFailure(); ++i) {
    ImportOptions options = hapi();
    options.skip_bad_rows = i % 2 == 0;
    options.longest_gap = 1e9;
    if (i % 3 == 0) options.smoothing = Smoothing{3, 1};
    expect_read_or_refused(test::mutated_text(text, random), options);
    set_format(options, "hapi-binary");
    options.floats = i % 5 == 0;
    expect_read_or_refused(test::mutated_text(binary, random), options);
    expect_read_or_refused(binary.substr(0, random.below(binary.size())), options);
    std::string garbage;
    for (std::uint64_t n = random.below(300); n > 0; --n) garbage += static_cast<char>(random.below(256));
    for (const char* format : {"csv", "traj", "hapi", "hapi-binary"}) {
      set_format(options, format);
      expect_read_or_refused(garbage, options);
    }
  }
}

TEST(ImportFuzz, StrokesWithForcesAreReadOrRefused) {
  const std::string text = test::read_file(kScenarios / "examples/data/wipe.csv").substr(0, 3000);
  Random random(5);
  std::size_t accepted = 0;
  for (std::size_t i = 0; i < test::cases(4000) && !testing::Test::HasFailure(); ++i) {
    const std::string mutant = test::mutated_text(text.substr(0, text.rfind('\n') + 1), random);
    try {
      if (const auto force = stroke_in(mutant, "stroke.csv").force) {
        EXPECT_TRUE(!force->at(0.01) || force->at(0.01)->allFinite());
        ++accepted;
      }
    } catch (const InputError& error) {
      EXPECT_LT(std::string(error.what()).size(), 3000u);
    }
  }
  EXPECT_GT(accepted, test::cases(4000) / 50);
}

}  // namespace
}  // namespace hapbench::import_fuzz_test
