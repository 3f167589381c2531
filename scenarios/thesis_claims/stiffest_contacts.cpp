#include "scenarios/thesis_claims/stiffest_contacts.hpp"

#include <algorithm>
#include <vector>

#include "algorithms/laws/shaped_stiffness.hpp"
#include "sim/contact/contact_buffer.hpp"
#include "sim/contact/stiffness_tensor.hpp"
#include "sim/core/math.hpp"
#include "sim/core/random.hpp"

namespace hapbench {
namespace {

constexpr std::size_t kMostDirections = 8;
constexpr int kClimbs = 60;
constexpr int kStepsOfAClimb = 1500;
/// A step of the search is at first about as long as this, at last a thousandth of it.
constexpr double kFirstStep = 0.7;

struct WeightedDirection {
  Vec3 direction;
  double weight;
};
using Directions = std::vector<WeightedDirection>;

/// The stiffness tensor after some iterations from the given weights.
Mat3 shaped_tensor(const Directions& contacts, int iterations) {
  std::vector<double> c;
  for (const WeightedDirection& contact : contacts) c.push_back(contact.weight);
  const auto tensor = [&] {
    Mat3 S = Mat3::Zero();
    for (std::size_t i = 0; i < c.size(); ++i) S += c[i] * contacts[i].direction * contacts[i].direction.transpose();
    return S;
  };
  Mat3 S = tensor();
  for (int iteration = 0; iteration < iterations; ++iteration) {
    for (std::size_t i = 0; i < c.size(); ++i) {
      const double ratio = contacts[i].direction.dot(S * contacts[i].direction);
      c[i] = ratio > 0.0 ? c[i] / ratio : 0.0;
    }
    S = tensor();
  }
  return S;
}

/// The limit of the iteration; it does not depend on the weights.
Mat3 limit_tensor(const Directions& contacts) {
  ContactBuffer buffer(contacts.size());
  for (const WeightedDirection& contact : contacts) {
    buffer.push(0, Vec3::Zero(), -contact.direction);
    buffer.set_gradient(buffer.size() - 1, contact.direction);
  }
  buffer.pad();
  solve_exact_shaping(buffer);
  return stiffness_tensor(buffer);
}

Directions random_directions(Random& random) {
  Directions contacts(2 + random.below(kMostDirections - 1));
  const bool planar = random.uniform(0.0, 1.0) < 0.2;
  for (WeightedDirection& contact : contacts) {
    contact.direction = random.direction();
    if (planar) contact.direction.z() = 0.0;
    contact.direction.normalize();
    contact.weight = math::pow(10.0, random.uniform(-2.0, 2.0));
  }
  return contacts;
}

Directions neighbour(Directions contacts, double step, Random& random) {
  WeightedDirection& contact = contacts[random.below(contacts.size())];
  contact.direction = (contact.direction + step * random.direction()).normalized();
  contact.weight *= math::exp(step * random.uniform(-2.0, 2.0));
  return contacts;
}

}  // namespace

StiffestContacts stiffest_contacts(int iterations) {
  const auto stiffness = [iterations](const Directions& contacts) {
    return lambda_max(iterations == kExactLimit ? limit_tensor(contacts) : shaped_tensor(contacts, iterations));
  };
  StiffestContacts result;
  Random random(1);
  for (int climb = 0; climb < kClimbs; ++climb) {
    Directions best = random_directions(random);
    double highest = stiffness(best);
    for (int i = 0; i < kStepsOfAClimb; ++i) {
      const double step = kFirstStep * math::pow(1e-3, static_cast<double>(i) / kStepsOfAClimb);
      Directions next = neighbour(best, step, random);
      const double reached = stiffness(next);
      if (reached <= highest) continue;
      highest = reached;
      best = std::move(next);
    }
    result.lambda_max = std::max(result.lambda_max, highest);
    result.sets += 1 + kStepsOfAClimb;
  }
  return result;
}

}  // namespace hapbench
