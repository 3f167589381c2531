#pragma once

#include <span>
#include <vector>

#include "sim/contact/contact_buffer.hpp"
#include "sim/core/random.hpp"

/// Contacts without a scene: gradients and depths as the force laws see them.
namespace hapbench::test {

/// The contacts as a padded buffer, in the given order; point i lies at the origin with the normal -u_i. Depths beyond
/// the given ones are 1 mm.
ContactBuffer contacts_of(const std::vector<Vec3>& gradients, const std::vector<double>& depths = {});

/// n depths, uniform in (0, 1 mm].
std::vector<double> random_depths(Random& random, std::size_t n);

/// Log-uniform in 1 … largest: small sets have the fewest ways out, large ones the most rounding.
std::size_t random_size(Random& random, std::size_t largest);

/// A uniformly distributed rotation.
Mat3 random_rotation(Random& random);

/// A way to draw n unit gradients that stresses a law in one particular way.
struct GradientFamily {
  const char* name;
  bool planar;  ///< every gradient lies in the plane z = 0
  std::vector<Vec3> (*draw)(Random& random, std::size_t n);
};

/// Random, parallel, opposite, nearly parallel (angles down to 1e-12), duplicated, planar, coplanar, axis-aligned and
/// clustered gradients, and sets at the boundary of exact_shaping's cone.
std::span<const GradientFamily> gradient_families();

/// Calls f(contacts, family name) on random sets of all families, at most 300 contacts each, the same on every call.
template <class F>
void for_random_contacts(F f) {
  Random random(1);
  for (const auto& family : gradient_families()) {
    for (int i = 0; i < 10; ++i) {
      const auto gradients = family.draw(random, random_size(random, 300));
      f(contacts_of(gradients, random_depths(random, gradients.size())), family.name);
    }
  }
}

}  // namespace hapbench::test
