#include "scenarios/thesis_claims/measurements.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "algorithms/laws/shaped_stiffness.hpp"
#include "sim/contact/stiffness_tensor.hpp"
#include "sim/core/math.hpp"
#include "sim/core/random.hpp"

namespace hapbench {

MeasuredCase vibration(const std::string& name, const Result& summary) {
  const auto number = [&](const char* metric) { return number_of(summary.metrics, metric).value_or(0.0); };
  return {name,
          {{"velocity_variation", {number("velocity_total_variation_m_per_s")}},
           {"vibration_power", {number("vibration_power_above_30Hz_m2_per_s2")}},
           {"force_reversals", {number("force_reversals")}}}};
}

bool vibrates_much_more(const MeasuredCase& a, const MeasuredCase& b, const PublishedNumbers& p) {
  const double more = threshold(p, "vibrates");
  return a["velocity_variation"] >= more * b["velocity_variation"] &&
         a["vibration_power"] >= more * more * b["vibration_power"];
}

bool vibrates_more(const MeasuredCase& a, const MeasuredCase& b) {
  return a["velocity_variation"] > b["velocity_variation"] && a["vibration_power"] > b["vibration_power"];
}

std::string vibrations_text(const Measured& cases) {
  std::string text;
  for (const MeasuredCase& m : cases) {
    append_item(text,
                fmt::format("{}: velocity varies by {:.3g} m/s, power above 30 Hz {:.2g} m²/s², {:.0f} force reversals",
                            m.name, m["velocity_variation"], m["vibration_power"], m["force_reversals"]));
  }
  return text;
}

void SwingDecay::add(double x) {
  const bool is_extreme = rows_ >= 2 && (last_ - before_) * (x - last_) < 0.0;
  if (is_extreme && !decayed_) {
    const double extreme = std::abs(last_);
    if (extreme < kSmallest) {
      decayed_ = true;
    } else {
      if (extremes_ == 0) first_extreme_ = extreme;
      last_extreme_ = extreme;
      ++extremes_;
    }
  }
  before_ = last_;
  last_ = x;
  ++rows_;
}

std::optional<double> SwingDecay::damping_ratio() const {
  if (extremes_ < 2) return std::nullopt;
  const double q = math::pow(last_extreme_ / first_extreme_, 1.0 / static_cast<double>(extremes_ - 1));
  if (q >= 1.0) return 0.0;
  const double log_q = math::log(q);
  return -log_q / std::sqrt(std::numbers::pi * std::numbers::pi + log_q * log_q);
}

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
