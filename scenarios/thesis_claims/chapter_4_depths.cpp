#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "algorithms/registry.hpp"
#include "scenarios/batch/statistics.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/thesis_claims/claims.hpp"
#include "scenarios/thesis_claims/contacts_by_hand.hpp"
#include "scenarios/thesis_claims/wording.hpp"
#include "sim/contact/contact_query.hpp"

/// Claims of 4.2: the depths and gradients of the thesis's two depth models.
namespace hapbench {
namespace {

// ---- G1: the median line.

constexpr double kSameDirection = 0.999;

Measured measure_median_line(const Evidence&) {
  const auto product = [](const char* model) {
    return wall_point(-0.0001, model).gradient(0).dot(wall_point(0.0001, model).gradient(0));
  };
  return {
      {"", {{"shortest_product", {product("shortest_distance")}}, {"normal_product", {product("surface_normal")}}}}};
}

Finding judge_median_line(const Measured& measured, const PublishedNumbers&) {
  const MeasuredCase& m = measured.at(0);
  const bool flips = m["shortest_product"] < 0.0;
  const bool steady = m["normal_product"] > kSameDirection;
  return {
      decide(flips && steady, flips),
      fmt::format("gradients across the median line: inner product {:.2g} (shortest distance), {:.2g} (surface normal)",
                  m["shortest_product"], m["normal_product"]),
      fmt::format("the shortest distance {}, the surface normal {}", flips ? "flips" : "does not flip",
                  steady ? "does not" : "turns, too")};
}

// ---- G1b: by how much the shortest distance falls short of the way out along the surface normal, as a share of that,
// over all contacts of task 2 that are as shallow as the thesis says.

constexpr double kNegligible = 0.05;
/// Rows between samples: about 30 a second.
constexpr std::uint64_t kRowsBetweenSamples = 64;

Measured measure_underestimation(const Evidence& e) {
  const double shallow = e.published["G1.negligible"].at_most;
  const LoadedScenario loaded = e.load("task2_rotate_signed_distance");
  const auto shell = e.shell(loaded);
  const Cylinder tool = make_cylinder(loaded.scenario.tool);
  ShellQuery query(*shell, tool);
  const auto shortest = find_depth_model("surface_normal")->make(),
             exact = find_depth_model("normal_projection")->make();
  ContactBuffer contacts(shell->size());
  std::vector<double> shortfall;
  e.for_each_row(loaded, [&](const StepRecord& row) {
    if (row.step % kRowsBetweenSamples != 0) return;
    query.contacts_at(row.tool.pose, contacts);
    exact->evaluate(tool, row.tool.pose, contacts);
    const std::vector<double> truth(contacts.depth.begin(),
                                    contacts.depth.begin() + static_cast<long>(contacts.size()));
    shortest->evaluate(tool, row.tool.pose, contacts);
    for (std::size_t i = 0; i < truth.size(); ++i) {
      if (truth[i] > 0.0 && truth[i] <= shallow) shortfall.push_back(1.0 - contacts.depth[i] / truth[i]);
    }
  });
  std::sort(shortfall.begin(), shortfall.end());
  const auto beyond = shortfall.end() - std::upper_bound(shortfall.begin(), shortfall.end(), kNegligible);
  return {{"",
           {{"contacts", {static_cast<double>(shortfall.size())}},
            {"mean", {mean_of(shortfall)}},
            {"percentile_95", {shortfall.at(shortfall.size() * 95 / 100)}},
            {"beyond", {static_cast<double>(beyond) / static_cast<double>(shortfall.size())}}}}};
}

Finding judge_underestimation(const Measured& measured, const PublishedNumbers& published) {
  const MeasuredCase& m = measured.at(0);
  return {
      decide(m["percentile_95"] <= kNegligible, m["mean"] <= kNegligible),
      fmt::format("{:.0f} contacts of task 2 up to {} mm deep: underestimated by {:.0f} % on average, {:.0f} % at the "
                  "95th percentile, {:.0f} % of them by more than {}",
                  m["contacts"], plain(1e3 * published["G1.negligible"].at_most), 100.0 * m["mean"],
                  100.0 * m["percentile_95"], 100.0 * m["beyond"], percent(kNegligible)),
      "where the tool leans on an edge or across a wall, the way out along the normal is longer than the shortest one"};
}

constexpr Claim kChapter4Depths[] = {
    {.id = "G1",
     .place = "4.2, Fig. 8, C.1",
     .claim = "the gradient of the shortest distance flips across the median line, the surface normal's cannot",
     .published = "",
     .rule =
         [](const PublishedNumbers&) {
           return std::string("reproduced: one turns round, the other does not; in kind: the first");
         },
     .measure = measure_median_line,
     .judge = judge_median_line},
    {.id = "G1b",
     .place = "4.2, F.1",
     .claim = "depths are underestimated, negligibly when they are small",
     .published = "negligible below 0.25 mm",
     .rule =
         [](const PublishedNumbers&) {
           return fmt::format("reproduced: by at most {} for 95 % of the contacts of task 2; in kind: on average",
                              percent(kNegligible));
         },
     .measure = measure_underestimation,
     .judge = judge_underestimation},
};

}  // namespace

std::span<const Claim> chapter_4_depths() {
  return kChapter4Depths;
}

}  // namespace hapbench
