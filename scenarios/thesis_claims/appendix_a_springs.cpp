#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "scenarios/thesis_claims/claims.hpp"
#include "scenarios/thesis_claims/wording.hpp"

/// Claims of A.2: a mass on many springs.
namespace hapbench {
namespace {

/// The thesis's algorithms, once each: on springs the normal projection is stiffness shaping.
constexpr const char* kAlgorithms[] = {"original_averaging", "summation",        "mean",
                                       "virtual_coupling",   "shaped_stiffness", "tandpasta"};
constexpr std::size_t kPairs = 100;  ///< of Table A.3

/// How a mass comes to rest. Distances are shares of the distance at the start.
struct Approach {
  bool arrives = false;    ///< at the end within kArrived of the origin
  double overshoot = 0.0;  ///< furthest beyond either axis [m]
  double swings = 0.0;     ///< crossings of the axes by more than kArrived
};
constexpr double kArrived = 0.01;

class Swings {
 public:
  /// Counts a change to the other side of zero, once it is `far` from it.
  void add(double x, double far) {
    if (std::abs(x) < far) return;
    if (x * side_ < 0.0) ++count_;
    side_ = x;
  }
  double count() const { return count_; }

 private:
  double side_ = 0.0, count_ = 0.0;
};

struct SpringScene {
  const char* scenario;  ///< springs_unlimited or springs_limited
  std::size_t pairs;
  std::optional<bool> signed_depths = {};  ///< none: as the scenario has it
};

Approach approach(const Evidence& e, const SpringScene& scene, const std::string& algorithm) {
  const std::size_t upward = std::max<std::size_t>(1, scene.pairs / 10);
  std::vector<std::string> overrides = {fmt::format("environment.groups.0.count={}", scene.pairs),
                                        fmt::format("environment.groups.1.count={}", scene.pairs),
                                        fmt::format("environment.groups.2.count={}", upward),
                                        // Long enough for the slowest, which creeps: 4 s.
                                        "time.steps=8000", "record.ratio_iterations=[]"};
  if (scene.signed_depths) overrides.push_back(fmt::format("environment.signed={}", *scene.signed_depths));
  const LoadedScenario loaded = e.load(fmt::format("{}_{}", scene.scenario, algorithm), overrides);
  const double far = kArrived * loaded.scenario.initial.position.norm();
  const auto rows = static_cast<std::uint64_t>(loaded.scenario.time.steps);
  Approach result;
  Swings x, y;
  e.for_each_row(loaded, [&](const StepRecord& row) {
    const Vec3& p = row.tool.pose.position;
    // The start is in the negative quadrant.
    result.overshoot = std::max({result.overshoot, p.x(), p.y()});
    x.add(p.x(), far);
    y.add(p.y(), far);
    // A run that diverges has no last row.
    result.arrives = row.step + 1 == rows && p.norm() <= far;
  });
  result.swings = x.count() + y.count();
  return result;
}

// ---- A2: the algorithms that arrive. A case for each algorithm; "arrives" and the number of pairs over numbers of
// pairs and both readings of the depth: signed, or its absolute value along the displacement (2.3: d >= 0).

constexpr std::size_t kPairCounts[] = {1, 2, 4, 10, 30, kPairs};

Measured measure_springs_unlimited(const Evidence& e) {
  Measured measured;
  for (const bool signed_depths : {true, false}) {
    for (const std::size_t pairs : kPairCounts) {
      MeasuredCase& m = measured.emplace_back();
      m.name = signed_depths ? "depths signed" : "depths ≥ 0";
      m.values["pairs"] = {static_cast<double>(pairs)};
      for (const char* algorithm : kAlgorithms) {
        const Approach a = approach(e, {"springs_unlimited", pairs, signed_depths}, algorithm);
        m.values[algorithm] = {a.arrives ? 1.0 : 0.0};
      }
    }
  }
  return measured;
}

std::string missing(const MeasuredCase& m) {
  std::string names;
  for (const char* algorithm : kAlgorithms) {
    if (m[algorithm] == 0.0) names += (names.empty() ? "" : ", ") + std::string(algorithm);
  }
  return names;
}

std::string arriving(const std::string& missing) {
  return missing.empty() ? "all arrive" : "all but " + missing;
}

Finding judge_springs_unlimited(const Measured& measured, const PublishedNumbers&) {
  bool all = false, some = false;
  std::string text, sign, last;
  for (const MeasuredCase& m : measured) {
    const std::string who = missing(m);
    if (who.empty()) (m["pairs"] == static_cast<double>(kPairs) ? all : some) = true;
    if (m.name != sign) {
      text += fmt::format("{}{}: {} with {:g}", text.empty() ? "" : " pairs; ", m.name, arriving(who), m["pairs"]);
    } else if (who != last) {
      text += fmt::format(" pairs, {} with {:g}", arriving(who), m["pairs"]);
    } else {
      text += fmt::format(", {:g}", m["pairs"]);
    }
    sign = m.name;
    last = who;
  }
  text += " pairs";
  return {
      decide(all, some), text,
      "100 pairs of 88.5 N s/m are 17 700 N s/m, 22 times the 2 M / Δt = 800 N s/m that A.3 allows, so the plain sum "
      "must diverge there"};
}

// ---- A3: overshoot [m] and swings without and with limits. A case for each algorithm.

/// Rounding apart, a performance that is kept does not overshoot further than this share more.
constexpr double kSameOvershoot = 0.1;
constexpr double kFluctuates = 5.0;  ///< swings more than those of the proposed algorithm

Measured measure_springs_limited(const Evidence& e) {
  Measured measured;
  for (const char* algorithm : kAlgorithms) {
    const Approach before = approach(e, {"springs_unlimited", kPairs}, algorithm);
    const Approach after = approach(e, {"springs_limited", kPairs}, algorithm);
    measured.push_back({algorithm,
                        {{"overshoot_unlimited", {before.overshoot}},
                         {"overshoot", {after.overshoot}},
                         {"swings_unlimited", {before.swings}},
                         {"swings", {after.swings}},
                         {"arrives", {after.arrives ? 1.0 : 0.0}}}});
  }
  return measured;
}

Finding judge_springs_limited(const Measured& runs, const PublishedNumbers&) {
  const auto proposed =
      std::find_if(runs.begin(), runs.end(), [](const MeasuredCase& m) { return m.name == kProposedLaw; });
  const bool keeps = proposed->operator[]("arrives") == 1.0 &&
                     (*proposed)["overshoot"] <= (1.0 + kSameOvershoot) * (*proposed)["overshoot_unlimited"] &&
                     (*proposed)["swings"] <= (*proposed)["swings_unlimited"];
  std::string fluctuate, text;
  for (const MeasuredCase& m : runs) {
    if (m["swings"] >= (*proposed)["swings"] + kFluctuates) fluctuate += (fluctuate.empty() ? "" : ", ") + m.name;
    text +=
        fmt::format("{}{} {:.2f} mm, {} swings", text.empty() ? "" : "; ", m.name, 1e3 * m["overshoot"], m["swings"]);
  }
  return {decide(keeps && !fluctuate.empty(), keeps || !fluctuate.empty()),
          "overshoot and swings with the limits: " + text,
          fmt::format("the proposed algorithm {} its performance; {}", keeps ? "keeps" : "does not keep",
                      fluctuate.empty() ? "no other one fluctuates" : "fluctuating: " + fluctuate)};
}

constexpr Claim kAppendixASprings[] = {
    {.id = "A2",
     .place = "A.2, Fig. A.4",
     .claim = "without limits every algorithm brings the springs to the origin",
     .published = "every algorithm, 100 pairs",
     .rule =
         [](const PublishedNumbers&) {
           return fmt::format(
               "reproduced: each of the thesis's {} algorithms ends within {} of the start's distance from the origin with "
               "the {} pairs of Table A.3, under one reading of the depth's sign; in kind: with fewer pairs",
               std::size(kAlgorithms), percent(kArrived), kPairs);
         },
     .measure = measure_springs_unlimited,
     .judge = judge_springs_unlimited},
    {.id = "A3",
     .place = "A.2, Fig. A.5",
     .claim = "with limits the proposed algorithm keeps its performance, others fluctuate",
     .published = "B_max 100 N s/m, F_max 30 N",
     .rule =
         [](const PublishedNumbers&) {
           return fmt::format(
               "reproduced: with the limits stiffness shaping arrives, overshoots at most {} further and swings no more often "
               "than without, while another algorithm swings {} times more than it; in kind: one of the two",
               percent(kSameOvershoot), in_words(kFluctuates));
         },
     .measure = measure_springs_limited,
     .judge = judge_springs_limited},
};

}  // namespace

std::span<const Claim> appendix_a_springs() {
  return kAppendixASprings;
}

}  // namespace hapbench
