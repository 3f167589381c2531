#include "scenarios/analysis/tuning/tune.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "device_model/theory/linear_loops.hpp"
#include "scenarios/analysis/stability/interval_search.hpp"
#include "scenarios/analysis/stability/limit_question.hpp"
#include "scenarios/analysis/stability/run_stability.hpp"
#include "scenarios/analysis/stability/stability_rule.hpp"
#include "scenarios/analysis/tuning/trials.hpp"
#include "scenarios/input/bundled_scenarios.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/run/checked_scenario.hpp"
#include "scenarios/run/diagnosis.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/scene/environments.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "scenarios/scene/scenario.hpp"

namespace hapbench::tune_test {
namespace {

using Words = std::vector<std::string>;

TuneQuestion question(const char* scene, const Words& overrides) {
  TuneQuestion question;
  question.scenario = read_scenario_text(find_scenario(scene));
  question.overrides = overrides;
  return question;
}

/// Relative tolerance of a tuned K. The search ends at half a per cent of K. Within about 1 % of the limit, runs of
/// 4000 steps do not separate decay from vibration (run_stability.hpp).
constexpr double kWithin = 0.03;

/// Checks a handle that a hand holds: with the worst of the typical hands, its loop is stable up to twice the tuned K.
/// A known answer for a handle without a hand tests that `tune` finds the largest K over damping ratios.
TEST(Tune, OfAHeldHandleIsTheLimitOfTheWorstHand) {
  constexpr double kMass = 0.1;  // mass of the scene, which defines zeta [kg]
  const Words device = {
      R"(device={"type":"impedance","handle_mass_kg":0.3,"viscous_N_s_per_m":0.5,"delay_samples":1.5})",
      "time.steps=4000",
      R"(hand={"type":"mass_spring_damper","mass_kg":0.2,"stiffness_N_per_m":300,"damping_N_s_per_m":6,)"
      R"("target":{"x_m":0,"y_m":0,"z_m":0}})"};
  const TuneQuestion asked = question("single_spring", device);
  const TunedLaw law = tuned_law(asked, "summation");
  ASSERT_TRUE(law.choice) << law.why;
  SampledLoop loop;
  loop.period = load_scenario(asked.scenario, device).scenario.time.step;
  loop.device.handle_mass = 0.3;
  loop.device.viscous = 0.5;
  loop.device.delay_samples = 1.5;
  const double K = 2.0 * law.choice->stiffness;
  loop.wall_damping = 2.0 * *law.choice->setting.damping_ratio * std::sqrt(K * kMass);
  EXPECT_NEAR(K / worst_hand_stability_limit(loop), 1.0, kWithin);
}

/// Returns the smallest limit [N/m] of the loop of virtual mass, wall and servo, over hands of 100, 300 and 1000 N/m.
double worst_limit_at_wall(const Scenario& scenario, double zeta, double mass) {
  AdmittanceLoop loop;
  loop.servo = std::get<AdmittanceDeviceConfig>(scenario.device).servo;
  loop.hand_damping = 6.0;
  double least = INFINITY;
  for (const double hand : {100.0, 300.0, 1000.0}) {
    loop.hand_stiffness = hand;
    least = std::min(least, first_stability_limit(1e3, 1e8, [&](double K) {
                       loop.tool = {K, 2.0 * zeta * std::sqrt(K * mass), mass, scenario.time.step, 1.0};
                       return loop.state_matrix();
                     }));
  }
  return least;
}

/// Checks an admittance device at a wall that pushes but does not pull. With little damping, the tool bounces off the
/// wall, and the bounces do not decay within the run. For zeta >= 0.5, the result is the limit with the worst hand, at
/// the best zeta and mass. The run simulates four seconds, so that the landing, which decays slowly near the limit, is
/// a small part of the judged steps.
TEST(Tune, OfTheDeviceAtAWallIsTheLimitOfTheWorstHand) {
  TuneQuestion asked = question("device_at_wall", {"device.force_limit_N=null", "time.steps=8000"});
  asked.threads = 2;
  asked.damping_ratio = {0.5, 3.0};
  asked.allow_vibration = true;
  const TunedLaw law = tuned_law(asked, "shaped_stiffness");
  ASSERT_TRUE(law.choice) << law.why;
  EXPECT_EQ(law.verified, kVerificationSamples + kSamplesNearLimit);
  const Scenario scenario = load_scenario(asked.scenario, law.overrides).scenario;
  double best = 0.0;
  for (double zeta = 0.5; zeta < 3.0; zeta *= 1.05)
    for (const double mass : {0.1, 0.14, 0.2, 0.28, 0.4})
      best = std::max(best, worst_limit_at_wall(scenario, zeta, mass));
  EXPECT_NEAR(2.0 * law.choice->stiffness / best, 1.0, kWithin);
}

TEST(Tune, KeepsLimitsAndNamesTheBindingConstraint) {
  TuneQuestion asked = question("tap_wall", {});
  asked.threads = 2;
  asked.damping_ratio = {0.1, 0.3};
  const TunedLaw free = tuned_law(asked, "shaped_stiffness");
  ASSERT_TRUE(free.choice) << free.why;
  EXPECT_LE(free.runs, kMaxTuneRuns + 1000);
  const double buzz = free.choice->metrics.at("force_rms_above_30Hz_N");
  asked.limits["force_rms_above_30Hz_N"].max = 0.7 * buzz;
  const TunedLaw quiet = tuned_law(asked, "shaped_stiffness");
  ASSERT_TRUE(quiet.choice) << quiet.why;
  EXPECT_LE(quiet.choice->largest.at("force_rms_above_30Hz_N").value, 0.7 * buzz);
  EXPECT_LE(quiet.choice->stiffness, 1.01 * free.choice->stiffness);
  // The metrics reported for the choice are the metrics of a run.
  const CheckedScenario chosen = checked(load_scenario(asked.scenario, quiet.overrides));
  const Result run = run_scenario(chosen, std::nullopt, false, nullptr, Diagnose::everything);
  for (const auto& [name, value] : quiet.choice->metrics) EXPECT_EQ(number_of(run.metrics, name), value) << name;
  // So are the findings of the diagnosis, none of which condemns the choice.
  EXPECT_EQ(names_of(quiet.findings, &Diagnosed::rule), names_of(*run.diagnosis, &Diagnosed::rule));
  for (const Diagnosed& found : quiet.findings) EXPECT_EQ(rule_kind(found.rule), RuleKind::hint) << found.rule;
}

/// Checks that every trial of an experiment counts. The damping of the second hand is above 2 M / dt, where leapfrog is
/// unstable, so that its trial diverges at every K, which no permitted vibration allows.
TEST(Tune, RecommendsNothingIfATrialOfTheExperimentDiverges) {
  const auto tuned = [](const std::string& subjects) {
    TuneQuestion asked =
        question("vertical_peg_in_hole_shaped_stiffness",
                 {"hand.subjects=[" + subjects + "]", "hand.trials=1", "hand.task.places_m=[[0,0,-0.005]]",
                  R"(device={"type":"ideal"})", "time.duration_s=0.5"});
    asked.threads = 2;
    asked.damping_ratio = {0.7, 0.75};
    asked.allow_vibration = true;
    return tuned_law(asked, "shaped_stiffness");
  };
  const std::string gentle = R"({"press_N":1})", rigid = R"({"press_N":1,"damping_N_s_per_m":500})";
  EXPECT_TRUE(tuned(gentle + "," + gentle).choice);
  EXPECT_FALSE(tuned(gentle + "," + rigid).choice);
}

/// Checks that the search accepts a stiffness at which a hand is too soft to pull the tool on. A trial with the
/// stiffness K also makes runs with the stiffness 2 K. If K is at least 33,000 N/m, a hand of 100 N/m cannot pull the
/// tool on in the run with 2 K. Only settings with such a K keep both bounds.
TEST(Tune, IsNotBoundByAHandThatIsTooSoftToPullTheToolOn) {
  TuneQuestion asked = question("drag_molar", {});
  asked.threads = 2;
  asked.limits["inside_max_m"].max = 8e-5;
  asked.limits["force_rms_above_30Hz_N"].max = 0.06;
  const TunedLaw law = tuned_law(asked, "shaped_stiffness");
  ASSERT_TRUE(law.choice) << law.why;
  EXPECT_GT(law.choice->stiffness, 36000.0);
}

/// Returns the question of a bundled scene in which the force jumps at single values of K far below the largest
/// feasible K.
TuneQuestion device_at_wall() {
  TuneQuestion asked = question("device_at_wall", {});
  asked.threads = 2;
  return asked;
}

/// Checks that the search goes on above a stiffness at which the force jumps: in the whole range of zeta, it finds a K
/// that is at least as large as in a part of the range. `kTuneResolution` is the width at which a search for K stops.
TEST(Tune, FindsInAWideRangeWhatItFindsInANarrowRange) {
  TuneQuestion narrow = device_at_wall();
  narrow.damping_ratio = {0.5, 1.0};
  const TunedLaw part = tuned_law(narrow, "shaped_stiffness"), whole = tuned_law(device_at_wall(), "shaped_stiffness");
  ASSERT_TRUE(part.choice && whole.choice);
  EXPECT_GE(whole.choice->stiffness, (1.0 - kTuneResolution) * part.choice->stiffness);
}

/// Checks that the scene is stable with low vibration slightly below the choice: in runs at the stiffnesses of the
/// verification, and in all trials of the search between them. Without this verification, the choice would be 1643
/// kN/m, and the force would jump at 0.95 times this stiffness.
TEST(Tune, RecommendsNoStiffnessBesideAVibration) {
  const TuneQuestion asked = device_at_wall();
  const TunedLaw law = tuned_law(asked, "shaped_stiffness");
  ASSERT_TRUE(law.choice) << law.why;
  const Range nearby{kLowVibrationFrom * law.choice->stiffness, law.choice->stiffness, true};
  std::vector<double> parameters = parameters_between(0.0, 1.0, kLowVibrationSamples);
  parameters.push_back(1.0);
  for (const double t : parameters) {
    std::vector<std::string> overrides = law.overrides;
    overrides.push_back(fmt::format("{}={}", kStiffnessPath, nearby.value_at(t)));
    const CheckedScenario scene = checked(load_scenario(asked.scenario, overrides));
    const auto shell = make_shell(scene.scenario(), scene.files());
    EXPECT_TRUE(is_stable(stability_of(scene, shell, rule_of(scene.scenario())).verdict)) << nearby.value_at(t);
    for (const Diagnosed& number : run_with_shell(scene, shell, Diagnose::low_vibration).low_vibration)
      EXPECT_LE(number.value, number.threshold) << nearby.value_at(t) << " N/m: " << number.says;
  }
  for (const TuneTrial& trial : law.trials) {
    if (!(trial.setting == law.choice->setting)) continue;
    if (trial.stiffness < nearby.from || trial.stiffness > nearby.to) continue;
    for (const Diagnosed& rule : diagnosis_rules(RuleKind::low_vibration)) {
      const auto found = trial.largest.find(rule.rule);
      if (found == trial.largest.end()) continue;
      EXPECT_LE(found->second.value, rule.threshold) << trial.stiffness << " N/m: " << found->second.text;
    }
  }
}

TEST(Tune, NamesTheLimitToRelaxAndByHowMuch) {
  TuneQuestion asked = question("tap_wall", {});
  asked.threads = 2;
  asked.damping_ratio = {0.1, 0.3};
  asked.limits["inside_max_m"].max = 1e-6;
  const TunedLaw none = tuned_law(asked, "shaped_stiffness");
  EXPECT_FALSE(none.choice);
  EXPECT_EQ(none.binding, "inside_max_m");
  double needed = 0.0;
  ASSERT_EQ(std::sscanf(none.relax.c_str(), "relax inside_max_m to %lf (now 1e-06)", &needed), 1) << none.relax;
  EXPECT_GT(needed, 1e-6);
  asked.limits["inside_max_m"].max = needed;
  EXPECT_TRUE(tuned_law(asked, "shaped_stiffness").choice) << none.relax;
}

/// Returns a small question: a hand holds a handle and presses the tool into a plane. The variants "hands" add hands of
/// 100 and 1000 N/m.
TuneQuestion pressed_plane() {
  TuneQuestion asked = question("impedance_at_wall", {"time.duration_s=0.6"});
  asked.threads = 2;
  asked.damping_ratio = {0.3, 0.6};
  return asked;
}

/// Returns the bounds of a text such as "relax inside_max_m to 0.0003:0.002 (now 0.0003:0.001)" for one metric.
MetricBound printed_bound(const std::string& relax, const std::string& metric) {
  MetricBound bound;
  double first = 0.0, second = 0.0;
  const std::string text = relax.substr(std::min(relax.size(), relax.find("relax " + metric)));
  const int count = std::sscanf(text.c_str(), ("relax " + metric + " to %lf:%lf").c_str(), &first, &second);
  if (count == 2) bound.min = first;
  if (count >= 1) bound.max = count == 2 ? second : first;
  return bound;
}

/// Checks that questions that differ only in their bound agree: the relaxation of each infeasible question has the same
/// value, a question with this value is feasible, and a question with a bound that is stricter by 10 % is infeasible.
TEST(Tune, NamesTheSmallestRelaxationForEveryStricterBound) {
  for (const auto& [metric, bounds] : {std::pair<const char*, std::vector<double>>{"inside_max_m", {1e-6, 5e-5}},
                                       {"force_rms_above_30Hz_N", {1e-6, 1e-4}}}) {
    TuneQuestion asked = pressed_plane();
    std::vector<double> relaxed;
    for (const double bound : bounds) {
      asked.limits[metric].max = bound;
      const TunedLaw none = tuned_law(asked, "shaped_stiffness");
      ASSERT_FALSE(none.choice) << metric << " <= " << bound;
      EXPECT_EQ(none.binding, metric);
      relaxed.push_back(printed_bound(none.relax, metric).max.value_or(0.0));
      EXPECT_GT(relaxed.back(), bound) << none.relax;
    }
    EXPECT_EQ(relaxed[0], relaxed[1]) << metric;
    asked.limits[metric].max = relaxed[0];
    EXPECT_TRUE(tuned_law(asked, "shaped_stiffness").choice) << metric << " <= " << relaxed[0];
    asked.limits[metric].max = 0.9 * relaxed[0];
    EXPECT_FALSE(tuned_law(asked, "shaped_stiffness").choice) << metric << " <= " << 0.9 * relaxed[0];
  }
}

/// Checks a range that the runs of the hands cannot keep: a hand of 100 N/m presses the tool less deep into the plane
/// than the other hands. The named relaxation is feasible, and every run of its choice keeps the range.
TEST(Tune, KeepsBothEndsOfARangeInEveryRun) {
  const std::string metric = "inside_settled_m";
  TuneQuestion asked = pressed_plane();
  asked.limits[metric] = {3e-4, 4e-4};
  const TunedLaw none = tuned_law(asked, "shaped_stiffness");
  ASSERT_FALSE(none.choice);
  EXPECT_EQ(none.binding, metric);
  EXPECT_NE(none.why.find("below the minimum 0.0003"), std::string::npos) << none.why;
  const MetricBound bound = printed_bound(none.relax, metric);
  ASSERT_TRUE(bound.min && bound.max) << none.relax;
  EXPECT_LT(*bound.min, 3e-4);
  EXPECT_EQ(*bound.max, 4e-4);
  asked.limits[metric] = bound;
  const TunedLaw law = tuned_law(asked, "shaped_stiffness");
  ASSERT_TRUE(law.choice) << none.relax;
  EXPECT_GE(law.choice->kept({metric, false}), bound.min);
  EXPECT_LE(law.choice->kept({metric, true}), bound.max);
  EXPECT_LT(law.choice->smallest.at(metric).value, law.choice->metrics.at(metric));
  EXPECT_FALSE(law.binding.empty());
  EXPECT_FALSE(law.why.empty());
}

/// Returns true if a grid of K and zeta has a trial that keeps all constraints.
bool grid_is_feasible(const TuneQuestion& asked, const std::string& algorithm) {
  Trials trials(asked, algorithm);
  const Range stiffnesses = trials.ranges().stiffness, zetas = *trials.ranges().damping_ratio;
  for (int i = 0; i <= 4; ++i)
    for (double K = stiffnesses.from; K < stiffnesses.to / asked.margin; K *= 1.4)
      if (trials.feasible({zetas.value_at(i / 4.0), std::nullopt, ""}, K)) return true;
  return false;
}

/// Checks that a looser bound never makes a question infeasible, and that `tune` finds a setting if a grid has a
/// feasible setting.
TEST(Tune, IsFeasibleIfAGridIsAndForEveryLooserBound) {
  struct Bounds {
    const char* scene;
    std::vector<double> depths, vibrations;  // from tight to loose bounds
  };
  for (const Bounds& bounds :
       {Bounds{"impedance_at_wall", {1e-4, 4e-4}, {0.002, 0.02}}, {"tap_wall", {1e-4, 6e-4}, {0.01, 0.1}}}) {
    std::vector<std::vector<bool>> feasible(bounds.depths.size());
    for (std::size_t i = 0; i < bounds.depths.size(); ++i) {
      for (const double vibration : bounds.vibrations) {
        TuneQuestion asked = question(bounds.scene, {"time.duration_s=0.6"});
        asked.threads = 2;
        asked.damping_ratio = {0.1, 0.6};
        asked.limits["inside_max_m"].max = bounds.depths[i];
        asked.limits["force_rms_above_30Hz_N"].max = vibration;
        const TunedLaw law = tuned_law(asked, "shaped_stiffness");
        feasible[i].push_back(law.choice.has_value());
        if (!law.choice) {
          EXPECT_FALSE(grid_is_feasible(asked, "shaped_stiffness")) << bounds.depths[i] << " m, " << vibration << " N";
        }
        const std::size_t j = feasible[i].size() - 1;
        EXPECT_LE(feasible[i > 0 ? i - 1 : i][j], feasible[i][j]) << bounds.scene;
        EXPECT_LE(feasible[i][j > 0 ? j - 1 : j], feasible[i][j]) << bounds.scene;
      }
    }
  }
}

/// Checks a handle that dry friction holds. The target of the hand moves 4.5 mm away from the handle, so that a hand of
/// 100 N/m pulls with at most 0.45 N. The dry friction is 0.8 N, so with this hand the tool never touches the wall.
TEST(Tune, NamesTheRunThatFailsAndTheOptionThatLeavesItOut) {
  TuneQuestion asked = question("impedance_at_wall", {"device.coulomb_N=0.8"});
  asked.threads = 2;
  asked.damping_ratio = {0.1, 0.3};
  const TunedLaw none = tuned_law(asked, "shaped_stiffness");
  ASSERT_FALSE(none.choice);
  EXPECT_EQ(none.binding, "settled");
  EXPECT_TRUE(none.why.starts_with("at K: no_contact (a hand of 0.1 kg and 100 N/m), for example with K = "))
      << none.why;
  EXPECT_EQ(none.relax, "--family seeds leaves out a hand of 0.1 kg and 100 N/m");
  asked.families = {"seeds"};
  EXPECT_TRUE(tuned_law(asked, "shaped_stiffness").choice);
}

/// Checks a handle with a long delay and a slow filter. Most trials fail because the tool passes through a soft
/// surface, but with a larger K, only the loop without a hand is unstable: --family seeds does not require this loop.
TEST(Tune, NamesTheOtherHandsBeforeTrialsThatFailEarlier) {
  TuneQuestion asked = question("tap_wall", {R"(device={"type":"impedance","handle_mass_kg":0.1,"delay_s":0.01,
                                               "velocity_filter":{"type":"low_pass","cutoff_Hz":20,"order":2}})"});
  asked.threads = 2;
  const TunedLaw none = tuned_law(asked, "shaped_stiffness");
  ASSERT_FALSE(none.choice);
  EXPECT_EQ(none.relax, "--family seeds leaves out the loop without a hand");
  asked.families = {"seeds"};
  EXPECT_TRUE(tuned_law(asked, "shaped_stiffness").choice);
}

/// Checks a device with a force resolution of 1 kN, which renders nothing of the law's force of a few newtons.
TEST(Tune, RecommendsNoStiffnessThatRendersNothing) {
  TuneQuestion asked = question("impedance_at_wall", {"device.force_step_N=1000"});
  const std::string law = "shaped_stiffness";  // must outlive the trials
  Trials trials(asked, law);
  const TuneTrial& trial = trials.trial_at({}, 1000.0);
  ASSERT_FALSE(trial.feasible());
  if (trial.settled) {
    EXPECT_EQ(trial.binding, "no_force");
  }
}

/// Checks that partial evaluations give the results of complete evaluations. The two bounds are chosen so that some
/// trials violate no bound, one of the bounds or both.
TEST(Tune, EvaluatesATrialOnlyAsFarAsAnAnswerNeedsIt) {
  TuneQuestion asked = question("tap_wall", {"time.duration_s=0.6"});
  asked.threads = 2;
  asked.families = {};
  asked.limits["inside_max_m"].max = 9e-4;
  asked.limits["force_rms_above_30Hz_N"].max = 0.1;
  const std::string law = "shaped_stiffness";  // must outlive the trials
  Trials needed(asked, law), complete(asked, law);
  std::size_t feasible = 0, soft = 0;
  for (const double zeta : {0.3, 0.6}) {
    for (const double K : {2.5e3, 3e3, 4e3, 6e3, 1.2e4, 2.5e4, 5e4}) {
      const TuneSetting setting{zeta, std::nullopt, ""};
      const TuneTrial& trial = complete.evaluated(complete.trial_at(setting, K), Need::excess);
      EXPECT_EQ(needed.feasible(setting, K), trial.feasible()) << zeta << ", " << K;
      EXPECT_EQ(needed.is_too_soft(setting, K), !trial.feasible() && trial.too_soft) << zeta << ", " << K;
      feasible += trial.feasible();
      soft += !trial.feasible() && trial.too_soft;
    }
  }
  EXPECT_LT(needed.runs(), complete.runs());
  EXPECT_GT(feasible, 0u);
  EXPECT_GT(soft, 0u);
  // Partially evaluated trials have the same order by excess as completely evaluated trials.
  const std::vector<const TuneTrial*> nearest = needed.nearest(2), known = complete.nearest(2);
  ASSERT_EQ(nearest.size(), known.size());
  for (std::size_t i = 0; i < nearest.size(); ++i) {
    EXPECT_EQ(nearest[i]->stiffness, known[i]->stiffness);
    EXPECT_EQ(needed.excess(*nearest[i]), complete.excess(*known[i]));
  }
}

/// Checks that trials and numbers of runs depend neither on the number of threads nor on runs made ahead.
TEST(Tune, FindsTheSameOnAnyNumberOfThreads) {
  const std::vector<double> stiffnesses = {2.5e3, 4e3, 6e3, 2.5e4, 5e4, 2e5, 2e6, 2e6};
  const TuneSetting setting{0.3, std::nullopt, ""};
  const std::string law = "shaped_stiffness";
  const auto found = [&](unsigned threads, bool ahead) {
    TuneQuestion asked = question("tap_wall", {"time.duration_s=0.6"});
    asked.threads = threads;
    asked.limits["force_rms_above_30Hz_N"].max = 0.1;
    Trials trials(asked, law);
    if (ahead) trials.run_ahead(setting, stiffnesses);
    std::string text;
    for (const double K : stiffnesses) {
      const TuneTrial& trial = trials.trial_at(setting, K);
      text += fmt::format("{}: {} {} {}\n", K, trial.binding, trial.why, trial.lambda_max);
      for (const auto& [name, value] : trial.metrics) text += fmt::format("  {} {}\n", name, value);
    }
    return std::pair(text, trials.runs());
  };
  const auto [one, runs] = found(1, false);
  EXPECT_NE(one.find("settled"), std::string::npos) << "a trial fails at K";
  EXPECT_NE(one.find("margin"), std::string::npos) << "a trial fails at the margin times K";
  EXPECT_EQ(found(3, false), std::pair(one, runs));
  EXPECT_EQ(found(1, true).first, one);
  EXPECT_EQ(found(1, true), found(3, true));
}

/// Checks a run that friction makes unstable. With mu_f = 340 s/m, explicit integration of friction is unstable above
/// 1.2 N. The hand presses with up to 2 N, and with less at the end of the run, where the linear loop is stable.
TEST(Tune, RecommendsNoRunThatIsAnArtefactOfFriction) {
  TuneQuestion asked = question("poke_plane", {"rendering.friction.mu_f_s_per_m=340"});
  const std::string law = "shaped_stiffness";  // must outlive the trials
  Trials trials(asked, law);
  const TuneTrial& trial = trials.trial_at({}, 20000.0);
  EXPECT_EQ(trial.binding, "friction") << trial.why;
}

}  // namespace
}  // namespace hapbench::tune_test
