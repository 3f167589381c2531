#include <fmt/format.h>

#include <algorithm>

#include "results/observe/ideal_trajectory.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/thesis_claims/claims.hpp"

/// Claims of 1.1 and 1.2: how far a drill pressed into the hole sinks in under other ways to merge forces.
namespace hapbench {
namespace {

constexpr double kPressedTilts[] = {0.35, 0.68, 1.0};  ///< [rad]
/// "Easily penetrates" means at least this many times as deep as with the proposed algorithm.
constexpr double kEasily = 2.0;
/// Rows between evaluations of the depth: 4 ms.
constexpr std::uint64_t kRowsBetweenLooks = 8;
/// Rows before this time are ignored [s]: the start is not the resting place at every tilt.
constexpr double kLanded = 0.5;

/// The largest depth of the drill in the block after it has landed, at each tilt [m]. The largest one, because a drill
/// that pops through has left the block at the end.
std::vector<double> penetrations(const Evidence& e, std::vector<std::string> overrides) {
  std::vector<double> depths;
  overrides.emplace_back();
  for (const double tilt : kPressedTilts) {
    overrides.back() = fmt::format("motion.orientation.tilt_rad={}", tilt);
    const LoadedScenario loaded = e.load("press_into_hole", overrides);
    IdealTrajectoryObserver ideal(std::get<BlockEnvironment>(loaded.scenario.environment).block,
                                  make_cylinder(loaded.scenario.tool));
    double& deepest = depths.emplace_back(0.0);
    e.for_each_row(loaded, [&](const StepRecord& row) {
      if (row.step % kRowsBetweenLooks != 0 || row.time < kLanded) return;
      ideal.on_step(row);
      if (ideal.error()) deepest = std::max(deepest, ideal.error()->interpenetration);
    });
  }
  return depths;
}

MeasuredCase pressed(const Evidence& e, const std::string& name, std::vector<std::string> overrides) {
  return {name, {{"depth", penetrations(e, std::move(overrides))}}};
}

std::string depths_text(const Measured& measured) {
  std::string text;
  for (const MeasuredCase& m : measured) {
    append_item(text, fmt::format("{} ", m.name));
    for (std::size_t i = 0; i < std::size(kPressedTilts); ++i)
      text += fmt::format("{}{:.2f}", i == 0 ? "" : "/", 1e3 * m.all("depth")[i]);
  }
  return fmt::format("inside by at most, in mm, at {} rad: {}", fmt::join(kPressedTilts, "/"), text);
}

/// True if at every tilt `a` is at least `factor` times as deep as `b`.
bool deeper(const MeasuredCase& a, const MeasuredCase& b, double factor) {
  for (std::size_t i = 0; i < std::size(kPressedTilts); ++i) {
    if (!(a.all("depth")[i] >= factor * b.all("depth")[i])) return false;
  }
  return true;
}

// ---- V1: averaging.

Measured measure_averaging(const Evidence& e) {
  return {pressed(e, "shaped_stiffness", {"rendering.algorithm=shaped_stiffness"}),
          pressed(e, "mean", {"rendering.algorithm=mean"})};
}

Finding judge_averaging(const Measured& m, const PublishedNumbers&) {
  const bool easily = deeper(m.at(1), m.at(0), kEasily), more = deeper(m.at(1), m.at(0), 1.0);
  return {
      decide(easily, more), depths_text(m),
      !more ? "averaging holds the drill as well at some tilt"
            : fmt::format("the many points of the wall outvote the few of the rim{}",
                          easily ? "" : fmt::format(", though not at every tilt {} times as deep", in_words(kEasily)))};
}

// ---- V2: virtual coupling, over its stiffness and the points it gets; then what it is at heart, least squares.

constexpr double kCouplings[] = {0.25, 0.5, 1.0, 2.0};  ///< K_vc over K; from `kAsStiff` on no softer than a contact
constexpr double kAsStiff = 1.0;

Measured measure_coupling(const Evidence& e) {
  Measured measured = {pressed(e, "shaped_stiffness", {"rendering.algorithm=shaped_stiffness"})};
  const double stiffness = e.load("press_into_hole").scenario.rendering.stiffness;
  const std::string unreduced = "rendering.reduction=null";
  for (const double coupling : kCouplings) {
    const std::vector<std::string> law = {"rendering.algorithm=virtual_coupling",
                                          fmt::format("rendering.virtual_coupling_N_per_m={}", coupling * stiffness)};
    const auto add = [&](const std::string& points, std::vector<std::string> more) {
      more.insert(more.begin(), law.begin(), law.end());
      MeasuredCase& m = measured.emplace_back(pressed(e, fmt::format("K_vc = {} K, {}", coupling, points), more));
      m.values["coupling"] = {coupling};
    };
    add("reduced", {});
    add("shared points", {unreduced, "environment.vertices=shared"});
    add("points per cell", {unreduced, "environment.vertices=per_cell"});
  }
  measured.push_back(pressed(e, "least_squares", {"rendering.algorithm=least_squares", unreduced}));
  return measured;
}

Finding judge_coupling(const Measured& measured, const PublishedNumbers&) {
  const MeasuredCase& shaped = measured.at(0);
  bool easily = true, more = true, never = true;
  for (const MeasuredCase& m : measured) {
    if (!m.values.contains("coupling")) continue;
    if (m["coupling"] == kAsStiff) {
      easily = easily && deeper(m, shaped, kEasily);
      more = more && deeper(m, shaped, 1.0);
    }
    if (m["coupling"] >= kAsStiff) never = never && deeper(shaped, m, 1.0);
  }
  Finding finding{decide(easily, more), depths_text(measured), ""};
  if (never) finding.verdict = Verdict::refuted;
  finding.why =
      easily ? "the coupling lets the drill in"
      : never
          ? "as we read the law, the coupling's displacement is the translation that resolves all depths best, and more "
            "points only bring every direction nearer to K; a coupling as stiff as a contact holds the drill better than "
            "stiffness shaping, a softer one is what lets it in"
          : "a coupling as stiff as a contact holds the drill about as well as stiffness shaping or better; a softer one lets "
            "it in";
  return finding;
}

}  // namespace

std::vector<Claim> chapter_1_penetration() {
  return {
      {.id = "V1",
       .place = "1.1.2, 1.2, Fig. 2c",
       .claim = "averaging lets the drill easily penetrate in the hole",
       .published = "easily",
       .rule = fmt::format(
           "reproduced: pressed with 1 N, at every tilt at least {} times as deep as with stiffness shaping; in kind: "
           "deeper",
           in_words(kEasily)),
       .measure = measure_averaging,
       .judge = judge_averaging},
      {.id = "V2",
       .place = "1.1.2, 1.2, C.4, Fig. 2d",
       .claim = "so does virtual coupling",
       .published = "easily",
       .rule = fmt::format(
           "reproduced: with K_vc = K at every tilt at least {} times as deep as with stiffness shaping, whatever the "
           "points; in kind: deeper; refuted: at every tilt less deep with every K_vc looked at from K on, whatever the "
           "points",
           in_words(kEasily)),
       .measure = measure_coupling,
       .judge = judge_coupling},
  };
}

}  // namespace hapbench
