#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "algorithms/laws/shaped_stiffness.hpp"
#include "algorithms/penalty_rendering.hpp"
#include "algorithms/registry.hpp"
#include "scenarios/run/bare_run.hpp"
#include "scenarios/scene/environments.hpp"
#include "scenarios/thesis/claims.hpp"
#include "scenarios/thesis/measurements.hpp"

/// Claims of thesis sections 1.2, 2.8, 3.4 and F.2: the computing time of the force for many contact points. Times are
/// medians of repetitions. They differ between machines and runs, so that the numbers in two ledgers are not equal. A
/// verdict requires that two times differ by at least the factor rule.margin.
namespace hapbench {
namespace {

constexpr int kIterations = 3;  ///< default number of iterations in the thesis

/// Stiffness shaping as formulated in the thesis: with the n x n matrix of squared inner products of n gradients.
class DenseShaping {
 public:
  explicit DenseShaping(std::size_t capacity) : matrix_(capacity * capacity), ratio_(capacity) {}

  /// Computes the weights of the contacts by `iterations` iterations, starting from weights of 1.
  void shape(ContactBuffer& contacts, int iterations) {
    const std::size_t n = contacts.size();
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < n; ++j) {
        const double product = contacts.gradient(i).dot(contacts.gradient(j));
        matrix_[i * n + j] = product * product;
      }
      contacts.weight[i] = 1.0;
    }
    for (int iteration = 0; iteration < iterations; ++iteration) {
      for (std::size_t i = 0; i < n; ++i) {
        ratio_[i] = 0.0;
        for (std::size_t j = 0; j < n; ++j) ratio_[i] += matrix_[i * n + j] * contacts.weight[j];
      }
      for (std::size_t i = 0; i < n; ++i) contacts.weight[i] /= ratio_[i];
    }
  }

 private:
  std::vector<double> matrix_, ratio_;
};

/// Returns a few copies of a contact set. With them, a pass of seconds_with() takes much longer than reading the clock.
std::vector<ContactBuffer> repeated(const ContactBuffer& set) {
  constexpr std::size_t kCopies = 16;
  return std::vector<ContactBuffer>(kCopies, set);
}

// ---- T4, T4b: computing time [s] of one step with almost a thousand contacts, the extreme case of thesis 2.8. The
// contacts are the largest contact set of task 3 with the drill upright and pressed against the wall.

MeasuredValues measure_deadline(const Evidence& e) {
  const LoadedScenario loaded =
      e.load("task3_spin_signed_distance",
             {"motion.orientation.tilt_rad=0", "hand.target.x_m.amplitude=0.002", "hand.target.y_m.amplitude=0.002"});
  const std::vector<ContactBuffer> sets = repeated(largest_of(contact_sets(loaded.scenario, 64)));
  DenseShaping dense(sets.front().size());
  const auto reduction = make_gradient_reduction({});
  reduction->prepare({});
  const auto seconds = [&](auto work) -> std::vector<double> { return {seconds_with(sets, work)}; };
  return {{"points", {static_cast<double>(sets.front().size())}},
          {"matrix", seconds([&](ContactBuffer& contacts) { dense.shape(contacts, kIterations); })},
          {"tensor", seconds([&](ContactBuffer& contacts) { shape_weights(contacts, kIterations); })},
          {"reduced", seconds([&](ContactBuffer& contacts) {
             reduction->process(contacts);
             dense.shape(contacts, kIterations);
           })}};
}

Finding judge_dense_deadline(const MeasuredCase& m, const PublishedNumbers& published) {
  const double deadline = published["T4.step"].mean, margin = threshold(published, "margin");
  const bool missed = m["matrix"] >= margin * deadline, met = margin * m["reduced"] <= deadline;
  return {decide(missed && met, met),
          missed ? fmt::format("in the dense form of the thesis, {}",
                               met ? "the reduction is needed and suffices" : "even the reduction does not suffice")
                 : "on this machine, the dense form does not clearly exceed the time limit"};
}

Finding judge_tensor_deadline(const MeasuredCase& m, const PublishedNumbers& published) {
  const double deadline = published["T4.step"].mean;
  const bool met = threshold(published, "margin") * m["tensor"] <= deadline;
  return {found(met),
          met ? "with the 3 × 3 stiffness tensor, all points are shaped within the time limit without a reduction"
              : "without the reduction, the tensor form does not clearly meet the time limit"};
}

// ---- T5: computing time of one step divided by the time step (dimensionless), for the contacts of task 3, with the
// dense form (n x n matrix) and with the tensor form of stiffness shaping.

MeasuredValues measure_loop_load(const Evidence& e) {
  const LoadedScenario task = e.load("task3_spin_signed_distance");
  const std::vector<ContactBuffer> sets = contact_sets(task.scenario, 128);
  const std::size_t largest = largest_of(sets).size();
  DenseShaping dense(largest);
  const auto reduction = make_gradient_reduction({});
  reduction->prepare({});
  const auto load = [&](auto shape, bool reduce) -> std::vector<double> {
    const double seconds = seconds_with(sets, [&](ContactBuffer& contacts) {
      if (reduce) reduction->process(contacts);
      shape(contacts);
    });
    return {seconds / task.scenario.time.step};
  };
  const auto by_matrix = [&dense](int n) { return [&dense, n](ContactBuffer& contacts) { dense.shape(contacts, n); }; };
  const auto by_tensor = [](ContactBuffer& contacts) { shape_weights(contacts, kIterations); };
  return {{"points", {static_cast<double>(largest)}},        {"reduced_0", load(by_matrix(0), true)},
          {"reduced_3", load(by_matrix(kIterations), true)}, {"unreduced_3", load(by_matrix(kIterations), false)},
          {"tensor_reduced_3", load(by_tensor, true)},       {"tensor_unreduced_3", load(by_tensor, false)}};
}

Finding judge_loop_load(const MeasuredCase& m, const PublishedNumbers& p) {
  const double margin = threshold(p, "margin");
  const bool small = m["reduced_3"] - m["reduced_0"] <= threshold(p, "small_load");
  const bool falls = margin * m["reduced_3"] <= m["unreduced_3"];
  return {decide(small && falls, small || falls),
          fmt::format(
              "the computing time of the iterations is {}; the reduction {} the computing time of the dense form and "
              "{} the computing time of the tensor form",
              small ? "small" : "not small", falls ? "lowers" : "does not lower",
              margin * m["tensor_reduced_3"] <= m["tensor_unreduced_3"] ? "lowers" : "does not lower")};
}

// ---- P2, F3: computing time of one step divided by the time step (dimensionless), of another algorithm and of
// stiffness shaping. P2: the proxy in task 2. F3: tandpasta for the largest contact set of task 2.

MeasuredValues measure_proxy_cost(const Evidence& e) {
  // Run both laws in turn, so that a change of the machine's speed affects both.
  constexpr int kRuns = 11;
  std::map<std::string, std::vector<double>> shares;
  for (int i = 0; i < kRuns; ++i) {
    for (const std::string law : {"proxy", kProposedLaw}) {
      const CheckedScenario scene =
          checked(e.load("task2_held", {"rendering.algorithm=" + law, "record.ideal_trajectory=false"}));
      BareRun run(scene, make_shell(scene.scenario(), scene.files()));
      const double seconds = run.seconds(1);
      shares[law].push_back(seconds / static_cast<double>(run.steps()) / scene.scenario().time.step);
    }
  }
  for (auto& [law, all] : shares) std::ranges::sort(all);
  return {{"other", {shares.at("proxy").at(kRuns / 2)}}, {"shaped", {shares.at(kProposedLaw).at(kRuns / 2)}}};
}

MeasuredValues measure_tandpasta_cost(const Evidence& e) {
  const Scenario scenario = e.load("task2_rotate_signed_distance").scenario;
  const std::vector<ContactBuffer> sets = repeated(largest_of(contact_sets(scenario, 64)));
  MeasuredValues values = {{"points", {static_cast<double>(sets.front().size())}}};
  for (const auto& [name, value] : {std::pair("tandpasta", "other"), std::pair(kProposedLaw, "shaped")}) {
    const auto law = make_law(name, scenario.rendering);
    law->prepare(sets.front().size());
    values[value] = {seconds_with(sets, [&](ContactBuffer& contacts) { law->evaluate(contacts); }) /
                     scenario.time.step};
  }
  return values;
}

Finding judge_other_cost(const MeasuredCase& m, const PublishedNumbers& p) {
  return {decide(m["other"] >= threshold(p, "considerable"), m["other"] >= threshold(p, "margin") * m["shaped"]),
          fmt::format("the computing time is {:#.2g} times that of stiffness shaping", m["other"] / m["shaped"])};
}

}  // namespace

std::vector<ClaimRule> chapter_3_cost() {
  return {single_case<measure_deadline, judge_dense_deadline>("T4"),
          single_case<measure_deadline, judge_tensor_deadline>("T4b"),
          single_case<measure_loop_load, judge_loop_load>("T5"),
          single_case<measure_proxy_cost, judge_other_cost>("P2"),
          single_case<measure_tandpasta_cost, judge_other_cost>("F3")};
}

}  // namespace hapbench
