#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <utility>

#include "algorithms/laws/exact_shaping.hpp"
#include "algorithms/laws/force_law.hpp"
#include "algorithms/laws/shaped_stiffness.hpp"
#include "algorithms/registry.hpp"
#include "results/observe/ideal_trajectory.hpp"
#include "scenarios/batch/comparison.hpp"
#include "scenarios/batch/statistics.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/run/checked_scenario.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "scenarios/scene/named_files.hpp"
#include "scenarios/scene/scenario.hpp"
#include "scenarios/scene/tools.hpp"
#include "scenarios/thesis/claims.hpp"
#include "scenarios/thesis/measurements.hpp"
#include "sim/core/math.hpp"
#include "sim/core/random.hpp"

/// Claims of thesis sections 2.4, 3.4, 4.3 and A.3: the stiffness ratios after some iterations and in the limit of
/// infinitely many iterations, and bounds of the combined stiffness.
namespace hapbench {
namespace {

// ---- R1, R3, R4, R6: smallest and largest stiffness ratio in the recorded steps of tasks 2 and 3. One case for each
// task and density; then one case for each density with averages over the steps of all three tasks. The suffixes _1, _2
// and _3 are the number of updates.
// inside: fraction of the steps in which both ratios are in the published range.
// min, max: smallest and largest ratio over all steps; in the cases of averages, the means of both ratios.
// any_max: largest ratio over all steps and all recorded numbers of updates, from 1 on.
// damped: fraction of the steps in which the relative damping sqrt(ratio) zeta is, for both ratios, within a factor
// rule.around of zeta.

/// The tasks in the hole.
constexpr const char* kHoleTasks[] = {"task2_rotate", "task3_spin"};
constexpr double kFewUpdates[] = {1.0, 2.0, 3.0};

std::string after(const char* name, double updates) {
  return fmt::format("{}_{}", name, updates);
}

MeasuredCase measure_task_ratios(const Evidence& e, const std::string& task, const std::string& density) {
  const PublishedNumber& once = e.published["R1.once"];
  const double around = threshold(e.published, "around");
  MeasuredCase m{task.substr(0, 5) + " " + density, {}};
  const auto table = e.table(task + "_" + density, "ratios.csv");
  const auto &iteration = table.at("iteration"), &low = table.at("ratio_min"), &high = table.at("ratio_max");
  double any_largest = 1.0;
  for (std::size_t i = 0; i < iteration.size(); ++i)
    if (iteration[i] >= 1.0 && !std::isnan(low[i])) any_largest = std::max(any_largest, high[i]);
  m.values["any_max"] = {any_largest};
  for (const double updates : kFewUpdates) {
    double rows = 0.0, inside = 0.0, damped = 0.0, smallest = 1.0, largest = 1.0;
    for (std::size_t i = 0; i < iteration.size(); ++i) {
      if (iteration[i] != updates || std::isnan(low[i])) continue;
      smallest = std::min(smallest, low[i]);
      largest = std::max(largest, high[i]);
      rows += 1.0;
      if (low[i] >= once.at_least && high[i] <= once.at_most) inside += 1.0;
      if (std::sqrt(low[i]) >= 1.0 / around && std::sqrt(high[i]) <= around) damped += 1.0;
    }
    m.values[after("inside", updates)] = {inside / rows};
    m.values[after("damped", updates)] = {damped / rows};
    m.values[after("min", updates)] = {smallest};
    m.values[after("max", updates)] = {largest};
  }
  return m;
}

/// Returns the averages of the smallest and of the largest ratio over the steps of all tasks.
MeasuredCase average_ratios(const Evidence& e, const std::string& density) {
  MeasuredCase m{"average " + density, {}};
  for (const double updates : kFewUpdates) {
    std::vector<double> low, high;
    for (const std::string task : kTasks) {
      const auto table = e.table(task + "_" + density, "ratios.csv");
      for (std::size_t i = 0; i < table.at("iteration").size(); ++i) {
        if (table.at("iteration")[i] != updates || std::isnan(table.at("ratio_min")[i])) continue;
        low.push_back(table.at("ratio_min")[i]);
        high.push_back(table.at("ratio_max")[i]);
      }
    }
    m.values[after("min", updates)] = {mean_of(low)};
    m.values[after("max", updates)] = {mean_of(high)};
  }
  return m;
}

Measured measure_ratios(const Evidence& e) {
  Measured measured;
  for (const std::string task : kHoleTasks)
    for (const std::string density : kDensities) measured.push_back(measure_task_ratios(e, task, density));
  for (const std::string density : kDensities) measured.push_back(average_ratios(e, density));
  return measured;
}

/// Number of cases with a single task. They are at the beginning of measure_ratios(), and the averages follow.
constexpr std::size_t kTaskCases = std::size(kHoleTasks) * std::size(kDensities);

/// smallest() and largest() return the extreme of the measured number `value` over the cases with a single task.
double smallest(const Measured& measured, const std::string& value) {
  double result = std::numeric_limits<double>::infinity();
  for (const MeasuredCase& m : std::span(measured).first(kTaskCases)) result = std::min(result, m[value]);
  return result;
}
double largest(const Measured& measured, const std::string& value) {
  double result = 0.0;
  for (const MeasuredCase& m : std::span(measured).first(kTaskCases)) result = std::max(result, m[value]);
  return result;
}

/// Returns the smallest stiffness ratio, after one update, of a single contact beside `parallel` contacts that have the
/// same direction, over all angles between the two directions. With k = `parallel` and the square x of the inner
/// product of the two directions, the ratio of the single contact is 1 / (1 + k x) + k x / (k + x).
double smallest_after_one_update(int parallel) {
  const double k = parallel;
  double smallest_ratio = 1.0;
  constexpr int kSamples = 10000;
  for (int i = 0; i <= kSamples; ++i) {
    const double x = static_cast<double>(i) / kSamples;
    smallest_ratio = std::min(smallest_ratio, 1.0 / (1.0 + k * x) + k * x / (k + x));
  }
  return smallest_ratio;
}

/// Returns, as text, in how many steps `condition` holds: the smallest and the largest fraction `value` of the steps in
/// the cases with a single task.
std::string percent_of_steps(const Measured& measured, const std::string& value, const std::string& condition) {
  const std::string low = fmt::format("{:.0f} %", 100.0 * smallest(measured, value));
  const std::string high = fmt::format("{:.0f} %", 100.0 * largest(measured, value));
  return low == high ? fmt::format("share of the steps in which {}: {}", condition, low)
                     : fmt::format("share of the steps in which {}: {} in the worst run, {} in the best run", condition,
                                   low, high);
}

/// Judges the range of the stiffness ratios after `updates` updates of the weights. If `averaged`, judges the averages
/// of the smallest and of the largest ratio over all tasks; the cases after the first kTaskCases have these averages.
/// Otherwise judges the fraction of the steps whose ratios are all in the published range.
Finding judge_range(const Measured& measured, const PublishedNumbers& p, double updates, bool averaged) {
  const PublishedNumber& once = p["R1.once"];
  const double inside = smallest(measured, after("inside", updates));
  double low = 1.0, high = 1.0;
  for (const MeasuredCase& m : std::span(measured).subspan(kTaskCases)) {
    low = std::min(low, m[after("min", updates)]);
    high = std::max(high, m[after("max", updates)]);
  }
  const bool averages = low >= once.at_least && high <= once.at_most;
  const Verdict verdict =
      averaged ? decide(averages, false) : decide(inside >= threshold(p, "nearly_all"), inside >= threshold(p, "most"));
  return {
      verdict,
      fmt::format(
          "if k contacts have the same direction and one contact has another direction, then after one iteration, this "
          "one contact can have a ratio as small as {:.2f}, {:.2f} and {:.2f} for k = 3, 4 and 5. The reduction of the "
          "thesis keeps about 6 contacts, and several of them can be nearly parallel (6° apart)",
          smallest_after_one_update(3), smallest_after_one_update(4), smallest_after_one_update(5)),
      "",
      averaged ? fmt::format("mean over the steps: smallest ratio {:.2f}, largest ratio {:.2f}", low, high)
               : percent_of_steps(
                     measured, after("inside", updates),
                     fmt::format("all ratios after {} are within {} to {}",
                                 updates == 1.0 ? "one iteration" : fmt::format("{} iterations", plain(updates)),
                                 plain(once.at_least), plain(once.at_most)))};
}

Finding judge_first_update(const Measured& measured, const PublishedNumbers& p) {
  return judge_range(measured, p, p["ratios.one_iteration"].mean, p["ratios.averaged"].mean == 1.0);
}

Finding judge_three_updates(const Measured& measured, const PublishedNumbers& p) {
  Finding finding = judge_range(measured, p, p["R1.iterations"].mean, p["ratios.averaged"].mean == 1.0);
  const auto width = [&](double updates) {
    return largest(measured, after("max", updates)) - smallest(measured, after("min", updates));
  };
  finding.why = fmt::format("with three iterations, the range of all ratios is {:.2f} wide, with one iteration {:.2f}",
                            width(p["R1.iterations"].mean), width(p["ratios.one_iteration"].mean));
  return finding;
}

/// The earlier rules of R1 and R3 combined the range after `updates` updates with the bound of R4, and knew no
/// averages.
Verdict judge_range_and_bound(const Measured& measured, const PublishedNumbers& p, double updates) {
  const double inside = smallest(measured, after("inside", updates));
  const bool bounded = largest(measured, "any_max") <= p["R1.bound"].at_most;
  return decide(bounded && inside >= threshold(p, "nearly_all"), inside >= threshold(p, "most"));
}

/// Returns the measured number `value` times `factor` of each case with a single task, as a list in text form. `format`
/// is the format of each number.
std::string of_tasks(const Measured& measured, const char* value, const char* format, double factor = 1.0) {
  std::string text;
  for (const MeasuredCase& m : std::span(measured).first(kTaskCases))
    append_item(text, fmt::format("{}: {}", m.name, fmt::format(fmt::runtime(format), factor * m[value])));
  return text;
}

Finding judge_bound_in_tasks(const Measured& measured, const PublishedNumbers& p) {
  const double largest_ratio = largest(measured, "any_max"), bound = p["R1.bound"].at_most;
  return {decide(largest_ratio <= bound, false), "the bound (1 + √3)/2 = 1.366 of R2 is proved for all contacts",
          "largest stiffness ratio after any number of iterations: " + of_tasks(measured, "any_max", "{:.3f}"),
          fmt::format("largest ratio in tasks 2 and 3: {:.3f}", largest_ratio)};
}

Finding judge_relative_damping_of_tasks(const Measured& measured, const PublishedNumbers& p) {
  const double share = smallest(measured, "damped_3"), around = threshold(p, "around");
  return {decide(share >= threshold(p, "nearly_all"), share >= threshold(p, "most")),
          "the damping ratio of combined contacts is √ρ times that of one contact, where ρ is the stiffness ratio",
          fmt::format("steps in which √ρ is within a factor {} of 1 for all contacts: {}", plain(around),
                      of_tasks(measured, "damped_3", "{:.0f} %", 100.0)),
          percent_of_steps(
              measured, "damped_3",
              fmt::format("the damping ratio of combined contacts is within a factor {} of the damping ratio of one "
                          "contact",
                          plain(around)))};
}

// ---- R1b: the largest stiffness ratio in the recorded steps of tasks 2 and 3: after 160 iterations, and in the exact
// limit, which is the projection of the identity onto the cone of contact tensors.

MeasuredValues measure_convergence(const Evidence& e) {
  double last_max = 1.0, limit_max = 1.0;
  for (const char* task : {"task2_rotate_signed_distance", "task3_spin_signed_distance"}) {
    const auto table = e.table(task, "ratios.csv");
    for (std::size_t i = 0; i < table.at("iteration").size(); ++i) {
      const double ratio = table.at("ratio_max")[i];
      if (table.at("iteration")[i] == 160.0 && ratio > last_max) last_max = ratio;
    }
    LoadedScenario scene = e.load(task);
    const auto every = static_cast<std::uint64_t>(scene.scenario.record.every);
    for_each_row(checked(std::move(scene)), [&](const StepRecord& row) {
      if (row.step % every != 0 || row.rendered->empty()) return;
      ContactBuffer set(row.rendered->size());
      set.assign(*row.rendered);
      solve_exact_shaping(set);
      limit_max = std::max(limit_max, ratio_range(set, stiffness_tensor(set)).max);
    });
  }
  return {{"last_max", {last_max}}, {"limit_max", {limit_max}}};
}

Finding judge_convergence(const MeasuredCase& m, const PublishedNumbers& p) {
  const bool one = std::abs(m["limit_max"] - 1.0) <= threshold(p, "converged");
  return {
      one ? Verdict::replicated : Verdict::contradicted,
      one ? "the exact limit is 1 at every contact of these runs"
          : "no weight can be negative, so for some sets of contacts, no weights make all ratios 1; in the limit of "
            "the iteration, the ratio of a contact with weight 0 is above 1"};
}

// ---- R2: the largest stiffness in any direction, in units of K, over contact sets found by a random search. One case
// for each number of iterations. After one or more iterations, the largest stiffness is at most (1 + sqrt 3)/2, and at
// most (1 + sqrt 2)/2 if all directions lie in a plane; the proof is in algorithms/SHAPING.md. The search shows
// that the bound is sharp, and would reveal an error in the proof.

/// Value of `iterations` that selects the exact limit of infinitely many iterations.
constexpr int kExactLimit = -1;
/// Largest amount by which rounding may raise a result of the search above the true supremum.
constexpr double kSearchRounding = 1e-9;

constexpr std::size_t kMaxDirections = 8;  ///< largest number of directions of a set
constexpr int kClimbs = 60;                ///< number of hill climbs from random sets
constexpr int kStepsPerClimb = 1500;
/// Length of the first step of a climb [rad]. The length decreases geometrically to a thousandth.
constexpr double kFirstStep = 0.7;

/// A contact's gradient direction and initial weight.
struct WeightedDirection {
  Vec3 direction;
  double weight;
};
using Directions = std::vector<WeightedDirection>;

/// Returns the stiffness tensor in units of K after `iterations` iterations from the given weights. The exact limit
/// does not depend on the weights.
Mat3 shaped_tensor(const Directions& contacts, int iterations, ContactBuffer& buffer) {
  buffer.clear();
  for (const auto& [direction, weight] : contacts) {
    buffer.push(0, Vec3::Zero(), -direction);
    buffer.set_gradient(buffer.size() - 1, direction);
    buffer.weight[buffer.size() - 1] = weight;
  }
  buffer.pad();
  if (iterations == kExactLimit) solve_exact_shaping(buffer);
  Mat3 S = stiffness_tensor(buffer);
  for (int iteration = 0; iteration < iterations; ++iteration) S = update_shaped_weights(buffer, S);
  return S;
}

/// Returns 2 to kMaxDirections random directions with log-uniform weights from 0.01 to 100. In a fifth of the sets, all
/// directions lie in one plane.
Directions random_directions(Random& random) {
  Directions contacts(2 + random.below(kMaxDirections - 1));
  const bool planar = random.uniform(0.0, 1.0) < 0.2;
  for (WeightedDirection& contact : contacts) {
    contact.direction = random.direction();
    if (planar) contact.direction.z() = 0.0;
    contact.direction.normalize();
    contact.weight = math::pow(10.0, random.uniform(-2.0, 2.0));
  }
  return contacts;
}

/// Returns the set after a random change of one contact: its direction turns by about `step` [rad], and its weight
/// changes by a factor of at most exp(2 step).
Directions neighbour(Directions contacts, double step, Random& random) {
  WeightedDirection& contact = contacts[random.below(contacts.size())];
  contact.direction = (contact.direction + step * random.direction()).normalized();
  contact.weight *= math::exp(step * random.uniform(-2.0, 2.0));
  return contacts;
}

/// Returns the largest eigenvalue of the stiffness tensor after `iterations` iterations, in units of K, over all
/// contact sets that hill climbs from random sets of up to eight weighted directions find. An initial weight represents
/// many contacts in one direction. Takes about half a second.
double stiffest_contacts(int iterations) {
  ContactBuffer buffer(kMaxDirections);
  const auto stiffness = [&](const Directions& contacts) {
    return lambda_max(shaped_tensor(contacts, iterations, buffer));
  };
  double stiffest = 0.0;
  Random random(1);
  for (int climb = 0; climb < kClimbs; ++climb) {
    // Climb from a random set: accept each random change that raises the stiffness.
    Directions best = random_directions(random);
    double highest = stiffness(best);
    for (int i = 0; i < kStepsPerClimb; ++i) {
      const double step = kFirstStep * math::pow(1e-3, static_cast<double>(i) / kStepsPerClimb);
      Directions next = neighbour(best, step, random);
      const double reached = stiffness(next);
      if (reached <= highest) continue;
      highest = reached;
      best = std::move(next);
    }
    stiffest = std::max(stiffest, highest);
  }
  return stiffest;
}

Measured measure_guarantee(const Evidence&) {
  // The search does not depend on the evidence: its result is computed once for all assumption sets.
  static const Measured found = [] {
    Measured measured;
    for (const int iterations : {1, 2, 3, 10, kExactLimit}) {
      measured.push_back({iterations == kExactLimit ? "limit" : std::to_string(iterations),
                          {{"lambda_max", {stiffest_contacts(iterations)}},
                           {"sets", {static_cast<double>(kClimbs * (1 + kStepsPerClimb))}}}});
    }
    return measured;
  }();
  return found;
}

Finding judge_guarantee(const Measured& measured, const PublishedNumbers& published) {
  const double guaranteed = published["R2.bound"].at_most, proved = (1.0 + std::sqrt(3.0)) / 2.0;
  double largest = 0.0;
  for (const MeasuredCase& m : measured) largest = std::max(largest, m["lambda_max"]);
  const bool holds = largest <= guaranteed;
  return {decide(holds, false),
          !holds ? fmt::format("a set of contacts exceeds {}", guaranteed)
                 : fmt::format(
                       "{} (1 + √3)/2 = {:.5f}; this bound is proved for every direction and any number of iterations "
                       "(BEYOND.md)",
                       largest <= proved + kSearchRounding ? "no set exceeds" : "some set exceeds", proved)};
}

// ---- R5, S3, F5: extreme values of formulas over random sets of contacts, compared with the bounds of the formulas.
// Each bound follows from its formula. A value beyond the bound would reveal an error in the implementation.

constexpr int kRandomSets = 2000;
constexpr double kRounding = 1e-9;  // stated in the rules' texts

/// Calls `look` for kRandomSets random sets of 2 to kMaxDirections contacts. Each contact has a depth of 1 mm and the
/// weight 1.
template <class Look>
void for_random_contacts(Look look) {
  Random random(1);
  ContactBuffer contacts(kMaxDirections);
  for (int i = 0; i < kRandomSets; ++i) {
    const Directions directions = random_directions(random);
    shaped_tensor(directions, 0, contacts);  // fills the buffer
    for (std::size_t k = 0; k < contacts.size(); ++k) {
      contacts.weight[k] = 1.0;
      contacts.depth[k] = 1e-3;
    }
    look(contacts);
  }
}

MeasuredValues measure_unshaped_ratios(const Evidence&) {
  double low = std::numeric_limits<double>::infinity(), high = 0.0;
  for_random_contacts([&](ContactBuffer& contacts) {
    const auto range = ratio_range(contacts, stiffness_tensor(contacts));
    low = std::min(low, range.min);
    high = std::max(high, range.max / static_cast<double>(contacts.size()));
  });
  return {{"min", {low}}, {"max_per_n", {high}}, {"sets", {kRandomSets}}};
}

Finding judge_unshaped_ratios(const MeasuredCase& m, const PublishedNumbers&) {
  const bool bounded = m["min"] >= 1.0 - kRounding && m["max_per_n"] <= 1.0 + kRounding;
  return {decide(bounded, false),
          "the ratio is a sum of n squared inner products of gradients; each is at most 1, and one of them is 1"};
}

Measured measure_bounded_laws(const Evidence&) {
  RenderingConfig config;
  config.virtual_coupling = config.stiffness;
  Measured measured;
  for (const char* name : {"mean", "virtual_coupling"}) {
    const auto law = make_law(name, config);
    law->prepare(kMaxDirections);
    double stiffest = 0.0;
    for_random_contacts(
        [&](ContactBuffer& contacts) { stiffest = std::max(stiffest, lambda_max(law->evaluate(contacts).S)); });
    measured.push_back({name, {{"lambda_max", {stiffest}}}});
  }
  return measured;
}

Finding judge_bounded_laws(const Measured& measured, const PublishedNumbers&) {
  const bool bounded =
      std::ranges::all_of(measured, [](const MeasuredCase& m) { return m["lambda_max"] <= 1.0 + kRounding; });
  return {decide(bounded, false),
          "a mean of projections has no eigenvalue above 1, and springs in series are softer than each of them"};
}

MeasuredValues measure_cancelling(const Evidence&) {
  double low = 1.0, high = 0.0;
  for_random_contacts([&](ContactBuffer& contacts) {
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      double sum = 0.0, of_magnitudes = 0.0;
      for (std::size_t j = 0; j < contacts.size(); ++j) {
        const double product = contacts.gradient(i).dot(contacts.gradient(j));
        sum += product;
        of_magnitudes += std::abs(product);
      }
      low = std::min(low, std::abs(sum) / of_magnitudes);
      high = std::max(high, std::abs(sum) / of_magnitudes);
    }
  });
  return {{"min", {low}}, {"max", {high}}};
}

Finding judge_cancelling(const MeasuredCase& m, const PublishedNumbers&) {
  const bool bounded = m["min"] >= 0.0 && m["max"] <= 1.0 + kRounding;
  return {decide(bounded, false), "the magnitude of a sum is at most the sum of the magnitudes"};
}

}  // namespace

std::vector<ClaimRule> chapter_3_stiffness() {
  return {{"R1", measure_ratios, judge_first_update, {[](const Measured& m, const PublishedNumbers& p) {
             return judge_range_and_bound(m, p, p["ratios.one_iteration"].mean);
           }}},
          {"R3", measure_ratios, judge_three_updates, {[](const Measured& m, const PublishedNumbers& p) {
             return judge_range_and_bound(m, p, p["R1.iterations"].mean);
           }}},
          {"R4", measure_ratios, judge_bound_in_tasks},
          {"R6", measure_ratios, judge_relative_damping_of_tasks},
          single_case<measure_convergence, judge_convergence>("R1b"),
          {"R2", measure_guarantee, judge_guarantee},
          single_case<measure_unshaped_ratios, judge_unshaped_ratios>("R5"),
          {"S3", measure_bounded_laws, judge_bounded_laws},
          single_case<measure_cancelling, judge_cancelling>("F5")};
}

}  // namespace hapbench
