#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "scenarios/thesis_claims/finding.hpp"

/// The rules of the claims ledger: measured numbers in, a finding out. Each says in its comment when a claim counts as
/// reproduced and when as reproduced in kind. Ids and places are those of the ledger (scenarios/experiments/claims).
namespace hapbench {

/// Counts of one of the thesis's tasks with one density field.
struct PointCounts {
  std::string density;
  double raw_mean = 0.0;
  double reduced_mean = 0.0;  ///< over the rows with contact
  double reduced_max = 0.0;
};

/// T1. Reproduced: never more than one point after the reduction.
Finding judge_flat_reduction(const std::vector<PointCounts>& counts);

/// T2, T3. The raw counts are input. Reproduced: for one of the densities the reduced mean lies within one published
/// spread of one of the published means, and no count exceeds `most` (0: no bound published). In kind: the reduction
/// leaves less than half of the points.
Finding judge_reduced_points(const std::vector<PointCounts>& counts, const std::vector<Published>& published,
                             double most);

/// T4. Times of one step's work for 1000 contacts [s]. Reproduced: the n x n matrix of the thesis misses the deadline
/// and the reduction meets it.
Finding judge_deadline(double matrix, double reduced, double tensor, double deadline);

/// Extreme stiffness ratios over all rows of the tasks.
struct RatioExtremes {
  double first_min = 0.0, first_max = 0.0;  ///< after one iteration
  double any_max = 0.0;                     ///< after one or more
  double last_max = 0.0;                    ///< after 160
  double limit_max = 0.0;                   ///< at the exact limit of the iteration
};

/// R1. Reproduced: after one iteration within the published range, and never above 1.5 after. In kind: never above 1.5.
Finding judge_first_ratios(const RatioExtremes& ratios, double low, double high, double never_above);

/// R1b. The iteration's limit is the projection of the identity on the cone of contact tensors. Reproduced: there no
/// ratio differs from 1 by more than 1 %. Otherwise the statement is refuted.
Finding judge_ratio_limit(const RatioExtremes& ratios);

/// L1. Displacement into the flat against measured force.
struct ForceLimitCurve {
  double slope_times_stiffness = 0.0;  ///< without limit: d displacement / d force times K; 1 is proportional
  double onset = 0.0;                  ///< with limit: measured force from which the displacement stays [N]
  double plateau_spread = 0.0;         ///< with limit: (max - min) / mean of the displacement beyond the onset
};
/// Reproduced: slope within 2 %, onset within 0.1 N of the published one, spread below 2 %.
Finding judge_force_limit(const ForceLimitCurve& curve, double published_onset);

/// J1. Against the ideal trajectory [m].
struct IdealErrors {
  double low_height_rms = 0.0;
  double low_lateral_rms = 0.0;
  double low_interpenetration = 0.0;   ///< mean
  double high_interpenetration = 0.0;  ///< mean
  double high_interpenetration_max = 0.0;
};
/// Reproduced: with low force the tip stays within `most` of the ideal trajectory (rms) and with high force the tool
/// falls inside by at most `most`. In kind: low force within `most`, high force deeper than low.
Finding judge_ideal_trajectory(const IdealErrors& errors, double most);

/// A1. Of the 2-D peg. Reproduced: the original algorithm's velocity varies at least five times as much, and its force
/// reverses at least five times as often.
struct PegMotion {
  double total_variation = 0.0;  ///< of the velocity [m/s]
  double reversals = 0.0;        ///< of the force
};
Finding judge_peg_motion(const PegMotion& original, const PegMotion& shaped);

/// One algorithm on the springs.
struct SpringRun {
  std::string algorithm;
  bool completes = false;
  double final_distance = 0.0;  ///< from the origin [m]
  double settling = 0.0;        ///< last time further than 1 % of the start [s]
};
/// A2. Reproduced: every algorithm ends within 1 % of its starting distance. In kind: most do.
Finding judge_springs_unlimited(const std::vector<SpringRun>& runs);
/// A3. Reproduced: with the limits the proposed algorithm settles as fast as without (within 10 %), and another one
/// takes at least half as long again or never settles.
Finding judge_springs_limited(const std::vector<SpringRun>& unlimited, const std::vector<SpringRun>& limited,
                              const std::string& proposed);

/// A4. Stability limits beside the published ones. Reproduced: all within 2 %.
struct StabilityFigure {
  std::string what;
  double measured = 0.0;
  double published = 0.0;
};
Finding judge_stability_limits(const std::vector<StabilityFigure>& figures);

/// B1. <f, n>: force on the tool along the surface normal of points beyond the tool's median line. Reproduced:
/// negative, the tool is pulled in.
Finding judge_flipped_gradient(double force_along_normal, double with_surface_normal);
/// B2. Two contacts at `angle` either side of the merged direction: how much of B damps along each contact, and across
/// the merged direction. Reproduced: less than half along the contacts.
Finding judge_original_damping(double along_contact, double across, double angle);
/// B3. Merged depth before and after two more points, in units of the common depth. Reproduced: the published integers
/// to 1e-9, and opposite directions.
Finding judge_added_points(double before, double after, double direction_product, std::size_t n);

/// G1. Gradients of a point before and behind the median line. Reproduced: the shortest distance's turn round, the
/// surface normal's do not, and a shallow point's depth is underestimated by less than 5 %.
Finding judge_median_line(double shortest_product, double normal_product, double underestimated_by);

/// C1. Reproduced: one point is left, of at least ten, and the force changes by at least 10 %.
Finding judge_over_reduction(double reduced_max, double unreduced_max, double force_difference);
/// C2. Reproduced: rotation loads the springs and the damping takes nothing out.
Finding judge_pure_rotation(double rotation_work, double damping_work);
/// C3. Reproduced: the drill sinks into the walls by most of its radius and the net force stays below 1 % of what one
/// wall alone would give.
Finding judge_parallel_faces(double depth, double radius, double force, double one_wall_force);
/// F1. Force steps at a corner [N], and depths rendered for a press of `pressed` into a flat [m]. Reproduced: the
/// normal projection steps at least five times as much, and follows the press where the shortest distance saturates.
Finding judge_normal_projection(double step, double step_shortest, double pressed, double depth, double depth_shortest);
/// F2. Energy of the weighed over the plain springs, and how many steps the peg takes to leave. Reproduced: the energy
/// is unchanged (1e-9) and the peg leaves at least five times as fast as with stiffness shaping.
Finding judge_tandpasta(double energy_ratio, double steps, double steps_shaped);

/// D1–D4. One measure of one target over the subjects: what each subject had with either algorithm.
struct PairedMeasure {
  std::string name;
  std::vector<double> original;
  std::vector<double> shaped;
  Published published_original;
  Published published_shaped;
};
/// t of a paired test; 0 for fewer than two pairs, infinite when all pairs differ alike.
double paired_t(const std::vector<double>& a, const std::vector<double>& b);
/// Reproduced: every measure is significant (or not) as published, in the published direction, and success rates lie
/// within two published standard errors plus 0.1. In kind: the success rate is significant (or not) as published, in
/// the published direction. `published_difference`: whether the thesis found one.
Finding judge_experiment(const std::vector<PairedMeasure>& measures, bool published_difference);

}  // namespace hapbench
