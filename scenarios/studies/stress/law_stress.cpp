#include "scenarios/studies/stress/law_stress.hpp"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "algorithms/depth/depth_model.hpp"
#include "algorithms/registry.hpp"
#include "sim/contact/contact_query.hpp"
#include "sim/contact/stiffness_tensor.hpp"

namespace hapbench {
namespace {

/// Relative rounding error allowed in sums over at most kMostContacts contacts and in exact_shaping's weights, which
/// its epsilon of 1e-6 makes sensitive.
constexpr double kForceRounding = 1e-6;
constexpr std::uint64_t kSetsOfAJob = 1000;

/// One set under one algorithm.
struct Answer {
  RenderedForce force;
  std::size_t colliding = 0, rendered = 0;
  std::uint64_t dropped = 0;
};

Answer answer(const ContactSet& set, const RenderingConfig& config, const PointShell& shell) {
  ShellSource source(shell, set.tool, std::make_unique<ShellQuery>(shell, set.tool), make_depth_model(config));
  ContactBuffer contacts(source.capacity());
  const auto algorithm = make_algorithm(config);
  algorithm->prepare({source.capacity(), &set.tool, &shell});
  algorithm->reset();
  source.contacts_at(set.pose, contacts);
  Answer out;
  out.colliding = contacts.size();
  algorithm->compute({set.pose, set.velocity}, contacts, out.force);
  out.rendered = contacts.size();
  out.dropped = algorithm->work().points_dropped;
  return out;
}

bool finite(const RenderedForce& force) {
  return force.spring.allFinite() && force.rendered.allFinite() && force.S.allFinite() &&
         std::isfinite(force.depth_max);
}

bool depth_in_bound(const Cylinder& tool, double depth) {
  return depth >= 0.0 && depth <= (1.0 + kForceRounding) * tool.longest_exit();
}

/// Damping is B S v, and friction is off: |f_render| <= |f_spring| + B lambda_max(S) |v|.
bool damping_in_bound(const ContactSet& set, const RenderedForce& force) {
  const double B = 2.0 * set.rendering.damping_ratio * std::sqrt(set.rendering.stiffness * set.rendering.mass);
  const double bound = force.spring.norm() + B * lambda_max(force.S) * set.velocity.norm();
  return force.rendered.norm() <= (1.0 + kForceRounding) * bound;
}

void count_answer(const ContactSet& set, const RenderingConfig& config, std::uint64_t number, const Answer& answer,
                  StressCounts& counts) {
  ++counts.sets;
  counts.in_contact += answer.colliding > 0;
  counts.points_dropped += answer.dropped;
  const RenderedForce& force = answer.force;
  const bool bad = counts.non_finite + counts.out_of_bound > 0;
  const double unit = config.stiffness * force.depth_max;
  const auto bound_of = find_algorithm(config.algorithm)->theory.force_bound;
  const std::optional<double> bound =
      bound_of == nullptr
          ? std::nullopt
          : std::optional(config.stiffness * bound_of(config, set.tool, answer.rendered, force.depth_max));
  if (!finite(force)) {
    ++counts.non_finite;
  } else if ((bound && force.spring.norm() > (1.0 + kForceRounding) * *bound) ||
             !depth_in_bound(set.tool, force.depth_max) || !damping_in_bound(set, force)) {
    ++counts.out_of_bound;
  }
  if (!bad && counts.non_finite + counts.out_of_bound > 0) counts.first_bad = number;
  if (!(unit > 0.0)) return;
  counts.largest_force = std::max(counts.largest_force, force.spring.norm() / unit);
  if (bound && *bound > 0.0) counts.largest_share = std::max(*counts.largest_share, force.spring.norm() / *bound);
}

std::vector<StressCounts> no_counts() {
  std::vector<StressCounts> counts;
  for (const AlgorithmEntry& entry : algorithms()) {
    StressCounts& of = counts.emplace_back();
    of.algorithm = entry.info->name;
    if (entry.theory.force_bound != nullptr) of.largest_share = 0.0;
  }
  return counts;
}

/// Adds the counts of other sets, in whatever order they come.
void add(const StressCounts& other, StressCounts& all) {
  const bool bad = all.non_finite + all.out_of_bound > 0, other_bad = other.non_finite + other.out_of_bound > 0;
  if (other_bad) all.first_bad = bad ? std::min(all.first_bad, other.first_bad) : other.first_bad;
  all.sets += other.sets;
  all.in_contact += other.in_contact;
  all.non_finite += other.non_finite;
  all.out_of_bound += other.out_of_bound;
  all.points_dropped += other.points_dropped;
  all.largest_force = std::max(all.largest_force, other.largest_force);
  if (all.largest_share) all.largest_share = std::max(*all.largest_share, *other.largest_share);
}

}  // namespace

ContactSet stress_set(std::uint64_t seed, std::uint64_t i) {
  Random random(Random::derive(seed + 1, i));
  return draw_contact_set(random);
}

std::vector<StressCounts> stress_laws(std::uint64_t count, std::uint64_t seed, const JobOptions& options) {
  std::vector<StressCounts> all = no_counts();
  std::mutex mutex;
  for_each_job((count + kSetsOfAJob - 1) / kSetsOfAJob, options, [&](std::size_t job) {
    std::vector<StressCounts> part = no_counts();
    const std::uint64_t end = std::min(count, (job + 1) * kSetsOfAJob);
    for (std::uint64_t i = job * kSetsOfAJob; i < end; ++i) {
      const ContactSet set = stress_set(seed, i);
      const PointShell shell(set.points, 0.0);
      for (StressCounts& counts : part) {
        RenderingConfig config = set.rendering;
        config.algorithm = counts.algorithm;
        count_answer(set, config, i, answer(set, config, shell), counts);
      }
    }
    const std::lock_guard lock(mutex);
    for (std::size_t i = 0; i < all.size(); ++i) add(part[i], all[i]);
  });
  return all;
}

}  // namespace hapbench
