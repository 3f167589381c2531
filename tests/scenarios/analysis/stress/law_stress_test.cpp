#include "scenarios/analysis/stress/law_stress.hpp"

#include <gtest/gtest.h>

#include <map>

#include "algorithms/registry.hpp"
#include "scenarios/analysis/stress/stress_set.hpp"
#include "sim/contact/contact_query.hpp"
#include "sim/contact/contact_source.hpp"
#include "tests/support/scale.hpp"

namespace hapbench::law_stress_test {
namespace {

TEST(LawStress, NoForceIsInfiniteOrOutOfBound) {
  // scripts/reproduce tests 200 000 sets, and scripts/test --all tests a million sets.
  const std::uint64_t count = test::cases(50'000);
  const auto all = stress_laws(count, 1, {2, ""});
  ASSERT_EQ(all.size(), algorithms().size());
  for (const StressCounts& c : all) {
    EXPECT_EQ(c.sets, count) << c.algorithm;
    EXPECT_GT(c.in_contact, count * 9 / 10) << c.algorithm;
    EXPECT_EQ(c.non_finite, 0u) << c.algorithm << ", first in set " << c.first_bad.value_or(0);
    EXPECT_EQ(c.out_of_bound, 0u) << c.algorithm << ", first in set " << c.first_bad.value_or(0);
    // Some sets have more contacts than the reduction keeps. So contacts are dropped for the algorithms that may use
    // the reduction, and only for these.
    EXPECT_EQ(c.points_dropped > 0, find_algorithm(c.algorithm)->may_reduce) << c.algorithm;
    EXPECT_EQ(c.largest_share.has_value(), find_algorithm(c.algorithm)->force_bound != nullptr) << c.algorithm;
  }
}

TEST(LawStress, ReachesTheBoundsThatCanBeReached) {
  // Parallel springs of equal depth reach the bounds of `summation`, of `mean` and of stiffness shaping.
  // virtual_coupling and least_squares reach their bounds at the singular value s of the matrix of gradients at which s
  // / (eps + s^2) is largest, with eps = 1 for virtual_coupling.
  for (const StressCounts& c : stress_laws(20'000, 2, {2, ""})) {
    if (!c.largest_share) continue;
    // The bounds of these two laws assume the worst case of rounding, which no contact set reaches.
    if (c.algorithm == "tandpasta" || c.algorithm == "original_averaging") continue;
    // The bound of the proxy is its largest possible motion in a step, which no contact set reaches.
    if (c.algorithm == "proxy") continue;
    EXPECT_GT(*c.largest_share, 0.9) << c.algorithm;
    EXPECT_LE(*c.largest_share, 1.0 + 1e-9) << c.algorithm;
  }
}

TEST(ContactSets, HoldTheDegenerateCasesOfTheirNames) {
  std::map<std::string, std::size_t> seen;
  for (std::uint64_t i = 0; i < test::cases(20'000); ++i) {
    const ContactSet set = stress_set(3, i);
    const PointShell shell(set.points, 0.0);
    const auto query = make_contact_query(shell, set.tool, Skips::off);
    ContactBuffer contacts(query->capacity());
    query->contacts_at(set.pose, contacts);
    if (contacts.empty()) continue;
    seen["one point"] += contacts.size() == 1;
    seen["tiny"] += set.tool.length() < 1e-11;
    seen["huge"] += set.tool.length() > 1e2;
    seen["overflow"] += set.rendering.reduction && set.points.size() > set.rendering.reduction->max_points;
    for (std::size_t k = 0; k < contacts.size(); ++k) {
      const Vec3 x = contacts.point(k) - set.pose.position;
      seen["zero normal"] += contacts.normal(k) == Vec3::Zero();
      seen["tip centre"] += x == Vec3::Zero();
      seen["on the axis"] += (x - x.dot(set.pose.axis) * set.pose.axis).norm() <= 1e-12 * set.tool.radius();
      seen["same point"] += k > 0 && contacts.point(k) == contacts.point(k - 1);
      seen["opposite normals"] +=
          k > 0 && contacts.normal(k) == -contacts.normal(k - 1) && contacts.normal(k) != Vec3::Zero();
    }
  }
  EXPECT_EQ(seen.size(), 9u);
  for (const auto& [what, count] : seen) EXPECT_GT(count, test::cases(100)) << what;
}

}  // namespace
}  // namespace hapbench::law_stress_test
