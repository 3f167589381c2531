#include "tests/support/contact_sets.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iterator>

namespace hapbench::test {

ContactBuffer contacts_of(const std::vector<Vec3>& gradients, const std::vector<double>& depths) {
  ContactBuffer contacts(gradients.size());
  for (std::size_t i = 0; i < gradients.size(); ++i) {
    contacts.push(static_cast<std::uint32_t>(i), Vec3::Zero(), -gradients[i]);
    contacts.set_gradient(i, gradients[i]);
    contacts.depth[i] = i < depths.size() ? depths[i] : 0.001;
  }
  contacts.pad();
  return contacts;
}

std::vector<double> random_depths(Random& random, std::size_t n) {
  std::vector<double> depths(n);
  for (double& d : depths) d = 0.001 * (1.0 - random.uniform());
  return depths;
}

std::size_t random_size(Random& random, std::size_t largest) {
  const double n = std::exp(random.uniform() * std::log(static_cast<double>(largest) + 1.0));
  return std::min(largest, static_cast<std::size_t>(n));
}

Mat3 random_rotation(Random& random) {
  // A normalised Gaussian quaternion is uniform on the sphere S^3. Its four components are two pairs of numbers, each
  // from one Box-Muller transform.
  const double a = std::sqrt(-2.0 * std::log(1.0 - random.uniform()));
  const double b = std::sqrt(-2.0 * std::log(1.0 - random.uniform()));
  const Vec3 p = random.direction_in_plane();
  const Vec3 q = random.direction_in_plane();
  return Eigen::Quaterniond(a * p.x(), a * p.y(), b * q.x(), b * q.y()).normalized().toRotationMatrix();
}

namespace {

using Gradients = std::vector<Vec3>;

/// Returns n gradients that are drawn independently.
template <class Draw>
Gradients fill(std::size_t n, Draw draw) {
  Gradients gradients(n);
  for (Vec3& u : gradients) u = draw();
  return gradients;
}

/// Returns 10^-k [rad] with k uniform in 0 … 12. Gradients at so small angles form nearly degenerate sets, which may
/// cause errors.
double small_angle(Random& random) {
  return std::pow(10.0, random.uniform(-12.0, 0.0));
}

Vec3 sign_of(Random& random, const Vec3& u) {
  return random.uniform() < 0.5 ? u : Vec3(-u);
}

/// Returns u, rotated by about `angle` [rad] about a random axis.
Vec3 tilted(Random& random, const Vec3& u, double angle) {
  return (u + angle * random.direction()).normalized();
}

Gradients uniform(Random& random, std::size_t n) {
  return fill(n, [&] { return random.direction(); });
}

Gradients planar(Random& random, std::size_t n) {
  return fill(n, [&] { return random.direction_in_plane(); });
}

Gradients parallel(Random& random, std::size_t n) {
  return Gradients(n, random.direction());
}

Gradients opposite(Random& random, std::size_t n) {
  const Vec3 u = random.direction();
  return fill(n, [&] { return sign_of(random, u); });
}

Gradients axis_aligned(Random& random, std::size_t n) {
  return fill(n, [&] { return sign_of(random, Vec3::Unit(static_cast<Eigen::Index>(random.below(3)))); });
}

Gradients axis_aligned_planar(Random& random, std::size_t n) {
  return fill(n, [&] { return sign_of(random, Vec3::Unit(static_cast<Eigen::Index>(random.below(2)))); });
}

Gradients nearly_parallel(Random& random, std::size_t n) {
  const Vec3 u = random.direction();
  const double angle = small_angle(random);
  return fill(n, [&] { return tilted(random, u, angle); });
}

Gradients nearly_opposite(Random& random, std::size_t n) {
  const Vec3 u = random.direction();
  return fill(n, [&] { return sign_of(random, tilted(random, u, small_angle(random))); });
}

/// Returns gradients that differ from one direction by angles of all magnitudes from 1e-12 to 1 rad.
Gradients graded(Random& random, std::size_t n) {
  const Vec3 u = random.direction();
  return fill(n, [&] { return tilted(random, u, small_angle(random)); });
}

Gradients nearly_parallel_planar(Random& random, std::size_t n) {
  const double angle = small_angle(random);
  const double start = random.uniform(-4.0, 4.0);
  return fill(n, [&] {
    const double a = start + angle * random.uniform(-1.0, 1.0);
    return Vec3(std::cos(a), std::sin(a), 0.0);
  });
}

Gradients duplicated(Random& random, std::size_t n) {
  const Gradients few = uniform(random, 1 + random.below(12));
  return fill(n, [&] { return few[random.below(few.size())]; });
}

/// Returns many copies of one gradient together with a few other gradients.
Gradients lopsided(Random& random, std::size_t n) {
  const Vec3 u = random.direction();
  return fill(n, [&] { return random.uniform() < 0.99 ? u : random.direction(); });
}

Gradients coplanar(Random& random, std::size_t n) {
  const Mat3 frame = random_rotation(random);
  return fill(n, [&] { return Vec3(frame * random.direction_in_plane()); });
}

Gradients nearly_coplanar(Random& random, std::size_t n) {
  const Mat3 frame = random_rotation(random);
  const double height = small_angle(random);
  return fill(n, [&] { return tilted(random, frame * random.direction_in_plane(), height); });
}

Gradients clusters(Random& random, std::size_t n) {
  const Gradients centres = uniform(random, 2 + random.below(8));
  const double spread = small_angle(random);
  return fill(n, [&] { return tilted(random, centres[random.below(centres.size())], spread); });
}

/// Returns clusters of gradients, with angles of all magnitudes within each cluster.
Gradients graded_clusters(Random& random, std::size_t n) {
  const Gradients centres = uniform(random, 2 + random.below(8));
  return fill(n, [&] { return tilted(random, centres[random.below(centres.size())], small_angle(random)); });
}

/// Returns a ring of gradients around an axis, like the wall of a hole. Without the regularisation epsilon, the optimal
/// weights would not be unique.
Gradients cone(Random& random, std::size_t n) {
  const Mat3 frame = random_rotation(random);
  const double z = random.uniform(-1.0, 1.0);
  return fill(n,
              [&] { return Vec3(frame * (std::sqrt(1.0 - z * z) * random.direction_in_plane() + z * Vec3::UnitZ())); });
}

/// Returns an orthonormal frame and other gradients. At the optimum of exact_shaping for epsilon = 0, every stiffness
/// ratio is 1, and so every contact is on the boundary between active and inactive.
Gradients orthonormal_and_more(Random& random, std::size_t n) {
  const Mat3 frame = random_rotation(random);
  std::size_t k = 0;
  return fill(n, [&]() -> Vec3 {
    const std::size_t i = k++;
    return i < 3 ? Vec3(frame.col(static_cast<Eigen::Index>(i))) : random.direction();
  });
}

/// Returns nearly orthogonal pairs of gradients, with couplings of 1e-24 … 1 between springs that are otherwise
/// independent.
Gradients nearly_orthogonal(Random& random, std::size_t n) {
  const Mat3 frame = random_rotation(random);
  const double angle = small_angle(random);
  return fill(
      n, [&] { return tilted(random, sign_of(random, frame.col(static_cast<Eigen::Index>(random.below(3)))), angle); });
}

/// Returns the gradients of two planar faces whose normals differ by 2e-12 to 2 rad. The second face has a small
/// fraction of the gradients.
Gradients wedge(Random& random, std::size_t n) {
  const double angle = small_angle(random);
  const double share = small_angle(random);
  return fill(n, [&] {
    const double a = random.uniform() < share ? angle : -angle;
    return Vec3(std::cos(a), std::sin(a), 0.0);
  });
}

/// Returns a set from one of the distributions above, combined with a set from another distribution.
Gradients mixture(Random& random, std::size_t n) {
  constexpr Gradients (*draws[])(Random&, std::size_t) = {
      uniform,          planar,          parallel, opposite,   axis_aligned,
      nearly_parallel,  nearly_opposite, graded,   duplicated, lopsided,
      coplanar,         nearly_coplanar, clusters, cone,       orthonormal_and_more,
      nearly_orthogonal};
  const std::size_t first = random.below(n + 1);
  Gradients gradients = draws[random.below(std::size(draws))](random, first);
  const Gradients others = draws[random.below(std::size(draws))](random, n - first);
  gradients.insert(gradients.end(), others.begin(), others.end());
  return gradients;
}

constexpr GradientDistribution kDistributions[] = {
    {"uniform", false, uniform},
    {"planar", true, planar},
    {"parallel", false, parallel},
    {"opposite", false, opposite},
    {"axis_aligned", false, axis_aligned},
    {"axis_aligned_planar", true, axis_aligned_planar},
    {"nearly_parallel", false, nearly_parallel},
    {"nearly_opposite", false, nearly_opposite},
    {"graded", false, graded},
    {"nearly_parallel_planar", true, nearly_parallel_planar},
    {"duplicated", false, duplicated},
    {"lopsided", false, lopsided},
    {"coplanar", false, coplanar},
    {"nearly_coplanar", false, nearly_coplanar},
    {"clusters", false, clusters},
    {"graded_clusters", false, graded_clusters},
    {"cone", false, cone},
    {"orthonormal_and_more", false, orthonormal_and_more},
    {"nearly_orthogonal", false, nearly_orthogonal},
    {"wedge", true, wedge},
    {"mixture", false, mixture},
};

}  // namespace

std::span<const GradientDistribution> gradient_distributions() {
  return kDistributions;
}

}  // namespace hapbench::test
