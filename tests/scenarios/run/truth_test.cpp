#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <tuple>

#include "results/observe/inside_observer.hpp"
#include "results/observe/metrics.hpp"
#include "results/summary/summary.hpp"
#include "scenarios/analysis/stability/run_stability.hpp"
#include "scenarios/input/bundled_scenarios.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/checked_scenario.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/run/run_tables.hpp"
#include "scenarios/scene/environments.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "scenarios/scene/tools.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/mesh_texts.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/scale.hpp"

/// Tests difficult scenes: soft, thin, inverted, open, tiny, huge, stuck or too fast. The true result of each scene
/// follows from its geometry. Outcome, depth and the verdict on stability must agree with the true result.
namespace hapbench::truth_test {
namespace {

namespace fs = std::filesystem;

constexpr double kRadius = 0.0005;
constexpr double kUnknown = -1.0;

/// Returns the true depth [m] of the tool with its tip centre at p [m]; kUnknown if the depth is not defined.
using Truth = std::function<double(const Vec3& p)>;

/// Depth of a ball in the plane z = 0. The shank points away from the plane.
double ball_in_plane(const Vec3& p) {
  return std::max(0.0, kRadius - p.z());
}
/// Depth of a tool in a plate that is 0.2 mm thick, below z = 0, and wider than the tool's path. The tool extends
/// vertically from the lowest point of its ball to the end of its shank. The deepest point of the tool is its point
/// nearest to the middle plane of the plate. The depth is the distance of this point from the nearer face.
double ball_in_plate(const Vec3& p) {
  const double neck = 0.3 * 2.0 * kRadius, end = std::sqrt(kRadius * kRadius - neck * neck) + 20.0 * neck;
  const double height = std::clamp(-0.0001, p.z() - kRadius, p.z() + end);
  return std::max(0.0, std::min(-height, height + 0.0002));
}

struct Case {
  const char* name;
  std::vector<std::string> changes;  ///< overrides path=value of a ball pressed onto a plane
  std::vector<Outcome> outcomes;     ///< outcomes of which each is true
  Truth depth = ball_in_plane;
  double tolerance = 1e-9;  ///< tolerance of the depth [m]
};

void write(const std::string& name, const TriangleSoup& soup) {
  test::write_plainly(fs::path(testing::TempDir()) / name, test::off_text(soup));
}

TriangleSoup sheet() {
  return test::sheet(40, 40, [](int i, int j) { return Vec3(0.0001 * i - 0.002, 0.0001 * j - 0.002, 0.0); });
}

Json base() {
  return Json::parse(R"({
    "time": {"step_s": 0.0005, "steps": 600},
    "environment": {"type": "plane", "size_m": 0.01, "spacing_m": 0.0001},
    "tool": {"type": "bur", "family": "ball", "diameter_m": 0.001},
    "initial": {"position_m": [0, 0, 0.0006]},
    "motion": {"orientation": {"up": [0, 0, 1]}},
    "hand": {"type": "force", "z_N": -1},
    "rendering": {"algorithm": "shaped_stiffness", "depth_model": "surface_normal", "reduction": null,
                  "stiffness_N_per_m": 20000, "damping_ratio": 0.7, "mass_kg": 0.1},
    "record": {"inside": true}
  })");
}

LoadedScenario scene(const Case& c) {
  Json json = base();
  for (const std::string& change : c.changes) {
    const std::size_t split = change.find('=');
    std::string pointer = "/" + change.substr(0, split);
    std::replace(pointer.begin(), pointer.end(), '.', '/');
    json[Json::json_pointer(pointer)] = Json::parse(change.substr(split + 1));
  }
  return read_scenario(json, testing::TempDir());
}

const std::string kPlate = R"(environment={"type":"mesh","file":"plate.off","scale":1,"spacing_m":0.0001})";
const std::string kCube = R"(environment={"type":"mesh","file":"cube.off","scale":1,"spacing_m":0.0001})";
const std::string kSheet = R"(environment={"type":"mesh","file":"sheet.off","scale":1})";
const std::string kInverted = R"(environment={"type":"mesh","file":"inverted.off","scale":1})";
const std::string kPoints = R"(environment={"type":"point_shell","file":"points.csv"})";
const std::string kCone =
    R"(environment={"type":"conical_hole","half_angle_rad":0.5,"depth_m":0.003,"spacing_m":0.00005})";
const std::string kBlock =
    R"(environment={"type":"block_with_hole","size_m":[0.006,0.006,0.004],"hole_diameter_m":0.002,)"
    R"("hole_depth_m":0.002,"grid_m":0.0001})";
const std::string kFlat = R"(tool={"type":"cylinder","diameter_m":0.001,"length_m":0.01})";
const std::string kDrag =
    R"(hand={"type":"drag","force_N":1,"direction":[1,0,0],"speed_m_per_s":0.01,"normal_damping_N_s_per_m":50})";

const std::string kNoHand = R"(hand={"type":"none"})";
const std::string kLed = R"(motion.position={"type":"prescribed","x_m":0,"y_m":0,"z_m":0})";
/// Returns the override with the heights that a script gives over time, for use after kLed.
std::string led(const std::string& points) {
  return R"(motion.position.z_m={"type":"waypoints","points":)" + points + "}";
}
/// Returns the override with a hand's spring whose target follows points over time.
std::string spring(const std::string& x, const std::string& z) {
  const auto waypoints = [](const std::string& points) { return R"({"type":"waypoints","points":)" + points + "}"; };
  return R"(hand={"type":"impedance","stiffness_N_per_m":300,"damping_N_s_per_m":6,"target":{"y_m":0,"x_m":)" +
         waypoints(x) + R"(,"z_m":)" + waypoints(z) + "}}";
}

const std::string kSubject =
    R"(hand={"type":"tracking","task":{"places_m":[[0.0015,0,0],[-0.0015,0,0]],"targets_per_place":1}})";

double flat_in_plane(const Vec3& p) {
  return std::max(0.0, -p.z());
}

/// Depth of a ball in the cone about z with its apex at z = -3 mm and a half angle of 0.5 rad. The wall's normal is
/// inclined by the half angle from the horizontal.
double ball_in_cone(const Vec3& p) {
  const double rho = p.head<2>().norm(), z = p.z() + 0.003;
  return std::max(0.0, kRadius - (std::sin(0.5) * z - std::cos(0.5) * rho));
}

/// Depth beside the border of the plane, where no inside is defined.
double beside(const Vec3&) {
  return kUnknown;
}

const std::vector<Outcome> kThrough = {Outcome::went_through}, kFine = {Outcome::completes},
                           kMissed = {Outcome::no_contact};

std::vector<Case> cases() {
  const std::string soft = "rendering.stiffness_N_per_m=200";
  std::vector<Case> all = {
      {"firm", {}, kFine},
      {"soft", {soft}, kThrough},
      {"a little too soft", {"rendering.stiffness_N_per_m=1500"}, kThrough},
      {"no stiffness to speak of", {"rendering.stiffness_N_per_m=0.001"}, kThrough},
      {"pressed too hard", {"hand.z_N=-60"}, kThrough},
      {"no hand", {R"(hand={"type":"none"})"}, kMissed},
      {"pulled away", {"hand.z_N=0.01"}, kMissed},
      {"began inside", {"initial.position_m=[0,0,-0.003]", R"(hand={"type":"none"})"}, kThrough},
      {"began inside, pulled out", {"initial.position_m=[0,0,-0.003]", "hand.z_N=1"}, kThrough},
      {"pressed in and pulled out",
       {R"(hand.z_N={"type":"waypoints","points":[[0,-60],[0.1,-60],[0.101,20],[0.3,20]]})"},
       kThrough},
      {"beside the plane", {"initial.position_m=[0.02,0,0.0006]"}, kMissed, beside},
      {"too fast", {"initial.velocity_m_per_s=[0,0,-8]"}, kThrough},
      {"flat tip", {kFlat}, kFine, flat_in_plane},
      {"flat tip, soft", {kFlat, soft}, kThrough, flat_in_plane},
      {"a drill that leans",
       {kFlat, "motion.orientation.tilt_rad=0.3", R"(motion.orientation.lean=[1,0,0])"},
       kFine,
       [](const Vec3& p) { return std::max(0.0, kRadius * std::sin(0.3) - p.z()); }},
      {"thin plate", {kPlate}, kFine, ball_in_plate, 1e-5},
      {"thin plate, soft", {kPlate, soft}, kThrough, ball_in_plate, 1e-5},
      {"thin plate, too fast to touch", {kPlate, "initial.velocity_m_per_s=[0,0,-8]"}, kThrough, ball_in_plate, 1e-5},
      {"cube", {kCube}, kFine},
      {"cube, soft", {kCube, soft, "time.steps=150"}, kThrough, nullptr},
      {"open sheet", {kSheet}, kFine},
      {"open sheet, soft", {kSheet, soft}, kThrough},
      {"open sheet, past its edge", {kSheet, "initial.position_m=[0.01,0,0.0006]"}, kMissed, beside},
      {"open sheet, inside out", {kInverted}, kThrough, nullptr},
      {"points", {kPoints}, kFine},
      {"points, soft", {kPoints, soft}, kThrough},
      {"points, past their edge", {kPoints, "initial.position_m=[0.01,0,0.0006]"}, kMissed, beside},
      {"cone", {kCone, "initial.position_m=[0,0,-0.0015]"}, kFine, ball_in_cone, 1e-5},
      {"cone, soft", {kCone, "initial.position_m=[0,0,-0.0015]", "rendering.stiffness_N_per_m=50"}, kThrough, nullptr},
      {"block", {kBlock, "initial.position_m=[0.002,0,0.0006]"}, kFine},
      {"block, soft", {kBlock, "initial.position_m=[0.002,0,0.0006]", soft, "time.steps=200"}, kThrough, nullptr},
      {"dragged", {kDrag}, kFine},
      {"dragged, soft", {kDrag, soft}, kThrough, nullptr},
      {"dragged and held by friction",
       {kDrag, "hand.speed_m_per_s=0.02", "initial.position_m=[-0.003,0,0.003]", "time.steps=1000",
        R"(rendering.friction={"mu_s_N_s_per_m":0,"mu_f_s_per_m":1e6})", R"(integrator={"type":"implicit_euler"})"},
       {Outcome::stuck, Outcome::not_dragged},
       nullptr},
      {"led deep into the plane", {kLed, kNoHand, led("[[0,0.0006],[0.3,-0.001]]")}, kThrough},
      {"led in and out again", {kLed, kNoHand, led("[[0,0.0006],[0.15,-0.0006],[0.3,0.0006]]")}, kThrough},
      {"led to touch", {kLed, kNoHand, led("[[0,0.0006],[0.3,0.0002]]")}, kFine},
      {"led past the plane",
       {kLed, kNoHand, "motion.position.x_m=0.02", led("[[0,0.0006],[0.3,-0.001]]")},
       kMissed,
       beside},
      {"led through a thin plate",
       {kPlate, kLed, kNoHand, led("[[0,0.0006],[0.3,-0.002]]")},
       kThrough,
       ball_in_plate,
       1e-5},
      {"led through a cube in a step",
       {kCube, kLed, kNoHand, led("[[0,0.0006],[0.1,0.0006],[0.1001,-0.02],[0.3,-0.02]]")},
       kThrough,
       nullptr},
      {"a spring that presses ever harder", {spring("[[0,0],[0.3,0]]", "[[0,0.0006],[0.3,-0.004]]")}, kFine},
      {"a spring that presses from just above",
       {spring("[[0,0],[0.3,0]]", "[[0,-0.002],[0.3,-0.004]]"), "initial.position_m=[0,0,0.00055]",
        "rendering.stiffness_N_per_m=100000"},
       kFine},
      {"a spring that presses through", {soft, spring("[[0,0],[0.3,0]]", "[[0,0.0006],[0.3,-0.004]]")}, kThrough},
      {"a spring that drags",
       {spring("[[0,-0.002],[0.05,-0.002],[0.3,0.003]]", "[[0,0.0006],[0.05,-0.002]]"),
        "initial.position_m=[-0.002,0,0.0006]"},
       kFine},
      {"a spring that drags what friction holds",
       {spring("[[0,-0.002],[0.05,-0.002],[0.3,0.003]]", "[[0,0.0006],[0.05,-0.002]]"),
        "initial.position_m=[-0.002,0,0.0006]", R"(rendering.friction={"mu_s_N_s_per_m":0,"mu_f_s_per_m":1e6})",
        R"(integrator={"type":"implicit_euler"})"},
       {Outcome::stuck}},
      {"a spring that swings what friction holds",
       {spring("[[0,0],[0.05,0],[0.15,0.003],[0.3,0]]", "[[0,0.0006],[0.05,-0.002]]"),
        R"(rendering.friction={"mu_s_N_s_per_m":0,"mu_f_s_per_m":1e6})", R"(integrator={"type":"implicit_euler"})"},
       {Outcome::stuck}},
      // The targets are 3 mm apart on a display. The spring of the subject's hand follows them.
      {"a subject who follows targets", {kSubject, "time.steps=6000"}, kFine},
      {"a subject whose tool friction holds",
       {kSubject, "time.steps=6000", R"(rendering.friction={"mu_s_N_s_per_m":0,"mu_f_s_per_m":1e6})",
        R"(integrator={"type":"implicit_euler"})"},
       {Outcome::stuck}},
      {"a spring that trembles",
       {spring("[[0,0],[0.1,0.0002],[0.2,-0.0002],[0.3,0]]", "[[0,0.0006],[0.05,-0.002]]")},
       kFine},
      {"a spring at rest", {spring("[[0,0],[0.3,0]]", "[[0,-0.002],[0.3,-0.002]]")}, kFine},
      {"through a cube in a step",
       {kCube, "initial.velocity_m_per_s=[0,0,-30]", R"(hand={"type":"none"})"},
       kThrough,
       nullptr},
      {"past a cube",
       {kCube, "initial.position_m=[0.0047,0,0.0006]", "initial.velocity_m_per_s=[0,0,-8]"},
       kMissed,
       nullptr},
      {"a short blow",
       {R"(hand.z_N={"type":"waypoints","points":[[0,-1],[0.2,-1],[0.2005,-6],[0.204,-6],[0.2045,-1]]})"},
       kFine},
      {"a short blow in a long run",
       {R"(hand.z_N={"type":"waypoints","points":[[0,-1],[1.2,-1],[1.2005,-6],[1.204,-6],[1.2045,-1]]})",
        "time.steps=6000"},
       kFine},
      {"undamped", {"rendering.damping_ratio=0"}, kFine},
      {"an inverted cone",
       {R"(tool={"type":"bur","family":"inverted_cone","diameter_m":0.001,"length_m":0.0006})"},
       kFine,
       flat_in_plane},
      {"diverges",
       {"rendering.stiffness_N_per_m=1e9"},
       {Outcome::diverges, Outcome::lost_contact, Outcome::went_through},
       nullptr},
  };
  for (const auto& [name, outcomes, push] : {std::tuple("tiny", kFine, "-0.01"), {"tiny and soft", kThrough, "-1"}}) {
    all.push_back({name,
                   {R"(environment={"type":"plane","size_m":1e-4,"spacing_m":1e-6})",
                    R"(tool={"type":"bur","family":"ball","diameter_m":1e-5})", "initial.position_m=[0,0,6e-6]",
                    std::string("hand.z_N=") + push},
                   outcomes,
                   [](const Vec3& p) { return std::max(0.0, 5e-6 - p.z()); },
                   1e-13});
  }
  for (const auto& [name, outcomes, K] : {std::tuple("huge", kFine, "2e5"), {"huge and soft", kThrough, "500"}}) {
    all.push_back({name,
                   {R"(environment={"type":"plane","size_m":10,"spacing_m":0.1})",
                    R"(tool={"type":"bur","family":"ball","diameter_m":1})", "initial.position_m=[0,0,0.51]",
                    "rendering.mass_kg=100", "hand.z_N=-2000", "time.steps=4000",
                    std::string("rendering.stiffness_N_per_m=") + K},
                   outcomes,
                   [](const Vec3& p) { return std::max(0.0, 0.5 - p.z()); },
                   1e-7});
  }
  for (const char* algorithm : {"summation", "mean", "least_squares", "proxy", "highest_depth", "exact_shaping"}) {
    const std::string chosen = std::string("rendering.algorithm=\"") + algorithm + "\"";
    all.push_back({algorithm, {chosen, "rendering.stiffness_N_per_m=1", "hand.z_N=-5"}, kThrough});
  }
  return all;
}

class ScenesMadeToFool : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    TriangleSoup plate = test::cube(1.0), cube = test::cube(0.004, {0.0, 0.0, -0.004});
    for (Vec3& v : plate.vertices) v = {0.004 * v.x(), 0.004 * v.y(), 0.0001 * v.z() - 0.0001};
    write("plate.off", plate);
    write("gap.off", test::together(test::cube(0.002, {-0.003, 0.0, -0.002}), test::cube(0.002, {0.003, 0.0, -0.002})));
    write("cube.off", cube);
    const TriangleSoup flat = sheet();
    const auto [a, b, c] = flat.triangles[0];
    const bool up = (flat.vertices[b] - flat.vertices[a]).cross(flat.vertices[c] - flat.vertices[a]).z() > 0.0;
    write("sheet.off", up ? flat : test::reversed(flat));
    write("inverted.off", up ? test::reversed(flat) : flat);
    std::ofstream points(fs::path(testing::TempDir()) / "points.csv");
    points << "x_m,y_m,z_m,nx,ny,nz\n";
    for (const Vec3& v : flat.vertices) points << v.x() << "," << v.y() << ",0,0,0,1\n";
  }
};

/// Checks the depth in each recorded step, and the largest depth of the run.
void expect_true_depths(const Case& c, const MemoryTable& rows, std::optional<double> max) {
  const std::size_t columns = rows.columns().size();
  std::size_t inside = 0;
  while (inside < columns && std::string(rows.columns()[inside].name) != "inside_m") ++inside;
  ASSERT_LT(inside, columns);
  double deepest = 0.0;
  for (std::size_t i = 0; i < rows.rows(); ++i) {
    const double* row = rows.numbers().data() + i * columns;
    const double truth = c.depth({row[2], row[3], row[4]}), recorded = row[inside];
    if (truth == kUnknown) {
      EXPECT_TRUE(std::isnan(recorded)) << "row " << i << ": " << recorded;
      continue;
    }
    ASSERT_NEAR(recorded, truth, c.tolerance) << "row " << i << " at z = " << row[4];
    deepest = std::max(deepest, truth);
  }
  if (c.depth({0.0, 0.0, 0.0}) != kUnknown) {
    EXPECT_NEAR(max.value_or(kUnknown), deepest, c.tolerance);
  }
}

/// Returns the depths of the tool in a run: from every `every`-th step or, if `every` is 0, from the steps that a run
/// without a record evaluates.
InsideDepths depths_of(const LoadedScenario& loaded, std::uint64_t every) {
  const Scenario& scenario = loaded.scenario;
  SimulationParts parts = assemble(scenario, loaded.files, make_shell(scenario, loaded.files), {});
  const SimulationConfig config = simulation_config(scenario);
  MetricsObserver metrics(scenario.time.step, {.settling = scenario.metrics});
  InsideObserver inside(parts.tool, make_solid(scenario, loaded.files), &metrics, every, config.steps);
  Simulation(config, std::move(parts), {&metrics, &inside}).run();
  return inside.depths();
}

/// Checks that a run without a record finds the true depths within its stated errors, although it evaluates the depth
/// in few steps. `exact` are the metrics of a run that evaluated the depth in every step.
void expect_seen_without_record(const LoadedScenario& loaded, const MetricList& exact) {
  const InsideDepths few = depths_of(loaded, 0);
  const auto max = number_of(exact, "inside_max_m"), settled = number_of(exact, "inside_settled_m");
  EXPECT_EQ(few.max.has_value(), max.has_value());
  const auto share = number_of(exact, "centre_inside_share");
  EXPECT_EQ(share.has_value(), few.rows > 0);
  if (share) {
    EXPECT_EQ(*share, static_cast<double>(few.centre_inside) / static_cast<double>(few.rows));
  }
  if (!max) return;
  EXPECT_LE(*few.max, *max + 1e-12);
  EXPECT_LE(*max, (1.0 + InsideSearch::kTolerance) * *few.max + few.max_within + 1e-12);
  if (settled && few.settled_median()) {
    EXPECT_NEAR(*few.settled_median(), *settled, 0.2 * *max);
  }
}

TEST_F(ScenesMadeToFool, GetTheirTrueOutcomeAndDepthAlsoWithoutARecord) {
  const std::vector<Case> all = cases();
  ASSERT_GE(all.size(), 60u);
  for (std::size_t i = 0; i < all.size(); i += test::sanitized(8)) {
    const Case& c = all[i];
    SCOPED_TRACE(c.name);
    const LoadedScenario loaded = scene(c);
    RunTables tables;
    const Result report = run_scenario(checked(loaded), std::nullopt, false, &tables);
    const Outcome outcome = report.end.outcome;
    EXPECT_NE(std::find(c.outcomes.begin(), c.outcomes.end(), outcome), c.outcomes.end())
        << outcome_name(outcome) << (report.warnings.empty() ? "" : ": " + report.warnings[0].text);
    EXPECT_EQ(report.unmet.empty(), outcome == Outcome::completes);
    const bool quiet = std::ranges::all_of(report.warnings, [](const Warning& w) { return w.kind == "mesh_file"; });
    EXPECT_TRUE(outcome == Outcome::diverges || quiet == (outcome == Outcome::completes));
    if (c.depth)
      expect_true_depths(c, tables.trials[0].at("trajectory.csv"), number_of(report.metrics, "inside_max_m"));
    expect_seen_without_record(loaded, report.metrics);
  }
}

/// Checks scenes in which the depth of the tool never exceeds half the thickness of the wall. Also checks a tool that
/// is dragged, leaves its path and ends deep in a gap.
TEST_F(ScenesMadeToFool, WithThinWallsOrAGapGetTheirTrueOutcome) {
  const Case cases[] = {
      {"led sideways through a plate, its tip below",
       {kPlate, kFlat, "initial.position_m=[-0.006,0,-0.002]", "time.steps=500",
        std::string{R"(hand={"type":"impedance","stiffness_N_per_m":4000,"damping_N_s_per_m":40,)"} +
            R"("target":{"y_m":0,"z_m":-0.002,"x_m":{"type":"waypoints","points":[[0,-0.006],[0.25,0.006]]}}})"},
       kThrough},
      {"turned through a plate",
       {kPlate, kFlat, kNoHand, R"(motion.position={"type":"prescribed","x_m":-0.0048,"y_m":0,"z_m":-0.001})",
        std::string{R"(motion.orientation={"up":[0,0,1],"lean":[1,0,0],)"} +
            R"("tilt_rad":{"type":"waypoints","points":[[0,0],[0.3,1.4]]}})"},
       kThrough},
      {"dragged into a gap",
       {R"(environment={"type":"mesh","file":"gap.off","scale":1,"spacing_m":0.0001})",
        R"(hand={"type":"drag","force_N":1,"path_m":[[-0.003,0,0],[0.004,0,0]],"speed_m_per_s":0.02,)"
        R"("normal_damping_N_s_per_m":50,"stiffness_N_per_m":300,"damping_N_s_per_m":6})",
        "initial.position_m=[-0.003,0,0.0006]", "time.steps=700"},
       {Outcome::stuck}},
  };
  for (Case c : cases) {
    SCOPED_TRACE(c.name);
    c.changes.emplace_back("record.inside=false");
    const LoadedScenario loaded = scene(c);
    const Outcome outcome = run_scenario(checked(loaded), std::nullopt, false).end.outcome;
    EXPECT_EQ(outcome, c.outcomes[0]) << outcome_name(outcome);
    if (position_is_free(loaded.scenario.motion)) {
      EXPECT_FALSE(is_stable(stability_of(checked(loaded), make_shell(loaded.scenario, loaded.files)).verdict));
    }
  }
}

/// Checks a drill that rotates in a hole. The edge of the drill is in the wall by about a fiftieth of the drill's
/// width. A coarser search would miss this depth.
TEST(SettledDepth, OfEveryRowIsKnownToTheTolerance) {
  const std::vector<std::string> changes = {"time.steps=400",
                                            "expect={}",
                                            "rendering.local_average=false",
                                            "motion.orientation.tilt_rad=0.02",
                                            "hand.target.x_m.amplitude=0.00126",
                                            "hand.target.y_m.amplitude=0.00126"};
  const LoadedScenario loaded = load_scenario(find_scenario("task3_spin_signed_distance"), changes);
  const InsideDepths few = depths_of(loaded, 0), all = depths_of(loaded, 1);
  const double half_width = make_tool(loaded.scenario, loaded.files)->half_width();
  const double smallest = *std::min_element(all.settled.begin(), all.settled.end());
  ASSERT_GT(smallest, 1.5 * InsideSearch::kTolerance * half_width);
  EXPECT_GE(*std::min_element(few.settled.begin(), few.settled.end()),
            smallest - InsideSearch::kTolerance * (smallest + half_width));
  EXPECT_EQ(few.settled_within, InsideSearch::kTolerance * half_width);
}

/// Checks a drill that is dragged over a molar. The drill is about equally deep in nearly all steps, so the search for
/// the largest depth cannot exclude most steps early.
TEST(LargestDepth, OfALongPathHasAnErrorBelowItself) {
  for (const char* law : {"summation", "proxy"}) {
    SCOPED_TRACE(law);
    const std::vector<std::string> changes = {std::string("rendering.algorithm=") + law};
    const LoadedScenario loaded = load_scenario(find_scenario("drag_molar"), changes);
    const InsideDepths few = depths_of(loaded, 0), all = depths_of(loaded, 1);
    ASSERT_TRUE(few.max && all.max);
    EXPECT_LT(few.max_within, *few.max);
    EXPECT_LE(*few.max, all.max_bound() + all.max_within);
    EXPECT_GE(few.max_bound() + few.max_within, *all.max);
  }
}

TEST_F(ScenesMadeToFool, AreNotStable) {
  const std::vector<Case> all = cases();
  for (std::size_t i = 0; i < all.size(); i += test::sanitized(8)) {
    const Case& c = all[i];
    SCOPED_TRACE(c.name);
    const LoadedScenario loaded = scene(c);
    if (!position_is_free(loaded.scenario.motion)) continue;
    const RunVerdict verdict = stability_of(checked(loaded), make_shell(loaded.scenario, loaded.files)).verdict;
    const bool fine = std::find(c.outcomes.begin(), c.outcomes.end(), Outcome::completes) != c.outcomes.end();
    EXPECT_TRUE(fine || !is_stable(verdict)) << run_verdict_name(verdict);
    EXPECT_TRUE(!fine || is_stable(verdict) || verdict == RunVerdict::vibrating) << run_verdict_name(verdict);
  }
}

}  // namespace
}  // namespace hapbench::truth_test
