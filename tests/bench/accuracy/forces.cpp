#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "algorithms/laws/exact_shaping.hpp"
#include "algorithms/laws/shaped_stiffness.hpp"
#include "algorithms/penalty_rendering.hpp"
#include "algorithms/registry.hpp"
#include "scenarios/thesis/measurements.hpp"
#include "sim/core/random.hpp"
#include "tests/bench/accuracy/accuracy.hpp"

/// Panels of forces on given contacts: the contacts of a drill that rotates in a hole.
namespace hapbench::accuracy {
namespace {

using Sets = std::vector<ContactBuffer>;

constexpr std::uint64_t kSampledEvery = 64;

constexpr int kExact = -1;  // stands for the exact optimum in kIterations
constexpr int kIterations[] = {0, 1, 2, 3, 4, 5, 10, 20, 40, 80, 160, kExact};

constexpr double kThresholds[] = {0.9, 0.95, 0.99, 0.995, 0.999, 0.9999};
constexpr double kMergedSpacings[] = {0.0001, 0.00005, 0.000025};
constexpr int kOrders = 4;

/// A force law. If `reduction` has a value, the contacts are reduced before the law is evaluated.
struct Method {
  std::string name;
  const char* law;
  std::optional<ReductionConfig> reduction = {};
};
const Method kReference{"exact_shaping of all", "exact_shaping"};
const Method kMergingMethods[] = {kReference,
                                  {"exact_shaping reduced", "exact_shaping", ReductionConfig{}},
                                  {"shaped_stiffness of all", "shaped_stiffness"},
                                  {"shaped_stiffness reduced", "shaped_stiffness", ReductionConfig{}},
                                  {"merged_shaping", "merged_shaping"}};

Sets drill_sets(const Scenario& drill) {
  return contact_sets(drill_in_hole(drill), kSampledEvery);
}

/// Returns the work of calling `force(contacts)` once for each set. `force` may change its contacts, because it gets
/// copies. Making the copies is not timed.
template <class Force>
Work forces_of(const Sets& sets, Force force) {
  const auto copies = std::make_shared<Sets>();
  for (const ContactBuffer& set : sets) copies->emplace_back(set.size());
  return {[copies, &sets] {
            for (std::size_t i = 0; i < sets.size(); ++i) (*copies)[i].assign(sets[i]);
          },
          [copies, force] {
            for (ContactBuffer& set : *copies) force(set);
          },
          sets.size()};
}

Mat3 shape(ContactBuffer& contacts, int iterations) {
  if (iterations != kExact) return shape_weights(contacts, iterations);
  solve_exact_shaping(contacts);
  return stiffness_tensor(contacts);
}

Errors off_the_optimum(const Sets& sets, const std::vector<Mat3>& optimum, int iterations) {
  double squares = 0.0, largest = 0.0, ratio = 0.0;
  ContactBuffer work(largest_size(sets));
  for (std::size_t i = 0; i < sets.size(); ++i) {
    work.assign(sets[i]);
    const Mat3 S = shape(work, iterations);
    const double error = (S - optimum[i]).norm();
    squares += error * error / static_cast<double>(sets.size());
    largest = std::max(largest, error);
    const RatioRange range = ratio_range(work, S);
    ratio = std::max({ratio, std::abs(range.min - 1.0), std::abs(range.max - 1.0)});
  }
  return {"completes",
          {{"tensor_error_rms", std::sqrt(squares)}, {"tensor_error_max", largest}, {"ratio_error_max", ratio}}};
}

/// Function object that reduces the contacts, if the method has a reduction, and computes their force. Changes the
/// contacts.
class ForceOf {
 public:
  ForceOf(const Method& method, const RenderingConfig& config, std::size_t capacity)
      : reduction_(method.reduction ? make_gradient_reduction(*method.reduction) : nullptr),
        law_(make_law(method.law, config)) {
    if (reduction_) reduction_->prepare({});
    law_->prepare(capacity);
  }
  /// Returns the spring force [N].
  Vec3 operator()(ContactBuffer& contacts) const {
    if (reduction_) reduction_->process(contacts);
    return law_->evaluate(contacts).spring;
  }

 private:
  std::shared_ptr<PointStage> reduction_;  ///< null without a reduction
  std::shared_ptr<ForceLaw> law_;
};

/// Returns the largest change of the force [N] over kOrders random orders of the contacts of a set.
double spread_over_orders(const ForceOf& force_of, const ContactBuffer& set, const Vec3& force, Random& random) {
  std::vector<std::size_t> order(set.size());
  ContactBuffer work(set.size());
  double largest = 0.0;
  for (int k = 0; k < kOrders; ++k) {
    std::iota(order.begin(), order.end(), std::size_t{0});
    random.shuffle(order);
    work.clear();
    for (const std::size_t i : order) work.push_copy_of(set, i);
    work.pad();
    largest = std::max(largest, (force_of(work) - force).norm());
  }
  return largest;
}

Errors off_exact_shaping(const Method& method, const Sets& sets, const RenderingConfig& config) {
  const ForceOf exact(kReference, config, largest_size(sets)), force_of(method, config, largest_size(sets));
  Random random(1);
  ContactBuffer work(largest_size(sets));
  double squares = 0.0, scale = 0.0, largest = 0.0, spread = 0.0, contacts = 0.0, kept = 0.0;
  for (const ContactBuffer& set : sets) {
    work.assign(set);
    const Vec3 reference = exact(work);
    work.assign(set);
    const Vec3 force = force_of(work);
    squares += (force - reference).squaredNorm();
    scale += reference.squaredNorm();
    largest = std::max(largest, (force - reference).norm());
    contacts += static_cast<double>(set.size());
    kept += static_cast<double>(work.size());
    spread = std::max(spread, spread_over_orders(force_of, set, force, random));
  }
  const double n = static_cast<double>(sets.size()), rms = std::sqrt(scale / n);
  return {"completes",
          {{"contacts_mean", contacts / n},
           {"kept_mean", kept / n},
           {"force_error_relative", std::sqrt(squares / n) / rms},
           {"depth_error_max_m", largest / config.stiffness},
           {"order_spread_relative", spread / rms}}};
}

template <class Asked>
Setting setting_of(const std::string& name, const Method& method, const Asked& sets, const RenderingConfig& config) {
  return {name, "call", [=] { return off_exact_shaping(method, sets(), config); },
          [=] { return forces_of(sets(), ForceOf(method, config, largest_size(sets()))); }};
}

}  // namespace

Panel shaping(const Scenario& drill) {
  const auto sets = once([drill] { return drill_sets(drill); });
  const auto optimum = once([sets] {
    std::vector<Mat3> tensors;
    for (ContactBuffer set : sets()) tensors.push_back(shape(set, kExact));
    return tensors;
  });
  Panel panel;
  for (const int m : kIterations) {
    panel.push_back({m == kExact ? "shaping/exact" : fmt::format("shaping/m={}", m), "call",
                     [=] { return off_the_optimum(sets(), optimum(), m); },
                     [=] { return forces_of(sets(), [m](ContactBuffer& set) { shape(set, m); }); }});
  }
  return panel;
}

Panel reduction(const Scenario& drill) {
  const auto sets = once([drill] { return drill_sets(drill); });
  Panel panel;
  for (const char* law : {"shaped_stiffness", "exact_shaping"}) {
    for (const double threshold : kThresholds) {
      const Method method{fmt::format("{} {}", law, threshold), law,
                          ReductionConfig{.threshold = threshold, .max_points = 100'000, .shuffle_seed = {}}};
      panel.push_back(setting_of("reduction/" + method.name, method, sets, drill.rendering));
    }
    panel.push_back(setting_of(fmt::format("reduction/{} off", law), {"", law}, sets, drill.rendering));
  }
  return panel;
}

Panel merging(const Scenario& drill) {
  Panel panel;
  for (const double spacing : kMergedSpacings) {
    Scenario scenario = drill;
    std::get<BlockEnvironment>(scenario.environment).grid = spacing;
    const auto sets = once([scenario] { return drill_sets(scenario); });
    for (const Method& method : kMergingMethods)
      panel.push_back(setting_of(fmt::format("merging/{} {}", method.name, spacing), method, sets, drill.rendering));
  }
  return panel;
}

}  // namespace hapbench::accuracy
