#include "scenarios/thesis_claims/rules.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace hapbench {

std::string_view verdict_name(Verdict verdict) {
  switch (verdict) {
    case Verdict::reproduced:
      return "reproduced";
    case Verdict::in_kind:
      return "reproduced in kind";
    case Verdict::not_reproduced:
      return "not reproduced";
    case Verdict::refuted:
      return "refuted";
    case Verdict::not_reproducible:
      return "not reproducible";
  }
  return "";
}

namespace {

std::string counts_text(const std::vector<PointCounts>& counts) {
  std::string text;
  for (const PointCounts& c : counts) {
    text += fmt::format("{}{}: raw {:.1f}, reduced {:.2f}, at most {}", text.empty() ? "" : "; ", c.density, c.raw_mean,
                        c.reduced_mean, c.reduced_max);
  }
  return text;
}

Verdict decide(bool reproduced, bool in_kind) {
  return reproduced ? Verdict::reproduced : in_kind ? Verdict::in_kind : Verdict::not_reproduced;
}

}  // namespace

Finding judge_flat_reduction(const std::vector<PointCounts>& counts) {
  const bool one = std::all_of(counts.begin(), counts.end(), [](const PointCounts& c) { return c.reduced_max == 1.0; });
  return {decide(one, false), counts_text(counts),
          one ? "on a flat all gradients are equal, so one point is left" : "more than one point is left on the flat"};
}

Finding judge_reduced_points(const std::vector<PointCounts>& counts, const std::vector<Published>& published,
                             double most) {
  bool near = false, bounded = true, halved = true;
  for (const PointCounts& c : counts) {
    bool this_near = false;
    for (const Published& p : published) this_near |= std::abs(c.reduced_mean - p.mean) <= p.spread;
    near |= this_near && (most == 0.0 || c.reduced_max < most);
    bounded &= most == 0.0 || c.reduced_max < most;
    halved &= 2.0 * c.reduced_mean < c.raw_mean;
  }
  std::string why = near     ? "the reduced mean of one density lies within a published spread"
                    : halved ? "the reduction leaves less than half of the points, but another number than published"
                             : "the reduction leaves more than half of the points";
  if (!bounded) why += fmt::format("; some rows exceed {}", most);
  return {decide(near, halved), counts_text(counts), why};
}

Finding judge_deadline(double matrix, double reduced, double tensor, double deadline) {
  const bool missed = matrix > deadline, met = reduced < deadline;
  return {
      decide(missed && met, met),
      fmt::format("1000 contacts: n x n matrix {:.0f} us, reduced first {:.1f} us, tensor without reduction {:.1f} us; "
                  "deadline {:.0f} us",
                  1e6 * matrix, 1e6 * reduced, 1e6 * tensor, 1e6 * deadline),
      missed ? "the matrix form misses the deadline and the reduction meets it; the tensor form needs no reduction"
             : "this machine is fast enough for the matrix form; the reduction meets the deadline, too"};
}

Finding judge_first_ratios(const RatioExtremes& r, double low, double high, double never_above) {
  const bool in_range = r.first_min >= low && r.first_max <= high, bounded = r.any_max <= never_above;
  return {decide(in_range && bounded, bounded),
          fmt::format("after one iteration {:.3f} to {:.3f}; never above {:.3f}", r.first_min, r.first_max, r.any_max),
          in_range && bounded ? "within the published range"
          : bounded
              ? fmt::format("below {} throughout, but outside {} to {} after one iteration", never_above, low, high)
              : fmt::format("a ratio exceeds {}", never_above)};
}

Finding judge_ratio_limit(const RatioExtremes& r) {
  const bool one = std::abs(r.limit_max - 1.0) <= 0.01;
  return {one ? Verdict::reproduced : Verdict::refuted,
          fmt::format("largest ratio after 160 iterations {:.3f}, at the exact limit {:.3f}", r.last_max, r.limit_max),
          one ? "the exact limit is 1 at every contact of these runs"
              : "the iteration converges to the projection of the identity on the cone of contact tensors, where the "
                "ratio of a contact without weight stays above 1"};
}

Finding judge_force_limit(const ForceLimitCurve& c, double published_onset) {
  const bool proportional = std::abs(c.slope_times_stiffness - 1.0) <= 0.02;
  const bool onset = std::abs(c.onset - published_onset) <= 0.1, constant = c.plateau_spread <= 0.02;
  return {decide(proportional && onset && constant, proportional && constant),
          fmt::format("slope x K = {:.4f}; with the limit constant to {:.2f} % from {:.2f} N on",
                      c.slope_times_stiffness, 100.0 * c.plateau_spread, c.onset),
          fmt::format("{} without the limit; {} with it; {}", proportional ? "proportional" : "not proportional",
                      constant ? "constant" : "not constant", onset ? "onset as published" : "onset elsewhere")};
}

Finding judge_ideal_trajectory(const IdealErrors& e, double most) {
  const bool follows = std::max(e.low_height_rms, e.low_lateral_rms) <= most;
  const bool bounded = e.high_interpenetration_max <= most, deeper = e.high_interpenetration > e.low_interpenetration;
  return {
      decide(follows && bounded, follows && deeper),
      fmt::format("low force: height {:.2f} mm rms, lateral {:.2f} mm rms, inside by {:.2f} mm on average; high force: "
                  "{:.2f} mm on average, at most {:.2f} mm",
                  1e3 * e.low_height_rms, 1e3 * e.low_lateral_rms, 1e3 * e.low_interpenetration,
                  1e3 * e.high_interpenetration, 1e3 * e.high_interpenetration_max),
      fmt::format(
          "with low force the tip {} within {:.2f} mm of the ideal trajectory; with high force it falls {} than "
          "{:.2f} mm inside",
          follows ? "stays" : "does not stay", 1e3 * most, bounded ? "less" : "more", 1e3 * most)};
}

Finding judge_peg_motion(const PegMotion& original, const PegMotion& shaped) {
  const double variation = original.total_variation / shaped.total_variation;
  const bool vibrates = variation >= 5.0, reverses = original.reversals >= 5.0 * shaped.reversals;
  return {decide(vibrates && reverses, variation > 1.0),
          fmt::format("velocity varies by {:.3g} against {:.3g} m/s, the force reverses {} against {} times",
                      original.total_variation, shaped.total_variation, original.reversals, shaped.reversals),
          fmt::format("the original algorithm's velocity varies {:.3g} times as much", variation)};
}

Finding judge_springs_unlimited(const std::vector<SpringRun>& runs) {
  std::string failed;
  std::size_t arrived = 0;
  for (const SpringRun& run : runs) {
    if (run.completes && run.settling < std::numeric_limits<double>::infinity()) {
      ++arrived;
    } else {
      failed += (failed.empty() ? "" : ", ") + run.algorithm;
    }
  }
  return {decide(arrived == runs.size(), 2 * arrived > runs.size()),
          fmt::format("{} of {} algorithms reach the origin", arrived, runs.size()),
          failed.empty() ? "every algorithm settles" : "with 100 springs a side these do not: " + failed};
}

Finding judge_springs_limited(const std::vector<SpringRun>& unlimited, const std::vector<SpringRun>& limited,
                              const std::string& proposed) {
  bool keeps = false;
  std::string slower;
  for (std::size_t i = 0; i < limited.size(); ++i) {
    const double before = unlimited[i].settling, after = limited[i].settling;
    if (limited[i].algorithm == proposed) keeps = std::abs(after / before - 1.0) <= 0.1;
    if (limited[i].algorithm != proposed && before < std::numeric_limits<double>::infinity() && after >= 1.5 * before)
      slower += (slower.empty() ? "" : ", ") + limited[i].algorithm;
  }
  std::string times;
  for (std::size_t i = 0; i < limited.size(); ++i) {
    times += fmt::format("{}{} {:.3g} -> {:.3g} s", i == 0 ? "" : ", ", limited[i].algorithm, unlimited[i].settling,
                         limited[i].settling);
  }
  return {decide(keeps && !slower.empty(), keeps), "settling time without and with limits: " + times,
          fmt::format("the proposed algorithm {} its performance; {}", keeps ? "keeps" : "does not keep",
                      slower.empty() ? "no other one becomes slow" : "slow with the limits: " + slower)};
}

Finding judge_stability_limits(const std::vector<StabilityFigure>& figures) {
  double worst = 0.0;
  std::string text;
  for (const StabilityFigure& f : figures) {
    worst = std::max(worst, std::abs(f.measured / f.published - 1.0));
    text += fmt::format("{}{} {:.6g}", text.empty() ? "" : ", ", f.what, f.measured);
  }
  return {decide(worst <= 0.02, worst <= 0.2), text,
          fmt::format("the largest difference to the published figures is {:.2g} %", 100.0 * worst)};
}

Finding judge_flipped_gradient(double force_along_normal, double with_surface_normal) {
  const bool pulled = force_along_normal<0.0, pushed = with_surface_normal> 0.0;
  return {decide(pulled && pushed, pulled),
          fmt::format("force along the normal {:.3g} N with the shortest distance, {:.3g} N with the surface normal",
                      force_along_normal, with_surface_normal),
          pulled ? "beyond the median line the original algorithm pulls the tool in"
                 : "the original algorithm pushes the tool out here"};
}

Finding judge_original_damping(double along_contact, double across, double angle) {
  return {decide(along_contact < 0.5, along_contact < 1.0),
          fmt::format(
              "two contacts {:.0f} degrees either side of the merged direction: {:.3f} of B along each, {:.3f} across",
              angle, along_contact, across),
          "the original algorithm damps along the merged direction only"};
}

Finding judge_added_points(double before, double after, double direction_product, std::size_t n) {
  const auto count = static_cast<double>(n);
  const bool depths = std::abs(before - (2.0 * count + 1.0)) <= 1e-9 && std::abs(after - (2.0 * count + 3.0)) <= 1e-9;
  const bool turned = direction_product <= -1.0 + 1e-9;
  return {decide(depths && turned, turned),
          fmt::format("n = {}: merged depth {:.9g}, then {:.9g}; directions' inner product {:.3g}", n, before, after,
                      direction_product),
          depths && turned ? "exact, as the formula says" : "another depth or direction than the formula's"};
}

Finding judge_median_line(double shortest_product, double normal_product, double underestimated_by) {
  const bool flips = shortest_product<0.0, steady = normal_product> 0.999, shallow = underestimated_by < 0.05;
  return {decide(flips && steady && shallow, flips && steady),
          fmt::format(
              "gradients across the median line: inner product {:.2g} (shortest distance), {:.2g} (surface normal); "
              "depth at 0.25 mm underestimated by {:.2g} %",
              shortest_product, normal_product, 100.0 * underestimated_by),
          fmt::format("the shortest distance {}, the surface normal {}", flips ? "flips" : "does not flip",
                      steady ? "does not" : "turns, too")};
}

Finding judge_over_reduction(double reduced_max, double unreduced_max, double force_difference) {
  const bool collapsed = reduced_max == 1.0 && unreduced_max >= 10.0, matters = force_difference >= 0.1;
  return {decide(collapsed && matters, collapsed),
          fmt::format("{} of {} points left; the force differs by up to {:.0f} %", reduced_max, unreduced_max,
                      100.0 * force_difference),
          collapsed ? "each point replaces its similar, shallower predecessor until one is left"
                    : "more than one point is left"};
}

Finding judge_pure_rotation(double rotation_work, double damping_work) {
  const bool loads = rotation_work > 0.0, undamped = damping_work == 0.0;
  return {decide(loads && undamped, loads),
          fmt::format("rotation puts {:.3g} mJ into the springs, damping takes {:.3g} mJ out", 1e3 * rotation_work,
                      -1e3 * damping_work),
          undamped ? "a tool that only turns has no velocity to damp" : "the damping takes energy out"};
}

Finding judge_parallel_faces(double depth, double radius, double force, double one_wall_force) {
  const bool sinks = depth >= 0.8 * radius, weightless = force < 0.01 * one_wall_force;
  return {decide(sinks && weightless, weightless),
          fmt::format("sinks in by {:.2f} mm, net force at most {:.2g} N where one wall alone would push with {:.3g} N",
                      1e3 * depth, force, one_wall_force),
          weightless ? "the forces of the two walls cancel" : "the walls push back"};
}

Finding judge_normal_projection(double step, double step_shortest, double pressed, double depth,
                                double depth_shortest) {
  const bool jumps = step >= 5.0 * step_shortest;
  const bool faithful = std::abs(depth / pressed - 1.0) <= 0.02, saturates = depth_shortest < 0.8 * pressed;
  return {decide(jumps && faithful && saturates, jumps),
          fmt::format(
              "largest force step {:.2f} N against {:.2f} N; pressed in by {:.2f} mm: depth {:.2f} against {:.2f} mm",
              step, step_shortest, 1e3 * pressed, 1e3 * depth, 1e3 * depth_shortest),
          fmt::format("the force {} at the corner; on the flat the normal projection {}, the shortest distance {}",
                      jumps ? "jumps" : "does not jump", faithful ? "does not saturate" : "does not follow",
                      saturates ? "does" : "does not")};
}

Finding judge_tandpasta(double energy_ratio, double steps, double steps_shaped) {
  const bool unchanged = std::abs(energy_ratio - 1.0) <= 1e-9, jumps = 5.0 * steps <= steps_shaped;
  return {decide(unchanged && jumps, unchanged || jumps),
          fmt::format("energy ratio {:.12g}; the peg leaves after {} steps, {} with stiffness shaping", energy_ratio,
                      steps, steps_shaped),
          fmt::format("the weights {} the elastic energy; the peg {}", unchanged ? "keep" : "change",
                      jumps ? "is thrown out" : "is not thrown out")};
}

double paired_t(const std::vector<double>& a, const std::vector<double>& b) {
  const auto n = static_cast<double>(a.size());
  if (a.size() < 2) return 0.0;
  double mean = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) mean += a[i] - b[i];
  mean /= n;
  for (std::size_t i = 0; i < a.size(); ++i) squares += std::pow(a[i] - b[i] - mean, 2);
  const double error = std::sqrt(squares / (n - 1.0) / n);
  if (error == 0.0) return mean == 0.0 ? 0.0 : std::copysign(std::numeric_limits<double>::infinity(), mean);
  return mean / error;
}

namespace {

/// Two-sided 5 % quantiles of Student's t for 1 … 10 degrees of freedom; beyond, that of 10, which is a little strict.
double critical_t(std::size_t degrees) {
  constexpr double kCritical[] = {12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228};
  return degrees == 0 ? std::numeric_limits<double>::infinity() : kCritical[std::min<std::size_t>(degrees, 10) - 1];
}

double mean_of(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return values.empty() ? std::nan("") : sum / static_cast<double>(values.size());
}

}  // namespace

Finding judge_experiment(const std::vector<PairedMeasure>& measures, bool published_difference) {
  bool all = true, success = false;
  std::string text, deviating;
  for (const PairedMeasure& m : measures) {
    const double t = paired_t(m.original, m.shaped);
    const bool significant = std::abs(t) > critical_t(m.original.empty() ? 0 : m.original.size() - 1);
    const double published = m.published_original.mean - m.published_shaped.mean;
    const bool agrees = published_difference ? significant && t * published > 0.0 : !significant;
    const bool rates =
        m.name != "success rate" ||
        (std::abs(mean_of(m.original) - m.published_original.mean) <= 2 * m.published_original.spread + 0.1 &&
         std::abs(mean_of(m.shaped) - m.published_shaped.mean) <= 2 * m.published_shaped.spread + 0.1);
    if (m.name == "success rate") success = agrees;
    if (!agrees || !rates) deviating += (deviating.empty() ? "" : ", ") + m.name;
    all = all && agrees && rates;
    text += fmt::format("{}{} {:.3g} vs {:.3g} (t = {:.3g})", text.empty() ? "" : "; ", m.name, mean_of(m.original),
                        mean_of(m.shaped), t);
  }
  return {decide(all, success), text,
          deviating.empty() ? "every measure agrees with the published one in direction and significance"
                            : "other than published: " + deviating};
}

}  // namespace hapbench
