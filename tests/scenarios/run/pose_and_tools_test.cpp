#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "algorithms/registry.hpp"
#include "scenarios/run/assemble.hpp"
#include "scenarios/run/checked_scenario.hpp"
#include "scenarios/run/run_scenario.hpp"
#include "scenarios/run/run_tables.hpp"
#include "scenarios/run/scene_checks.hpp"
#include "scenarios/run/scene_warnings.hpp"
#include "scenarios/scene/environments.hpp"
#include "scenarios/scene/load_scenario.hpp"
#include "scenarios/scene/tools.hpp"
#include "sim/mesh/marching_cubes.hpp"
#include "sim/tool/mesh_tool.hpp"
#include "tests/results/files.hpp"
#include "tests/scenarios/support/scenarios.hpp"

namespace hapbench::pose_and_tools_test {
namespace {

using test::lines_of;
using test::read_file;
using test::TemporaryDirectory;

// Tests record.pose, record.torque and a scripted roll, through the files that a run writes.

/// A table that a run recorded, by column names.
struct Table {
  std::size_t rows() const { return table.rows(); }
  double number(std::size_t row, std::string_view name) const {
    const auto at = std::ranges::find(table.columns(), name, &Column::name) - table.columns().begin();
    return table.numbers()[row * table.columns().size() + static_cast<std::size_t>(at)];
  }
  Vec3 vector(std::size_t row, const std::array<const char*, 3>& names) const {
    return {number(row, names[0]), number(row, names[1]), number(row, names[2])};
  }

  const MemoryTable& table;
};

struct Surface {
  const char* environment;
  double height;  ///< initial height of the tip [m]
};
constexpr Surface kPlane = {R"({"type": "plane", "size_m": 0.004, "spacing_m": 0.0002})", 0.0001};
constexpr Surface kSlot = {
    R"({"type": "slot", "gap_m": 0.0011, "depth_m": 0.005, "length_m": 0.004, "spacing_m": 0.0002})", -0.0006};

/// Returns the scenario of a drill that leans and that a script pushes into its environment.
Json pressed_drill(const Surface& surface, std::string_view algorithm) {
  Json json = Json::parse(R"({
    "time": {"step_s": 0.0005, "steps": 40},
    "motion": {
      "orientation": {"tilt_rad": {"type": "ramp", "start": 0.1, "rate_per_s": 2},
        "azimuth_rad": {"type": "ramp", "start": 0.2, "rate_per_s": 3}},
      "position": {"type": "prescribed", "x_m": 0, "y_m": 0,
        "z_m": {"type": "ramp", "start": 0.0001, "rate_per_s": -0.02}}},
    "record": {"contacts": true, "torque": true, "energy": true}})");
  json["environment"] = Json::parse(surface.environment);
  json["motion"]["position"]["z_m"]["start"] = surface.height;
  json["rendering"] = {{"algorithm", algorithm}};
  return json;
}

struct Contact {
  Vec3 position, gradient;  ///< position relative to the tip centre [m]; gradient u_i
  double depth, weight;
};

/// Returns the force of one contact for laws without weighted springs, as the documentation of SpringState defines it.
/// The forces of all contacts sum to the force of the law. Empty for other laws.
std::optional<Vec3> unweighted_share(std::string_view algorithm, const RenderingConfig& r, const Vec3& spring,
                                     std::size_t n, const Contact& c) {
  const double K = r.stiffness, K_vc = r.virtual_coupling.value_or(K);
  if (algorithm == "original_averaging" || algorithm == "highest_depth") return spring / static_cast<double>(n);
  if (algorithm == "virtual_coupling") return -K * (c.depth + c.gradient.dot(spring) / K_vc) * c.gradient;
  if (algorithm == "least_squares") return -K / r.regularisation * (c.depth + c.gradient.dot(spring) / K) * c.gradient;
  if (algorithm == "static_coupling") {
    const Vec3 s = spring / (K_vc * std::sqrt(1.0 - (spring / 30.0).squaredNorm()));
    return -K * c.weight * (c.depth + c.gradient.dot(s)) * c.gradient;
  }
  return std::nullopt;
}

/// Names of laws with weighted springs. A law that is neither here nor in unweighted_share() may define the forces of
/// its contacts itself.
constexpr std::string_view kWeighted[] = {
    "summation",         "mean",  "shaped_stiffness", "tandpasta", "exact_shaping", "continuous_normal_projection",
    "normal_projection", "proxy", "merged_shaping",   "mcneely"};

void expect_torques(std::string_view algorithm, const Surface& surface) {
  const LoadedScenario loaded = read_scenario(pressed_drill(surface, algorithm), ".");
  const RenderingConfig& rendering = loaded.scenario.rendering;
  RunTables tables;
  const Result report = run_scenario(checked(loaded), std::nullopt, false, &tables);
  const Table rows{tables.trials[0].at("trajectory.csv")}, contacts{tables.trials[0].at("contacts.csv")};
  std::size_t next = 0;
  bool is_known = std::find(std::begin(kWeighted), std::end(kWeighted), algorithm) != std::end(kWeighted);
  double sum = 0.0, largest = 0.0, in_contact = 0.0;
  for (std::size_t k = 0; k < rows.rows(); ++k) {
    const Vec3 spring = rows.vector(k, {"fspring_x_N", "fspring_y_N", "fspring_z_N"});
    Vec3 tip = rows.vector(k, {"px_m", "py_m", "pz_m"});
    // With the law `proxy`, the contacts act on the proxy, which is displaced from the tool.
    if (algorithm == "proxy") tip += spring / rendering.stiffness;
    std::vector<Contact> of_row;
    for (; next < contacts.rows() && contacts.number(next, "step") == static_cast<double>(k); ++next) {
      of_row.push_back({contacts.vector(next, {"x_m", "y_m", "z_m"}) - tip,
                        contacts.vector(next, {"gradient_x", "gradient_y", "gradient_z"}),
                        contacts.number(next, "depth_m"), contacts.number(next, "weight")});
    }
    Vec3 force = Vec3::Zero(), torque = Vec3::Zero();
    double magnitude = 0.0;  // sum of the magnitudes of the rounded numbers
    for (const Contact& c : of_row) {
      const auto unweighted = unweighted_share(algorithm, rendering, spring, of_row.size(), c);
      const Vec3 f = unweighted.value_or(-rendering.stiffness * c.weight * c.depth * c.gradient);
      is_known |= unweighted.has_value();
      force += f;
      torque += c.position.cross(f);
      magnitude += f.norm() + rendering.stiffness * c.depth + spring.norm();
    }
    // Rounding of a hundred sums. For least_squares, the rounding of a residual is multiplied by 1 / eps = 100.
    const double rounding = 1e-12 * magnitude;
    const Vec3 written = rows.vector(k, {"tx_Nm", "ty_Nm", "tz_Nm"});
    if (!is_known && (force - spring).norm() > rounding) continue;
    // If the gradients cancel, their sum has no direction and the law gives no force.
    if (spring != Vec3::Zero()) {
      ASSERT_LE((force - spring).norm(), rounding) << k;
    }
    ASSERT_LE((torque - written).norm(), 0.01 * rounding) << k;  // arms of at most 1 cm
    largest = std::max(largest, written.norm());
    if (rows.number(k, "colliding") == 0.0) continue;
    sum += written.norm();
    in_contact += 1.0;
  }
  EXPECT_EQ(next, contacts.rows());
  EXPECT_GT(largest, 1e-5);
  EXPECT_NEAR(number_of(report.metrics, "torque.lost_mean_Nm").value(), sum / in_contact, 1e-12 * largest);
  EXPECT_NEAR(number_of(report.metrics, "torque.lost_max_Nm").value(), largest, 1e-12 * largest);
}

TEST(LostTorque, IsTheSumOverTheContactsOfArmTimesShareForEveryAlgorithm) {
  for (const AlgorithmEntry& algorithm : algorithms()) {
    SCOPED_TRACE(algorithm.info->name);
    expect_torques(algorithm.info->name, kPlane);
    // The slot is narrower than the tool, so the proxy always overlaps the walls. Other tests cover the contact forces
    // of the proxy in this case.
    if (std::string_view(algorithm.info->name) != "proxy") expect_torques(algorithm.info->name, kSlot);
  }
}

/// Returns the content of all files of a run without the pose: trajectory.csv without its last four columns, which are
/// the quaternion, and summary.json without its provenance.
std::map<std::string, std::string> bytes_without_pose(const std::filesystem::path& directory) {
  std::map<std::string, std::string> files;
  for (const char* name : {"contacts.csv", "energy.csv"}) files[name] = read_file(directory / name);
  for (const std::string& line : lines_of(read_file(directory / "trajectory.csv"))) {
    std::size_t end = line.size();
    for (int column = 0; column < 4; ++column) end = line.rfind(',', end - 1);
    files["trajectory.csv"] += line.substr(0, end) + "\n";
  }
  Json summary = Json::parse(read_file(directory / "summary.json"));
  summary.erase("provenance");
  files["summary.json"] = summary.dump();
  return files;
}

TEST(Roll, OfASolidOfRevolutionChangesNoByteButThePose) {
  for (const AlgorithmEntry& algorithm : algorithms()) {
    SCOPED_TRACE(algorithm.info->name);
    Json json = pressed_drill(kPlane, algorithm.info->name);
    json["record"] = {{"contacts", true}, {"energy", true}, {"pose", true}};
    json["rendering"]["passivity_controller"] = true;
    const TemporaryDirectory still, rolling;
    run_scenario(checked(read_scenario(json, ".")), still.path(), false);
    json["motion"]["orientation"]["roll_rad"] = {{"type", "ramp"}, {"start", 0.3}, {"rate_per_s", 50}};
    run_scenario(checked(read_scenario(json, ".")), rolling.path(), false);
    EXPECT_EQ(bytes_without_pose(still.path()), bytes_without_pose(rolling.path()));
    EXPECT_NE(read_file(still / "trajectory.csv"), read_file(rolling / "trajectory.csv"));
  }
}

TEST(Pose, IsThatOfTheScript) {
  Json json = pressed_drill(kPlane, "mean");
  json["record"] = {{"pose", true}};
  json["motion"]["orientation"]["roll_rad"] = 1.5;
  RunTables tables;
  run_scenario(checked(read_scenario(json, ".")), std::nullopt, false, &tables);
  const Table rows{tables.trials[0].at("trajectory.csv")};
  for (std::size_t k = 0; k < rows.rows(); ++k) {
    const double t = rows.number(k, "time_s");
    const Eigen::Quaterniond q(rows.number(k, "qw"), rows.number(k, "qx"), rows.number(k, "qy"), rows.number(k, "qz"));
    const Mat3 expected = (Eigen::AngleAxisd(0.2 + 3 * t, Vec3::UnitZ()) *
                           Eigen::AngleAxisd(0.1 + 2 * t, Vec3::UnitY()) * Eigen::AngleAxisd(1.5, -Vec3::UnitZ()))
                              .toRotationMatrix();
    EXPECT_LE((q.toRotationMatrix() - expected).norm(), 1e-14) << k;
    EXPECT_LE((q * -Vec3::UnitZ() - rows.vector(k, {"axis_x", "axis_y", "axis_z"})).norm(), 1e-14) << k;
  }
}

// Tests tools and environments of every type, created from the fields of a scenario.

/// Returns the scenario of a plane onto which a hand presses the tool.
Json scene(const std::string& tool, const std::string& algorithm = "shaped_stiffness") {
  Json json = test::minimal_scenario("plane");
  json["time"]["steps"] = 200;
  json["tool"] = Json::parse(tool);
  json["hand"] = {{"type", "force"}, {"z_N", -1}};
  json["rendering"]["algorithm"] = algorithm;
  return json;
}

LoadedScenario loaded(const Json& json) {
  return read_scenario(json, test::data_directory());
}

std::shared_ptr<const ToolShape> tool_of(const std::string& fields) {
  const LoadedScenario scenario = loaded(scene(fields));
  return make_tool(scenario.scenario, scenario.files);
}

const std::string kCube = R"({"type": "mesh", "file": "cube.obj", "scale": 0.0001, "tip_m": [0.0, 0.0, 0.0],
                               "tip_axis": [0.0, 0.0, -1.0], "grid_m": 0.00005})";
const std::string kHourglass =
    R"({"type": "revolved", "profile_m": [[-0.01, 0.002], [-0.002, 0.0003], [0, 0.001]], "tip": "flat"})";

TEST(ScenarioTool, WithoutATypeIsTheCylinderOfThatType) {
  for (const char* fields :
       {R"({"diameter_m": 0.002, "tip": "round"})", R"({"type": "cylinder", "diameter_m": 0.002, "tip": "round"})"}) {
    const Json json = scene(fields);
    EXPECT_EQ(effective_scenario(loaded(json).scenario, "")["tool"],
              Json::parse(R"({"diameter_m": 0.002, "length_m": 0.01, "tip": "round"})"));
    EXPECT_EQ(tool_of(fields)->half_width(), 0.001);
  }
}

/// Checks that the tool's frame has its origin at the tip, whichever face of the cube has the tip. In this frame the
/// cube lies behind the tip centre.
TEST(ScenarioTool, OfAMeshHasItsTipWhereItsFieldsSay) {
  for (const auto& [surface, axis] : {std::pair{"[0.0005, 0, 0]", "[2, 0, 0]"},
                                      {"[0, -0.0005, 0]", "[0, -1, 0]"},
                                      {"[0, 0, 0.0005]", "[0, 0, 1]"},
                                      {"[0, 0, -0.0005]", "[0, 0, -1]"}}) {
    const auto tool = tool_of(fmt::format(
        R"({{"type": "mesh", "file": "cube.obj", "scale": 0.0001, "tip_m": {}, "tip_axis": {}, "grid_m": 0.00005}})",
        surface, axis));
    Vec3 low = Vec3::Zero(), high = Vec3::Zero();
    for (const Vec3& vertex : dynamic_cast<const MeshTool&>(*tool).grid().vertices()) {
      low = low.cwiseMin(vertex);
      high = high.cwiseMax(vertex);
    }
    // Allow for rounding: a rotation changes a coordinate of 1 mm by some units in the last place, 2e-19 each.
    EXPECT_LT((low - Vec3(-0.0005, -0.0005, 0.0)).norm(), 1e-18) << axis << ": " << low.transpose();
    EXPECT_LT((high - Vec3(0.0005, 0.0005, 0.001)).norm(), 1e-18) << axis << ": " << high.transpose();
  }
}

TEST(ScenarioTool, ThatLiesOddlyInItsFrameIsNamed) {
  const Vec3 wide(0.001, 0.001, 0.0), low(0, 0, 0.009);
  EXPECT_EQ(frame_problem({-wide, wide + low}), "");
  EXPECT_EQ(frame_problem({-wide - low, wide}), "extends in front of its tip centre instead of behind it");
  EXPECT_EQ(frame_problem({Vec3(0, -0.001, -0.001), Vec3(0.009, 0.001, 0.001)}),
            "is longer across its axis than along it");
  EXPECT_EQ(frame_problem({wide + low, 2.0 * wide + 2.0 * low}), "is 9.11 mm away from its tip centre");
  // A wheel is intentionally wider than long, so it causes no warning.
  EXPECT_EQ(frame_problem({Vec3(-0.002, -0.002, 0), Vec3(0.002, 0.002, 0.0005)}), "");
}

TEST(ScenarioTool, HasAnOutlineFromTheFarEndToTheTipThatIsAsLargeAsItIs) {
  for (const std::string& fields : {std::string(R"({"tip": "round"})"), std::string("{}"), kCube, kHourglass,
                                    std::string(R"({"type": "bur", "family": "pear", "diameter_m": 0.001})")}) {
    const auto tool = tool_of(fields);
    const std::vector<ProfilePoint> outline = tool->outline();
    ASSERT_GE(outline.size(), 4u) << fields;
    EXPECT_EQ(outline.front().rho, 0.0) << fields;
    EXPECT_EQ(outline.back().rho, 0.0) << fields;
    EXPECT_LT(outline.front().s, outline.back().s) << fields;
    double reach = 0.0;
    for (const ProfilePoint& point : outline) reach = std::max(reach, std::hypot(point.s, point.rho));
    EXPECT_NEAR(reach, tool->reach(), fields == kCube ? 0.00005 : 1e-12) << fields;
  }
}

TEST(ScenarioTool, WarnsThatTheProxyHasNoGuaranteeWhereItIsNotConvex) {
  for (const auto& [fields, algorithm, warnings] :
       {std::tuple{kHourglass, "proxy", 1}, std::tuple{kHourglass, "mean", 0}, std::tuple{kCube, "proxy", 0}}) {
    const Result report = run_scenario(checked(loaded(scene(fields, algorithm))), std::nullopt, false);
    const auto about_that = [](const Warning& w) { return w.text.starts_with("the tool is not convex"); };
    EXPECT_EQ(std::ranges::count_if(report.warnings, about_that), warnings) << fields << " " << algorithm;
  }
}

TEST(ScenarioTool, IsInTheSummaryUnlessItIsACylinder) {
  EXPECT_TRUE(run_scenario(checked(loaded(scene("{}"))), std::nullopt, false).tool.is_null());
  EXPECT_EQ(run_scenario(checked(loaded(scene(kHourglass))), std::nullopt, false).tool,
            tool_json(*tool_of(kHourglass)));
}

/// Returns the scenario of a small block, changed by a merge patch.
Scenario block_scenario(const char* patch = "{}") {
  Json json = Json::parse(R"({"time": {"step_s": 0.0005, "steps": 20}, "environment": {"type": "block_with_hole",
    "size_m": [0.006, 0.005, 0.004], "hole_diameter_m": 0.002, "hole_depth_m": 0.002, "grid_m": 0.0002}})");
  json.merge_patch(Json::parse(patch));
  return read_scenario(json, "").scenario;
}

TEST(MakeShell, OfABlockListsVerticesOnceOrForEachCell) {
  const auto shared = make_shell(block_scenario());
  const Scenario scenario = block_scenario(R"({"environment": {"vertices": "per_cell"}})");
  const auto per_cell = make_shell(scenario);
  EXPECT_GT(shared->size(), 1000u);
  EXPECT_EQ(per_cell->size(), 4 * shared->size());
  // The cubes of marching cubes start at multiples of the grid's spacing. Shifted cubes would give different cells.
  const auto& block = std::get<BlockEnvironment>(scenario.environment);
  const IsoSurface surface = marching_cubes(density_field(block.block, block.grid, block.density), {.cells = true});
  EXPECT_EQ(per_cell->cell_of_points(), points_by_cell(surface, block.grid).cells);
}

}  // namespace
}  // namespace hapbench::pose_and_tools_test
