#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "scenarios/studies/stability/stability_limits.hpp"
#include "scenarios/thesis_claims/claims.hpp"
#include "scenarios/thesis_claims/wording.hpp"

/// Claim of A.3: the stability limits of the integrator.
namespace hapbench {
namespace {

// ---- A4: the stability limits. A case for each published figure.

struct Figure {
  const char* name;
  const char* published;  ///< id
};
constexpr Figure kUndampedStiffness = {"K_max (B = 0)", "A4.stiffness"};
constexpr Figure kDampingAlone = {"B_max (K = 0)", "A4.damping"};
constexpr Figure kDampedStiffness = {"K_max (B from zeta)", "A4.stiffness.damped"};
constexpr Figure kDampingThere = {"B there", "A4.damping.damped"};
constexpr Figure kFigures[] = {kUndampedStiffness, kDampingAlone, kDampedStiffness, kDampingThere};

constexpr double kEqualLimits = 0.02;
constexpr double kAlikeLimits = 0.2;

Measured measure_stability_limits(const Evidence& e) {
  Measured measured;
  const auto add = [&measured](const Figure& figure, double value) {
    measured.push_back({figure.name, {{"limit", {value}}}});
  };
  for (const StabilityLimit& limit : stability_limits(e.load("single_spring").scenario)) {
    if (limit.which == StabilityCase::stiffness_undamped) add(kUndampedStiffness, limit.simulation);
    if (limit.which == StabilityCase::damping_alone) add(kDampingAlone, limit.simulation);
    if (limit.which != StabilityCase::stiffness_damped) continue;
    add(kDampedStiffness, limit.simulation);
    add(kDampingThere, limit.damping_at_limit);
  }
  return measured;
}

Finding judge_stability_limits(const Measured& measured, const PublishedNumbers& published) {
  double worst = 0.0;
  std::string text;
  for (const MeasuredCase& m : measured) {
    const auto figure =
        std::find_if(std::begin(kFigures), std::end(kFigures), [&m](const Figure& f) { return f.name == m.name; });
    worst = std::max(worst, std::abs(m["limit"] / published[figure->published].mean - 1.0));
    text += fmt::format("{}{} {:.6g}", text.empty() ? "" : ", ", m.name, m["limit"]);
  }
  return {decide(worst <= kEqualLimits, worst <= kAlikeLimits), text,
          fmt::format("the largest difference to the published figures is {:.2g} %", 100.0 * worst)};
}

constexpr Claim kAppendixAStability[] = {
    {.id = "A4",
     .place = "A.3, root locus",
     .claim = "largest stable stiffness and damping at 0.5 ms",
     .published = "1.6e6 N/m (B = 0), 400 N s/m (K = 0), 433 000 N/m with B = 291 N s/m",
     .rule = [](const PublishedNumbers&) { return fmt::format("reproduced: all within {}", percent(kEqualLimits)); },
     .measure = measure_stability_limits,
     .judge = judge_stability_limits},
};

}  // namespace

std::span<const Claim> appendix_a_stability() {
  return kAppendixAStability;
}

}  // namespace hapbench
