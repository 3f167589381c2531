#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "algorithms/laws/shaped_stiffness.hpp"
#include "algorithms/registry.hpp"
#include "algorithms/stages/point_stage.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/studies/precision/measure.hpp"
#include "sim/core/random.hpp"

/// Tells whether merging or dropping contacts before the force law saves time, for dozens of contacts to hundreds.
namespace hapbench {
namespace {

constexpr double kMergedSpacings[] = {0.0001, 0.00005, 0.000025};
constexpr std::uint64_t kOrders = 4;

struct MergingWay {
  const char* name;
  const char* law;
  bool reduces;
};
constexpr MergingWay kMergingWays[] = {
    {"exact_shaping of all", "exact_shaping", false},
    {"exact_shaping reduced", "exact_shaping", true},
    {"shaped_stiffness of all", "shaped_stiffness", false},
    {"shaped_stiffness reduced", "shaped_stiffness", true},
    {"merged_shaping", "merged_shaping", false},
};

using Order = std::vector<std::size_t>;

/// One way to compute the force of a contact set.
class Forces {
 public:
  Forces(const MergingWay& way, const RenderingConfig& config, std::size_t capacity)
      : reduction_(way.reduces ? make_gradient_reduction({}) : nullptr),
        law_(make_law(way.law, config)),
        work_(capacity) {
    if (reduction_) reduction_->prepare({});
    law_->prepare(capacity);
  }

  void load(const ContactBuffer& set) { work_.assign(set); }
  void load(const ContactBuffer& set, const Order& order) {
    work_.clear();
    for (const std::size_t i : order) work_.push_copy_of(set, i);
    work_.pad();
  }
  /// Force of the loaded contacts [N].
  Vec3 force() {
    if (reduction_) reduction_->process(work_);
    return law_->evaluate(work_).spring;
  }
  std::size_t kept() const { return work_.size(); }

 private:
  std::unique_ptr<PointStage> reduction_;  ///< may be null
  std::unique_ptr<ForceLaw> law_;
  ContactBuffer work_;
};

/// The largest change of the force when the contacts of a set are put in another order [N].
double spread_over_orders(Forces& forces, const ContactBuffer& set, const Vec3& force, Random& random) {
  Order order(set.size());
  double largest = 0.0;
  for (std::uint64_t k = 0; k < kOrders; ++k) {
    std::iota(order.begin(), order.end(), std::size_t{0});
    random.shuffle(order);
    forces.load(set, order);
    largest = std::max(largest, (forces.force() - force).norm());
  }
  return largest;
}

PrecisionRow row_of(const MergingWay& way, double spacing, const std::vector<ContactBuffer>& sets,
                    const std::vector<Vec3>& reference, const RenderingConfig& config, int repetitions) {
  Forces forces(way, config, largest_size(sets));
  Random random(1);
  double squares = 0.0, scale = 0.0, spread = 0.0, contacts = 0.0, kept = 0.0;
  for (std::size_t i = 0; i < sets.size(); ++i) {
    forces.load(sets[i]);
    const Vec3 force = forces.force();
    squares += (force - reference[i]).squaredNorm();
    scale += reference[i].squaredNorm();
    contacts += static_cast<double>(sets[i].size());
    kept += static_cast<double>(forces.kept());
    spread = std::max(spread, spread_over_orders(forces, sets[i], force, random));
  }
  const double n = static_cast<double>(sets.size()), rms = std::sqrt(scale / n);
  return {fmt::format("{} {}", way.name, spacing),
          "completes",
          {spacing, contacts / n, kept / n, std::sqrt(squares / n) / rms, spread / rms},
          seconds_per_force(
              sets, repetitions, [&](const ContactBuffer& set) { forces.load(set); }, [&] { forces.force(); })};
}

std::vector<Vec3> exact_forces(const std::vector<ContactBuffer>& sets, const RenderingConfig& config) {
  std::vector<Vec3> forces;
  for (const ContactBuffer& set : sets) {
    Forces exact(kMergingWays[0], config, set.size());
    exact.load(set);
    forces.push_back(exact.force());
  }
  return forces;
}

}  // namespace

static PrecisionResult study_merging(const Scenario& given, const PrecisionOptions& options) {
  PrecisionResult result;
  result.columns = {"spacing_m", "contacts_mean", "kept_mean", "force_error_relative", "order_spread_relative"};
  result.timed = "call";
  for (const double spacing : kMergedSpacings) {
    Scenario scenario = given;
    if (auto* block = std::get_if<BlockEnvironment>(&scenario.environment)) block->grid = spacing;
    const std::vector<ContactBuffer> sets = drill_contact_sets(scenario);
    const std::vector<Vec3> reference = exact_forces(sets, scenario.rendering);
    for (const MergingWay& way : kMergingWays) {
      result.add(row_of(way, spacing, sets, reference, scenario.rendering, options.repetitions), options,
                 std::size(kMergingWays) * std::size(kMergedSpacings));
    }
  }
  return result;
}

const PrecisionStudy kMergingStudy = {"merging", "reduced, merged and all contacts, from dozens to hundreds",
                                      "rotate_in_hole", study_merging};

}  // namespace hapbench
