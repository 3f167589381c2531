#pragma once

#include <span>
#include <vector>

#include "sim/contact/contact_buffer.hpp"
#include "sim/core/random.hpp"

/// Contacts without a scene: gradients and depths, as force laws receive them.
namespace hapbench::test {

/// Returns the contacts as a padded buffer, in the given order. Point i lies at the origin and has the normal
/// -u_i, where u_i is gradient i. Contacts without a given depth have the depth 1 mm.
ContactBuffer contacts_of(const std::vector<Vec3>& gradients, const std::vector<double>& depths = {});

/// Returns n depths [m], uniform in (0, 1 mm].
std::vector<double> random_depths(Random& random, std::size_t n);

/// Returns a size that is log-uniform in 1 … largest. Small sets have few alternative solutions; large sets
/// have large rounding errors.
std::size_t random_size(Random& random, std::size_t largest);

/// Returns a uniformly distributed rotation.
Mat3 random_rotation(Random& random);

/// A difficult distribution of random unit gradients for tests of force laws; `draw` returns n gradients.
struct GradientDistribution {
  const char* name;
  bool planar;  ///< true if every gradient lies in the plane z = 0
  std::vector<Vec3> (*draw)(Random& random, std::size_t n);
};

/// Returns the distributions: random, parallel, opposite, nearly parallel (angles down to 1e-12), duplicated,
/// planar, coplanar, axis-aligned and clustered gradients, and gradients for which contacts of exact_shaping are on the
/// boundary between active and inactive.
std::span<const GradientDistribution> gradient_distributions();

/// Calls f(contacts, name of the distribution) for random sets of all gradient_distributions(), with at most 300
/// contacts each. Every call uses the same sets.
template <class F>
void for_random_contacts(F f) {
  Random random(1);
  for (const auto& family : gradient_distributions()) {
    for (int i = 0; i < 10; ++i) {
      const auto gradients = family.draw(random, random_size(random, 300));
      f(contacts_of(gradients, random_depths(random, gradients.size())), family.name);
    }
  }
}

}  // namespace hapbench::test
