#include "scenarios/analysis/stress/law_stress.hpp"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "algorithms/depth/depth_model.hpp"
#include "algorithms/registry.hpp"
#include "scenarios/analysis/stress/stress_set.hpp"
#include "sim/contact/contact_buffer.hpp"
#include "sim/contact/contact_query.hpp"
#include "sim/contact/contact_source.hpp"
#include "sim/core/math.hpp"
#include "sim/core/random.hpp"

namespace hapbench {
namespace {

/// Allowed relative rounding error of sums over at most kMaxContacts contacts, and of the contact weights of the law
/// exact_shaping. The contact weights are sensitive to rounding because their regularisation is weak: its factor
/// kExactShapingEpsilon is 1e-6.
constexpr double kForceRounding = 1e-6;
constexpr std::uint64_t kSetsPerJob = 1000;

/// Returns true if |f_render| <= |f_spring| + B lambda_max(S) |v|. Every rendered force of spring force and damping
/// force B S v, without friction, satisfies this bound.
bool damping_in_bound(const ContactSet& set, const RenderedForce& force) {
  const double B = 2.0 * set.rendering.damping_ratio * std::sqrt(set.rendering.stiffness * set.rendering.mass);
  const double bound = force.spring.norm() + B * lambda_max(force.S) * set.velocity.norm();
  return force.rendered.norm() <= (1.0 + kForceRounding) * bound;
}

/// The force of an algorithm for a contact set, and its bound.
struct StressedForce {
  RenderedForce force;
  double unit = 0.0;            ///< K times the largest depth [N]
  std::optional<double> bound;  ///< bound of |f_spring| [N]; empty for algorithms without a bound
  bool in_contact = false;
  std::uint64_t points_dropped = 0;
};

/// Computes the force of the algorithm in `config` for a contact set.
StressedForce force_on(const ContactSet& set, const PointShell& shell, const RenderingConfig& config) {
  ShellSource source(shell, set.tool, make_contact_query(shell, set.tool, Skips::off), make_depth_model(config));
  ContactBuffer contacts(source.capacity());
  const auto algorithm = make_algorithm(config);
  algorithm->prepare({source.capacity(), &set.tool, &shell});
  algorithm->reset();
  source.contacts_at(set.pose, contacts);
  StressedForce stressed;
  stressed.in_contact = !contacts.empty();  // read before compute(), which may change the contacts
  algorithm->compute({set.pose, set.velocity}, contacts, stressed.force);
  stressed.points_dropped = algorithm->work().points_dropped;
  const double depth_max = stressed.force.depth_max;
  stressed.unit = config.stiffness * depth_max;
  if (const auto bound_of = find_algorithm(config.algorithm)->force_bound; bound_of != nullptr)
    stressed.bound = config.stiffness * bound_of(config, set.tool, contacts.size(), depth_max);
  return stressed;
}

bool all_finite(const RenderedForce& force) {
  return force.spring.allFinite() && force.rendered.allFinite() && force.S.allFinite() &&
         std::isfinite(force.depth_max);
}

/// Returns true if force, depth and damping are within their bounds. Precondition: all numbers of the force are finite.
bool all_in_bound(const ContactSet& set, const StressedForce& stressed) {
  constexpr double kMaxRatio = 1.0 + kForceRounding;
  const RenderedForce& force = stressed.force;
  if (stressed.bound && !(force.spring.norm() <= kMaxRatio * *stressed.bound)) return false;
  if (!(force.depth_max >= 0.0 && force.depth_max <= kMaxRatio * set.tool.max_exit_distance())) return false;
  return damping_in_bound(set, force);
}

/// Computes the force of the algorithm `counts.algorithm` for one contact set, and adds the result to `counts`.
/// `number`: index of the set.
void count_set(const ContactSet& set, std::uint64_t number, const PointShell& shell, StressCounts& counts) {
  RenderingConfig config = set.rendering;
  config.algorithm = counts.algorithm;
  const StressedForce stressed = force_on(set, shell, config);
  const bool is_finite = all_finite(stressed.force);
  const bool in_bound = is_finite && all_in_bound(set, stressed);
  ++counts.sets;
  counts.in_contact += stressed.in_contact;
  counts.points_dropped += stressed.points_dropped;
  counts.non_finite += !is_finite;
  counts.out_of_bound += is_finite && !in_bound;
  if (!in_bound && !counts.first_bad) counts.first_bad = number;
  if (!(stressed.unit > 0.0)) return;
  const double size = stressed.force.spring.norm();
  counts.largest_force = std::max(counts.largest_force, size / stressed.unit);
  if (stressed.bound && *stressed.bound > 0.0)
    counts.largest_share = std::max(*counts.largest_share, size / *stressed.bound);
}

/// Returns zero counts for all algorithms.
std::vector<StressCounts> no_counts() {
  std::vector<StressCounts> counts;
  for (const AlgorithmEntry& entry : algorithms()) {
    StressCounts& of = counts.emplace_back();
    of.algorithm = entry.info->name;
    if (entry.force_bound != nullptr) of.largest_share = 0.0;
  }
  return counts;
}

/// Adds the counts `other` of other contact sets to `all`. The result does not depend on the order of the additions.
void add(const StressCounts& other, StressCounts& all) {
  if (other.first_bad) all.first_bad = std::min(*other.first_bad, all.first_bad.value_or(*other.first_bad));
  all.sets += other.sets;
  all.in_contact += other.in_contact;
  all.non_finite += other.non_finite;
  all.out_of_bound += other.out_of_bound;
  all.points_dropped += other.points_dropped;
  all.largest_force = std::max(all.largest_force, other.largest_force);
  all.largest_share = std::max(all.largest_share, other.largest_share);
}

}  // namespace

std::vector<StressCounts> stress_laws(std::uint64_t count, std::uint64_t seed, const JobOptions& options) {
  std::vector<StressCounts> all = no_counts();
  std::mutex mutex;
  for_each_job((count + kSetsPerJob - 1) / kSetsPerJob, options, [&](std::size_t job) {
    std::vector<StressCounts> part = no_counts();
    const std::uint64_t end = std::min(count, (job + 1) * kSetsPerJob);
    for (std::uint64_t i = job * kSetsPerJob; i < end; ++i) {
      const ContactSet set = stress_set(seed, i);
      const PointShell shell(set.points, 0.0);
      for (StressCounts& counts : part) count_set(set, i, shell, counts);
    }
    const std::lock_guard lock(mutex);
    for (std::size_t i = 0; i < all.size(); ++i) add(part[i], all[i]);
  });
  return all;
}

}  // namespace hapbench
