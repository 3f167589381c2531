#include "tests/support/setting.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include "algorithms/depth/depth_model.hpp"
#include "algorithms/laws/exact_shaping.hpp"
#include "algorithms/laws/force_law.hpp"
#include "device_model/admittance_device.hpp"
#include "device_model/hands/scripted_hands.hpp"
#include "sim/contact/contact_query.hpp"
#include "sim/contact/contact_source.hpp"
#include "sim/contact/multi_rate_contacts.hpp"
#include "sim/contact/spring_source.hpp"
#include "sim/geometry/analytic_shells.hpp"

namespace hapbench::test {
namespace {

std::shared_ptr<const PointShell> shell_of(const Setting& setting) {
  return setting.springs ? nullptr : std::make_shared<const PointShell>(setting.points, setting.cell_size);
}

std::shared_ptr<const SpringSet> springs_of(const Setting& setting) {
  return setting.springs ? std::make_shared<const SpringSet>(*setting.springs) : nullptr;
}

std::unique_ptr<ContactSource> source_of(const PointShell* shell, std::shared_ptr<const SpringSet> springs,
                                         const ToolShape& tool, const RenderingConfig& config) {
  if (springs) return std::make_unique<SpringSource>(std::move(springs));
  return std::make_unique<ShellSource>(*shell, tool, make_contact_query(*shell, tool, Skips::on),
                                       make_depth_model(config), config.skips);
}

}  // namespace

Setting moved(Setting setting, const Mat3& R, const Vec3& t) {
  setting.pose = {R * setting.pose.position + t, R * setting.pose.axis};
  for (SurfacePoint& point : setting.points) point = {R * point.position + t, R * point.normal};
  if (setting.springs) {
    for (Vec3& u : setting.springs->gradients) u = R * u;
  }
  return setting;
}

Setting scaled(Setting setting, double s) {
  setting.tool = {s * setting.tool.radius(), s * setting.tool.length(), setting.tool.tip()};
  setting.pose.position *= s;
  setting.cell_size *= s;
  for (SurfacePoint& point : setting.points) point.position *= s;
  return setting;
}

Setting permuted(Setting setting, Random& random) {
  random.shuffle(setting.points);
  if (setting.springs) random.shuffle(setting.springs->gradients);
  return setting;
}

Probe::Probe(const Setting& setting, const RenderingConfig& config)
    : tool_(setting.tool),
      shell_(shell_of(setting)),
      springs_(springs_of(setting)),
      source_(source_of(shell_.get(), springs_, tool_, config)),
      algorithm_(make_algorithm(config)),
      contacts_(source_->capacity()) {
  algorithm_->prepare({source_->capacity(), &tool_, shell_.get(), springs_.get()});
  algorithm_->reset();
}

RenderedForce Probe::force_at(const ToolPose& pose, const Vec3& velocity, const Vec3& angular_velocity) {
  source_->contacts_at(pose, contacts_);
  RenderedForce force;
  algorithm_->compute({pose, velocity, angular_velocity}, contacts_, force);
  return force;
}

SimulationParts free_run(const Setting& setting, const RenderingConfig& config) {
  SimulationParts parts;
  parts.tool = std::make_shared<Cylinder>(setting.tool);
  parts.shell = shell_of(setting);
  parts.springs = springs_of(setting);
  parts.source = source_of(parts.shell.get(), parts.springs, *parts.tool, config);
  if (config.multi_rate)
    parts.source = std::make_unique<MultiRateContacts>(std::move(parts.source), *config.multi_rate,
                                                       setting.springs.has_value(), 1);
  parts.algorithm = make_algorithm(config);
  parts.motion = constant_axis(setting.pose.axis);
  parts.hand = std::make_unique<ForceHand>();
  parts.device = std::make_unique<IdealDevice>(std::nullopt);
  return parts;
}

SimulationConfig free_run_config(const Setting& setting, const RenderingConfig& config, std::uint64_t steps) {
  SimulationConfig simulation;
  simulation.steps = steps;
  simulation.mass = config.mass;
  simulation.position = setting.pose.position;
  return simulation;
}

std::unique_ptr<Motion> constant_axis(const Vec3& axis) {
  // At tilt 0, the axis is -up for any azimuth.
  return std::make_unique<ScriptedMotion>(Orientation{-axis, axis.unitOrthogonal(), {}, {}}, std::nullopt);
}

namespace {

constexpr double kDeep = 0.001;  ///< compression of the springs [m]
constexpr double kEps = kExactShapingEpsilon;
const double kRegularisation = RenderingConfig().regularisation;
const Vec3 kFarAway(1.0, 1.0, 1.0);

Setting springs(std::vector<Vec3> gradients, const Vec3& position, bool bilateral) {
  Setting setting;
  setting.pose.position = position;
  setting.springs = SpringSet{std::move(gradients), bilateral};
  return setting;
}

const Vec3 kOblique(0.6, 0.64, 0.48);

Setting single_spring() {
  return springs({kOblique}, kDeep * kOblique, false);
}
Setting parallel_springs() {
  return springs(std::vector<Vec3>(5, kOblique), kDeep * kOblique, false);
}
// Returns three orthogonal springs with equal compression: S_sum = I, sum u = (1, 1, 1).
Setting corner_springs() {
  return springs({Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()}, Vec3::Constant(kDeep), false);
}
// Returns two opposite springs, of which one pushes and the other pulls: depths d and -d along the gradients x and -x.
Setting opposite_springs() {
  return springs({Vec3::UnitX(), -Vec3::UnitX()}, kDeep * Vec3::UnitX(), true);
}
// Returns two faces at an angle of 120 degrees, with the tool pressed symmetrically between them: both depths are d/2
// and <u_1, u_2> = -1/2. Each spring contributes half of its depth along the exit direction.
Setting wedge_springs() {
  const double s = std::sqrt(0.75);
  return springs({{0.5, s, 0.0}, {0.5, -s, 0.0}}, kDeep * Vec3::UnitX(), false);
}

/// Spring force divided by K of each law in the five scenes above, in units of the compression. For
/// `virtual_coupling`, K_vc = K by default: springs with the total stiffness k K act in series with K and give
/// k / (k + 1).
struct SpringRow {
  std::string_view law;
  double single, parallel, corner, opposite, wedge;
};
std::span<const SpringRow> spring_rows() {
  static const double root3 = std::sqrt(3.0);
  static const SpringRow kRows[] = {
      {"original_averaging", 1, 1, root3, 0, 1},
      {"summation", 1, 5, root3, 2, 0.5},
      {"mcneely", 1, 5, root3, 2, 0.5},
      {"mean", 1, 1, root3 / 3, 1, 0.25},
      {"virtual_coupling", 0.5, 5.0 / 6, root3 / 2, 2.0 / 3, 1.0 / 3},
      {"shaped_stiffness", 1, 1, root3, 1, 0.4},
      {"tandpasta", 1, 5, root3, 0, 0.5},
      {"normal_projection", 1, 1, root3, 1, 0.4},
      {"continuous_normal_projection", 1, 1, root3, 1, 0.4},
      {"exact_shaping", 1 / (1 + kEps), 5 / (5 + kEps), root3 / (1 + kEps), 2 / (2 + kEps), 0.5 / (1.25 + kEps)},
      {"least_squares", 1 / (1 + kRegularisation), 5 / (5 + kRegularisation), root3 / (1 + kRegularisation),
       2 / (2 + kRegularisation), 0.5 / (0.5 + kRegularisation)},
      {"highest_depth", 1, 1, 1, 0, 0.5},
  };
  return kRows;
}

template <double SpringRow::*kScene>
Answer spring_answer(const Vec3& direction, bool may_vanish = false) {
  Answer answer{direction, may_vanish};
  for (const SpringRow& row : spring_rows()) answer.spring_over_K[row.law] = kDeep * row.*kScene;
  return answer;
}
Answer single_spring_answer() {
  return spring_answer<&SpringRow::single>(-kOblique);
}
Answer parallel_springs_answer() {
  return spring_answer<&SpringRow::parallel>(-kOblique);
}
Answer corner_springs_answer() {
  return spring_answer<&SpringRow::corner>(Vec3::Constant(-std::sqrt(1.0 / 3.0)));
}
Answer opposite_springs_answer() {
  return spring_answer<&SpringRow::opposite>(-Vec3::UnitX(), true);
}
Answer wedge_springs_answer() {
  return spring_answer<&SpringRow::wedge>(-Vec3::UnitX());
}

Setting springs_at_rest() {
  return springs({Vec3::UnitX(), -Vec3::UnitX(), -Vec3::UnitY(), kOblique}, Vec3::Zero(), true);
}

Answer no_force() {
  return {};
}

/// Spacing of cells and points. The tool's radius is not a multiple of it, so that no point lies on the tool's
/// side and no point has two nearest surfaces. Depths and gradients then change smoothly when a scene is
/// rotated.
constexpr double kSpacing = 0.00013;

// Returns a flat tool pressed into the plane, in the middle of the grid. By symmetry, the force is normal to the plane.
Setting pressed_plane() {
  Setting setting;
  setting.points = surface_points(Plane{20 * kSpacing, kSpacing});
  setting.cell_size = kSpacing;
  setting.pose.position = {0.0, 0.0, -0.000121};
  return setting;
}
Answer pressed_plane_answer() {
  return {Vec3::UnitZ()};
}

Setting slot(double x) {
  Setting setting;
  setting.points = surface_points(Slot{0.0008, 0.004, 0.002, kSpacing});
  setting.cell_size = kSpacing;
  // The tool passes through the whole slot: its tip is below the faces and its other end above them.
  setting.pose.position = {x, 0.0, -0.0047};
  return setting;
}
// Returns a tool that is wider than the slot, in the middle of the slot. Both faces push equally.
Setting centred_slot() {
  return slot(0.0);
}
// Returns a tool in the slot that touches only the right face.
Setting one_sided_slot() {
  return slot(0.000217);
}
Answer one_sided_slot_answer() {
  return {-Vec3::UnitX()};
}

/// Returns the 2-D peg of thesis A.1. `y` is the height of the tip centre [m].
Setting peg(double tilt, double diameter, double y) {
  Setting setting;
  setting.tool = {diameter / 2, 0.005, Tip::round};
  setting.points = surface_points(Hole2d{});
  setting.cell_size = Hole2d{}.spacing;
  setting.pose = {{0.0, y, 0.0}, {-std::sin(tilt), -std::cos(tilt), 0.0}};
  return setting;
}
// Returns a peg whose hemispherical tip is touched by the wall points at the height of the tip centre.
Setting peg_start() {
  return peg(0.1, 0.001, -0.004);
}
Setting tilted_peg() {
  return peg(0.1, 0.001, -0.00403);
}
Answer in_plane() {
  Answer answer;
  answer.only_in_plane = true;
  return answer;
}
// Returns an upright peg that fits exactly: it touches both walls with depth zero.
Setting upright_peg() {
  return peg(0.0, 0.001, -0.004);
}
// Returns a thinner peg that is pressed against the bottom. By symmetry, the force points straight up.
Setting pressed_peg() {
  return peg(0.0, 0.00083, -0.0047);
}
Answer pressed_peg_answer() {
  return {Vec3::UnitY()};
}

const AnalyticScene kScenes[] = {
    {"single_spring", "surface_normal", single_spring, single_spring_answer, -kDeep* kOblique},
    {"parallel_springs", "surface_normal", parallel_springs, parallel_springs_answer, -kDeep* kOblique},
    {"corner_springs", "surface_normal", corner_springs, corner_springs_answer, Vec3::Constant(-kDeep)},
    {"opposite_springs", "surface_normal", opposite_springs, opposite_springs_answer, Vec3::Zero()},
    {"wedge_springs", "surface_normal", wedge_springs, wedge_springs_answer, -kDeep* Vec3::UnitX()},
    {"springs_at_rest", "surface_normal", springs_at_rest, no_force, Vec3::Zero()},
    {"pressed_plane", "surface_normal", pressed_plane, pressed_plane_answer, kFarAway},
    {"pressed_plane_by_shortest_distance", "shortest_distance", pressed_plane, pressed_plane_answer, kFarAway},
    {"pressed_plane_by_normal_projection", "normal_projection", pressed_plane, pressed_plane_answer, kFarAway},
    {"centred_slot", "surface_normal", centred_slot, no_force, kFarAway},
    {"one_sided_slot", "surface_normal", one_sided_slot, one_sided_slot_answer, kFarAway},
    {"one_sided_slot_by_shortest_distance", "shortest_distance", one_sided_slot, one_sided_slot_answer, kFarAway},
    {"peg_start", "surface_normal", peg_start, in_plane, kFarAway, true},
    {"tilted_peg", "surface_normal", tilted_peg, in_plane, kFarAway},
    {"tilted_peg_by_normal_projection", "normal_projection", tilted_peg, in_plane, kFarAway},
    {"upright_peg", "surface_normal", upright_peg, no_force, kFarAway, true},
    {"pressed_peg", "surface_normal", pressed_peg, pressed_peg_answer, kFarAway},
};

}  // namespace

std::span<const AnalyticScene> analytic_scenes() {
  return kScenes;
}

RenderingConfig config_for(std::string_view algorithm, const AnalyticScene& scene) {
  RenderingConfig config;
  config.algorithm = algorithm;
  config.depth_model = scene.depth_model;
  return config;
}

double total_depth(const Setting& setting, const RenderingConfig& config) {
  // `summation` does not modify contacts, so that the buffer contains the depths of the depth model.
  RenderingConfig plain;
  plain.algorithm = "summation";
  plain.depth_model = with_fixed_stages(config).depth_model;
  Probe probe(setting, plain);
  probe.force_at(setting.pose);
  double total = 0.0;
  for (std::size_t i = 0; i < probe.contacts().size(); ++i) total += std::abs(probe.contacts().depth[i]);
  return total;
}

}  // namespace hapbench::test
