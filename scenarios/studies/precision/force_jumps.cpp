#include <algorithm>
#include <cmath>

#include "algorithms/registry.hpp"
#include "results/summary/outcome_names.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/studies/precision/measure.hpp"

/// Study of the jumps of the force along a prescribed stroke. Bounds of a law's stiffness hold while the contacts stay;
/// as they come and go, its force may jump. A finer step tells a jump from a slope: it divides the change of a slope.
namespace hapbench {
namespace {

constexpr std::int64_t kFiner = 10;
constexpr double kNoJump = 0.01;

/// The largest change of the force from a row to the next, and the way between the two.
struct LargestChange {
  double force = 0.0;    ///< [N]
  double per_way = 0.0;  ///< [N/m]
  Outcome outcome = Outcome::completes;
};

LargestChange largest_change(const Scenario& scenario, const std::shared_ptr<const PointShell>& shell) {
  const SampledRun run = sampled_run(scenario, shell, 1);
  LargestChange change;
  change.outcome = run.result.outcome;
  for (std::size_t i = 1; i < run.forces.size(); ++i) {
    const double force = (run.forces[i] - run.forces[i - 1]).norm();
    change.force = std::max(change.force, force);
    change.per_way = std::max(change.per_way, force / (run.positions[i] - run.positions[i - 1]).norm());
  }
  return change;
}

PrecisionRow jumps_row(std::string setting, const Scenario& scenario, const std::shared_ptr<const PointShell>& shell,
                       int repetitions) {
  Scenario finer = scenario;
  finer.time.step /= static_cast<double>(kFiner);
  finer.time.steps *= kFiner;
  const LargestChange coarse = largest_change(scenario, shell), fine = largest_change(finer, shell);
  // A jump J on a slope s gives J + s h with the step h and J + s h / r with h / r; J is what is left at h = 0. A
  // curved slope leaves a remainder below kNoJump, which is no jump.
  const auto r = static_cast<double>(kFiner);
  const double left = (r * fine.force - coarse.force) / (r - 1.0);
  const double jump = left > kNoJump * fine.force ? left : 0.0;
  return {std::move(setting),
          std::string(outcome_name(coarse.outcome)),
          {1e-6 * coarse.per_way, coarse.force, fine.force, jump, coarse.per_way / scenario.rendering.stiffness},
          seconds_per_step(scenario, shell, repetitions)};
}

}  // namespace

static PrecisionResult study_force_jumps(const Scenario& given, const PrecisionOptions& options) {
  if (!std::holds_alternative<PrescribedPosition>(given.motion.position)) {
    throw InputError(InputError::Kind::relation, "/motion/position/type",
                     "got a tool that forces move; allowed for this study: \"prescribed\"");
  }
  const auto shell = make_shell(given);
  PrecisionResult result;
  result.columns = {"force_jump_max_N_per_um", "force_change_max_N", "force_change_fine_max_N", "force_jump_max_N",
                    "stiffness_over_step"};
  result.timed = "step";
  const std::size_t all = algorithms().size() + 1;
  for (const AlgorithmEntry& algorithm : algorithms()) {
    result.add(jumps_row(algorithm.info->name, with_algorithm(given, algorithm.info->name), shell, options.repetitions),
               options, all);
  }
  Scenario reduced = given;
  reduced.rendering.reduction.emplace();
  result.add(jumps_row(reduced.rendering.algorithm + " + reduction", reduced, shell, options.repetitions), options,
             all);
  return result;
}

const PrecisionStudy kForceJumpsStudy = {
    "force_jumps", "every algorithm along a prescribed stroke: how far the force jumps as contacts come and go",
    "stroke_in_hole", study_force_jumps};

}  // namespace hapbench
