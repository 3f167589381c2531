#include "scenarios/scene/environments.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/shared_cache.hpp"
#include "scenarios/input/size_limits.hpp"
#include "scenarios/input/writer.hpp"
#include "scenarios/scene/field_checks.hpp"
#include "sim/core/random.hpp"
#include "sim/geometry/grid_index.hpp"
#include "sim/mesh/marching_cubes.hpp"

namespace hapbench {
namespace {

using Shell = std::shared_ptr<const PointShell>;

/// Allowed number of springs with the same direction, and of springs with random directions.
constexpr IntegerRange kSpringCount = {0, 20'000'000};

/// Throws InputError if the point shell of an analytic shape would have too many points. `shell`: the shape and the
/// spacing of its points.
template <class Shell>
void check_point_count(Fields& f, const Shell& shell) {
  if (f.reads())
    require_at_most(kMaxSurfacePoints, point_count(shell), f.at(), "shell points (from the lengths and spacing_m)");
}

/// Throws InputError if the fields of springs contradict each other.
void check_springs(const SpringsEnvironment& springs, const std::string& at) {
  double count = static_cast<double>(springs.random.count);
  for (std::size_t i = 0; i < springs.groups.size(); ++i) {
    count += static_cast<double>(springs.groups[i].count);
    require_direction(springs.groups[i].direction, fmt::format("{}/groups/{}/direction", at, i));
  }
  require_at_most(kMaxSurfacePoints, count, at, "springs");
  if (springs.bilateral || springs.signed_depths) return;
  fail_at(
      at + "/signed",
      "got false; allowed with \"bilateral\": false: true, because a unilateral spring acts only at positive depths");
}

/// Throws InputError if the grid is too coarse for the hole and its walls, or would give too many points.
void check_block(const BlockEnvironment& environment, const std::string& at) {
  const BlockWithHole& block = environment.block;
  const double grid = environment.grid;
  const Vec3& size = block.size;
  // Upper limit: 1e5 grid cells along an edge of the block, because each cell needs an index. Lower limit: 3
  // cells, because a thinner wall may have no grid nodes on one of its sides.
  const double longest = 1e5 * grid, thinnest = 3.0 * grid;
  const auto fail = [&at](const char* field, const std::string& problem) { fail_at(at + "/" + field, problem); };
  if (size.maxCoeff() > longest) fail("grid_m", fmt::format("got {}; allowed: at least size_m / 1e5", grid));
  const double area = 2.0 * (size.x() * size.y() + size.y() * size.z() + size.z() * size.x());
  // A vertex lies on a grid edge, and four cells share each grid edge. With per_cell, the shell has each vertex
  // once for each of these cells.
  const double copies = environment.per_cell ? 4.0 : 1.0;
  require_at_most(kMaxSurfacePoints, copies * area / (grid * grid), at,
                  "shell points (from size_m, grid_m and vertices)");
  if (block.hole_diameter > std::min(size.x(), size.y()) - 2.0 * thinnest || block.hole_diameter < thinnest) {
    fail("hole_diameter_m",
         fmt::format("got {}; allowed: at least 3 grid_m, with walls of at least 3 grid_m beside the hole",
                     block.hole_diameter));
  }
  if (block.hole_depth > size.z() - thinnest || block.hole_depth < thinnest) {
    fail("hole_depth_m",
         fmt::format("got {}; allowed: at least 3 grid_m, with a bottom of at least 3 grid_m below the hole",
                     block.hole_depth));
  }
}

}  // namespace

static void describe(Fields& f, SpringGroup& group) {
  f.vector3(
      "direction", group.direction, {-1e9, 1e9, "1"},
      "gradient u of the springs, the direction in which the penetration becomes deeper; its length does not matter",
      Presence::required);
  f.integer("count", group.count, kSpringCount, "number of springs with this direction", Presence::required);
}

static void describe(Fields& f, RandomSprings& random) {
  f.integer("count", random.count, kSpringCount, "number of springs with random gradients, drawn by the seed");
  f.boolean("planar", random.planar, "true: gradients are uniform on the circle z = 0; false: on the sphere");
}

static void describe(Fields& f, SpringsEnvironment& springs) {
  f.boolean("bilateral", springs.bilateral,
            "true: springs push and pull; false: a spring acts only while its depth is positive");
  f.boolean(
      "signed", springs.signed_depths,
      "depth of a bilateral spring for the displacement p. true: <p, u>, which may be negative; false: |<p, u>|, and "
      "the gradient changes its sign if <p, u> is negative");
  f.objects("groups", springs.groups, {0, 10'000}, "groups of springs with one direction each, in this order");
  f.object("random", springs.random, "springs with random directions, in the list after the groups");
  if (f.reads()) check_springs(springs, f.at());
}

static void describe(Fields& f, Hole2d& hole) {
  f.number("width_m", hole.width, kLength, "width of the hole");
  f.number("depth_m", hole.depth, kLength, "depth of the hole");
  f.number("spacing_m", hole.spacing, kLength, "largest distance of neighbouring points");
  f.number("mouth_m", hole.mouth, kLength, "width of the flat top on either side of the hole");
  check_point_count(f, hole);
}

static void describe(Fields& f, Plane& plane) {
  f.number("size_m", plane.size, kLength, "side length of the square, which is centred at the origin");
  f.number("spacing_m", plane.spacing, kLength, "largest distance of neighbouring points");
  check_point_count(f, plane);
}

static void describe(Fields& f, Slot& slot) {
  f.number("gap_m", slot.gap, kLength, "distance between the two faces, along x", Presence::required);
  f.number("depth_m", slot.depth, kLength, "height of the faces, which extend from z = 0 downwards",
           Presence::required);
  f.number("length_m", slot.length, kLength, "width of the faces along y", Presence::required);
  f.number("spacing_m", slot.spacing, kLength, "largest distance of neighbouring points", Presence::required);
  check_point_count(f, slot);
}

static void describe(Fields& f, ConicalHole& cone) {
  f.number("half_angle_rad", cone.half_angle, {0.01, 1.56, "rad"}, "angle between the z axis and the wall");
  f.number("depth_m", cone.depth, kLength, "depth of the apex below the mouth, which is at z = 0");
  f.number("spacing_m", cone.spacing, kLength,
           "largest distance of neighbouring points on a ring, and of neighbouring rings");
  check_point_count(f, cone);
}

static void describe(Fields& f, BlockEnvironment& environment) {
  BlockWithHole& block = environment.block;
  f.vector3("size_m", block.size, kLength,
            "side lengths of the block, which is centred at x = y = 0 with its top face in z = 0");
  f.number("hole_diameter_m", block.hole_diameter, kLength, "diameter of the round blind hole");
  f.number("hole_depth_m", block.hole_depth, kLength, "depth of the hole below the top face");
  f.number("grid_m", environment.grid, kLength,
           "spacing of the density grid; its nodes are at half-integer multiples of it");
  f.choice("density", environment.density, {"signed_distance", "binary"}, "density",
           "value at the nodes: negative signed distance, or 1 (inside) and 0 (outside)");
  f.choice(
      "vertices", environment.per_cell, {"shared", "per_cell"}, "listing",
      "points of the shell: each vertex once (shared), or once for each grid cell that has it on an edge (per_cell, "
      "as in the thesis)");
  if (f.reads()) check_block(environment, f.at());
}

static void describe(Fields& f, PointShellEnvironment& shell) {
  f.file(shell.file, {FileContent::Kind::point_shell},
         "CSV with header x_m,y_m,z_m,nx,ny,nz, or PLY with normals; relative to the scenario file");
  f.number("grid_m", shell.grid, kLength, "size of the grid cells of the local average; null: no grid");
}

static void describe(Fields& f, MeshEnvironment& mesh) {
  f.file(mesh.file, {FileContent::Kind::mesh, {mesh.scale, mesh.spacing, mesh.flip}},
         "surface as OBJ, OFF, PLY or STL, the last two also binary; relative to the scenario file");
  f.number("scale", mesh.scale, {0.0, 1e6, "m", true},
           "length of one unit of the file in metres: 0.001 for millimetres", Presence::required);
  f.number(
      "spacing_m", mesh.spacing, kLength,
      "spacing of the shell's points: the mesh is refined until no edge is longer than this spacing. Then each cube of "
      "this size keeps one point for each of the directions +-x, +-y and +-z nearest to the points' normals. null: the "
      "mesh's own vertices");
  f.boolean("flip_normals", mesh.flip,
            "inverts the normals of an open surface, such as a scan whose normals point inwards");
  f.number("grid_m", mesh.grid, kLength, "size of the grid cells of the local average; null: no grid");
}

void describe(Fields& f, Environment& environment) {
  f.variant(environment, "environment",
            {{"springs", "springs that act on the tool's tip, without a surface"},
             {"hole_2d", "planar hole with its mouth"},
             {"plane", "flat square"},
             {"slot", "two parallel faces"},
             {"block_with_hole", "block with a round blind hole, whose shell is made by marching cubes"},
             {"point_shell", "points with normals from a CSV or PLY file"},
             {"mesh", "surface from an OBJ, PLY, STL or OFF file"},
             {"conical_hole", "hole that tapers to a point"}});
}

namespace {

/// Returns the environment as JSON with every default filled in and with hashes of files instead of paths. Used
/// as a cache key: environments with equal JSON have equal shells and solids. Throws InputError if a file cannot
/// be read.
Json environment_content(const Scenario& scenario, const NamedFiles& files) {
  constexpr std::string_view kEnvironment = "/environment";
  Json json = written(scenario.environment);
  for (const auto& file : files.all()) {
    if (file->pointer().starts_with(kEnvironment))
      json.at(Json::json_pointer(file->pointer().substr(kEnvironment.size()))) = file->hash();
  }
  return json;
}

/// Builds the point shell, for each type of environment. Null for springs.
struct Build {
  const NamedFiles& files;

  Shell operator()(const SpringsEnvironment&) const { return nullptr; }
  Shell operator()(const PointShellEnvironment& given) const {
    return std::make_shared<const PointShell>(files.at(kEnvironmentFile).points(), given.grid.value_or(0.0));
  }
  Shell operator()(const MeshEnvironment& mesh) const {
    const double cell_size = mesh.grid.value_or(0.0);
    const auto points = in_grid_order(files.at(kEnvironmentFile).mesh().points(), cell_size);
    return std::make_shared<const PointShell>(points, cell_size);
  }
  Shell operator()(const BlockEnvironment& block) const {
    const DensityField field = density_field(block.block, block.grid, block.density);
    if (!block.per_cell) return std::make_shared<const PointShell>(surface_shell(field));
    ShellPoints points = points_by_cell(marching_cubes(field, {.cells = true}), block.grid);
    return std::make_shared<const PointShell>(points.points, block.grid, std::move(points.cells));
  }
  template <class Analytic>
  Shell operator()(const Analytic& shape) const {
    return std::make_shared<const PointShell>(surface_points(shape), shape.spacing);
  }
};

/// Builds the solid, for each type of environment. Null for springs.
struct BuildSolid {
  const NamedFiles& files;

  std::shared_ptr<const Solid> operator()(const SpringsEnvironment&) const { return nullptr; }
  std::shared_ptr<const Solid> operator()(const BlockEnvironment& block) const { return make_solid(block.block); }
  std::shared_ptr<const Solid> operator()(const PointShellEnvironment&) const {
    return make_solid(files.at(kEnvironmentFile).points());
  }
  std::shared_ptr<const Solid> operator()(const MeshEnvironment&) const {
    const MeshFile& file = files.at(kEnvironmentFile).mesh();
    const TriangleSoup mesh = file.triangles();
    return make_solid(mesh.vertices, mesh.triangles, file.is_closed());
  }
  template <class Analytic>
  std::shared_ptr<const Solid> operator()(const Analytic& shape) const {
    return make_solid(shape);
  }
};

}  // namespace

Shell make_shell(const Scenario& scenario, const NamedFiles& files) {
  if (std::holds_alternative<SpringsEnvironment>(scenario.environment)) return nullptr;
  // Estimated: 52 bytes for each point, and up to 60 bytes for its place in the search grid.
  const auto bytes = [](const PointShell& shell) { return 112 * shell.size(); };
  return shared_cache().get<PointShell>(
      "shell " + environment_content(scenario, files).dump(),
      [&] { return std::visit(Build{files}, scenario.environment); }, bytes);
}

std::shared_ptr<const Solid> make_solid(const Scenario& scenario, const NamedFiles& files) {
  // Cache only the solids of environments with a file, because only these solids take long to build.
  const auto make = [&] { return std::visit(BuildSolid{files}, scenario.environment); };
  if (files.find(kEnvironmentFile) == nullptr) return make();
  const auto bytes = [](const Solid& solid) { return solid.bytes(); };
  return shared_cache().get<Solid>("solid " + environment_content(scenario, files).dump(), make, bytes);
}

SpringSet make_springs(const Scenario& scenario) {
  const auto& fields = std::get<SpringsEnvironment>(scenario.environment);
  SpringSet springs;
  springs.bilateral = fields.bilateral;
  springs.signed_depths = fields.signed_depths;
  // Add the springs with given directions.
  for (const SpringGroup& group : fields.groups) {
    const double length = group.direction.norm();
    // A direction whose norm is 1 up to rounding is not normalised, because division would change its last digits.
    const Vec3 unit = std::abs(length - 1.0) <= 1e-12 ? group.direction : Vec3(group.direction / length);
    springs.gradients.insert(springs.gradients.end(), static_cast<std::size_t>(group.count), unit);
  }
  // Add the springs with random directions.
  Random random(static_cast<std::uint64_t>(scenario.seed));
  for (std::int64_t i = 0; i < fields.random.count; ++i)
    springs.gradients.push_back(fields.random.planar ? random.direction_in_plane() : random.direction());
  return springs;
}

}  // namespace hapbench
