#include <gtest/gtest.h>

#include "scenarios/plugins/load_plugin.hpp"
#include "tests/scenarios/studies/precision/results.hpp"

namespace hapbench::contact_sources_test {
namespace {

using test::bundled, test::quick, test::value;

TEST(PrecisionContactSources, MeasureEachThatIsBuiltAgainstOurs) {
  const PrecisionResult result = kContactSourcesStudy.run(
      bundled("rotate_in_hole", {"time.duration_s=0.05", "environment.grid_m=0.0002"}), quick());
  ASSERT_EQ(result.rows.size(), 1 + kPeers.size());
  EXPECT_EQ(result.rows[0].setting, "own");
  EXPECT_EQ(value(result, 0, "spring_force_error_rms_N"), 0.0);
  EXPECT_EQ(value(result, 0, "way_apart_rms_m"), 0.0);
  EXPECT_GT(value(result, 0, "contacts_mean"), 0.0);
  for (std::size_t i = 0; i < kPeers.size(); ++i) {
    const PrecisionRow& row = result.rows[1 + i];
    EXPECT_EQ(row.setting, kPeers[i]);
    ASSERT_EQ(row.values.size(), result.columns.size());
    if (find_peer(kPeers[i]) == nullptr) {
      EXPECT_EQ(row.outcome, "not built");
      continue;
    }
    EXPECT_EQ(row.outcome, "completes");
    // A triangle for each vertex or more, and other depths.
    EXPECT_GT(value(result, 1 + i, "contacts_mean"), value(result, 0, "contacts_mean"));
    EXPECT_GT(value(result, 1 + i, "spring_force_error_rms_N"), 0.0);
    EXPECT_GT(value(result, 1 + i, "way_apart_rms_m"), 0.0);
    EXPECT_LT(value(result, 1 + i, "way_apart_rms_m"), 1e-3);
  }
}

}  // namespace
}  // namespace hapbench::contact_sources_test
