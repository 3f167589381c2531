// What the laws make of a shell that lists every vertex once for each of the four cells around its edge.
#include <gtest/gtest.h>

#include "algorithms/registry.hpp"
#include "tests/support/contact_sets.hpp"

namespace hapbench::multiplicity_test {
namespace {

constexpr std::size_t kCopies = 4;

struct Forces {
  LawForce once, four_times;
  double scale;      ///< K times the sum of depths, which bounds every force here but that of original_averaging [N]
  double gradients;  ///< |sum u_i| / n
};

/// Calls f(forces, family) on random sets of all families, evaluated as they are and with four copies of each contact.
template <class F>
void for_random_contacts(const char* name, F f) {
  Random random(1);
  const RenderingConfig config;
  for (const auto& family : test::gradient_families()) {
    for (int i = 0; i < 20; ++i) {
      const auto gradients = family.draw(random, test::random_size(random, 100));
      const auto depths = test::random_depths(random, gradients.size());
      std::vector<Vec3> many_gradients;
      std::vector<double> many_depths;
      Vec3 sum = Vec3::Zero();
      double depth_sum = 0.0;
      for (std::size_t k = 0; k < gradients.size(); ++k) {
        many_gradients.insert(many_gradients.end(), kCopies, gradients[k]);
        many_depths.insert(many_depths.end(), kCopies, depths[k]);
        sum += gradients[k];
        depth_sum += depths[k];
      }
      ContactBuffer once = test::contacts_of(gradients, depths);
      ContactBuffer many = test::contacts_of(many_gradients, many_depths);
      const Forces forces{make_law(name, config)->evaluate(once), make_law(name, config)->evaluate(many),
                          config.stiffness * depth_sum, sum.norm() / static_cast<double>(gradients.size())};
      f(forces, family.name);
    }
  }
}

// Sums of at most 400 products, and for shaping three iterations of them.
constexpr double kRounding = 8 * 400 * std::numeric_limits<double>::epsilon();

TEST(Multiplicity, IsNotSeenByTheMean) {
  for_random_contacts("mean", [](const Forces& forces, const char* family) {
    ASSERT_LE((forces.once.spring - forces.four_times.spring).norm(), kRounding * forces.scale) << family;
    ASSERT_LE((forces.once.S - forces.four_times.S).norm(), kRounding) << family;
  });
}

TEST(Multiplicity, IsNotSeenByShapedStiffness) {
  for_random_contacts("shaped_stiffness", [](const Forces& forces, const char* family) {
    ASSERT_LE((forces.once.spring - forces.four_times.spring).norm(), kRounding * forces.scale) << family;
    ASSERT_LE((forces.once.S - forces.four_times.S).norm(), kRounding) << family;
  });
}

TEST(Multiplicity, IsNotSeenByTheOriginalAlgorithm) {
  std::size_t compared = 0;
  for_random_contacts("original_averaging", [&compared](const Forces& forces, const char* family) {
    // Both depth and direction divide by |sum u_i|, whose rounding counts more the more the gradients cancel; where
    // they cancel to rounding, there is nothing to compare.
    if (forces.gradients < 1e-6) return;
    ++compared;
    const double cancelled = forces.gradients * forces.gradients;
    ASSERT_LE((forces.once.spring - forces.four_times.spring).norm(), kRounding * forces.scale / cancelled) << family;
    ASSERT_LE((forces.once.S - forces.four_times.S).norm(), kRounding / forces.gradients) << family;
  });
  EXPECT_GT(compared, 100u);
}

TEST(Multiplicity, StiffensTheSumFourfold) {
  for_random_contacts("summation", [](const Forces& forces, const char* family) {
    ASSERT_LE((kCopies * forces.once.spring - forces.four_times.spring).norm(), kRounding * forces.scale) << family;
  });
}

}  // namespace
}  // namespace hapbench::multiplicity_test
