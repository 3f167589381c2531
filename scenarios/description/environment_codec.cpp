#include "scenarios/description/environment_codec.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "scenarios/description/object.hpp"
#include "scenarios/description/values.hpp"
#include "scenarios/input/size_limits.hpp"

namespace hapbench {
namespace {

constexpr NumberRange kLength = {0.0, 1000.0, "m", true};
/// Anything much shorter loses digits, or all, when it is squared.
constexpr double kShortestDirection = 1e-12;

void refuse_too_many(double count, const std::string& at, const char* what) {
  if (count <= kMostPoints) return;
  throw InputError(InputError::Kind::relation, at,
                   fmt::format("got {:.3g} {}; allowed: at most {:.0g}", count, what, kMostPoints));
}

template <class Shell>
void check_point_count(const Shell& shell, const std::string& at) {
  refuse_too_many(point_count(shell), at, "shell points (from the lengths and spacing_m)");
}

void check_springs(const SpringsEnvironment& springs, const std::string& at) {
  double count = static_cast<double>(springs.random.count);
  for (std::size_t i = 0; i < springs.groups.size(); ++i) {
    count += static_cast<double>(springs.groups[i].count);
    const Vec3& direction = springs.groups[i].direction;
    if (direction.norm() >= kShortestDirection) continue;
    throw InputError(InputError::Kind::relation, member(element(member(at, "groups"), i), "direction"),
                     fmt::format("got [{}, {}, {}]; allowed: a direction that is not zero, length at least {}",
                                 direction.x(), direction.y(), direction.z(), kShortestDirection));
  }
  refuse_too_many(count, at, "springs");
}

std::shared_ptr<ObjectCodec<SpringsEnvironment>> springs() {
  auto group = object<SpringGroup>();
  group->required(
      "direction", [](auto& g) -> Vec3& { return g.direction; }, vector3({-1e9, 1e9, "1"}),
      "gradient u of the springs, towards deeper penetration; normalised");
  group->required(
      "count", [](auto& g) -> std::int64_t& { return g.count; }, integer(0, 20'000'000), "number of springs");
  auto random = object<RandomSprings>();
  random->optional(
      "count", [](auto& r) -> std::int64_t& { return r.count; }, integer(0, 20'000'000),
      "number of springs with random gradients from the seed");
  random->optional(
      "planar", [](auto& r) -> bool& { return r.planar; }, boolean(),
      "gradients uniform on the circle z = 0 instead of the sphere");
  auto springs = object<SpringsEnvironment>();
  springs->optional(
      "bilateral", [](auto& s) -> bool& { return s.bilateral; }, boolean(),
      "springs push and pull; false: only while their depth is positive");
  springs->optional(
      "groups", [](auto& s) -> std::vector<SpringGroup>& { return s.groups; }, list_of<SpringGroup>(group, 0, 10'000),
      "springs by direction, in this order");
  springs->optional(
      "random", [](auto& s) -> RandomSprings& { return s.random; }, CodecPtr<RandomSprings>(random),
      "springs with random directions, after the groups");
  springs->relation(check_springs);
  return springs;
}

std::shared_ptr<ObjectCodec<Hole2d>> hole_2d() {
  auto hole = object<Hole2d>();
  hole->optional(
      "width_m", [](auto& h) -> double& { return h.width; }, number(kLength), "width of the hole");
  hole->optional(
      "depth_m", [](auto& h) -> double& { return h.depth; }, number(kLength), "depth of the hole");
  hole->optional(
      "spacing_m", [](auto& h) -> double& { return h.spacing; }, number(kLength), "largest distance of neighbours");
  hole->optional(
      "mouth_m", [](auto& h) -> double& { return h.mouth; }, number(kLength), "flat top either side");
  hole->relation(check_point_count<Hole2d>);
  return hole;
}

std::shared_ptr<ObjectCodec<Plane>> plane() {
  auto plane = object<Plane>();
  plane->optional(
      "size_m", [](auto& p) -> double& { return p.size; }, number(kLength), "edge of the square, centred at 0");
  plane->optional(
      "spacing_m", [](auto& p) -> double& { return p.spacing; }, number(kLength), "largest distance of neighbours");
  plane->relation(check_point_count<Plane>);
  return plane;
}

std::shared_ptr<ObjectCodec<Slot>> slot() {
  auto slot = object<Slot>();
  slot->required(
      "gap_m", [](auto& s) -> double& { return s.gap; }, number(kLength), "distance of the two faces, along x");
  slot->required(
      "depth_m", [](auto& s) -> double& { return s.depth; }, number(kLength), "height of the faces below z = 0");
  slot->required(
      "length_m", [](auto& s) -> double& { return s.length; }, number(kLength), "width of the faces along y");
  slot->required(
      "spacing_m", [](auto& s) -> double& { return s.spacing; }, number(kLength), "largest distance of neighbours");
  slot->relation(check_point_count<Slot>);
  return slot;
}

void check_block(const BlockEnvironment& environment, const std::string& at) {
  const auto& [block, grid, density] = environment;
  const Vec3& size = block.size;
  // Cells smaller than this cannot be numbered; thinner walls have no nodes on both sides.
  const double longest = 1e5 * grid, thinnest = 3.0 * grid;
  const auto fail = [&at](const char* field, const std::string& problem) {
    throw InputError(InputError::Kind::relation, member(at, field), problem);
  };
  if (size.maxCoeff() > longest) fail("grid_m", fmt::format("got {}; allowed: at least size_m / 1e5", grid));
  const double area = 2.0 * (size.x() * size.y() + size.y() * size.z() + size.z() * size.x());
  refuse_too_many(area / (grid * grid), at, "shell points (from size_m and grid_m)");
  if (block.hole_diameter > std::min(size.x(), size.y()) - 2.0 * thinnest || block.hole_diameter < thinnest) {
    fail("hole_diameter_m",
         fmt::format("got {}; allowed: at least 3 grid_m, leaving walls of 3 grid_m", block.hole_diameter));
  }
  if (block.hole_depth > size.z() - thinnest || block.hole_depth < thinnest) {
    fail("hole_depth_m",
         fmt::format("got {}; allowed: at least 3 grid_m, leaving a bottom of 3 grid_m", block.hole_depth));
  }
}

std::shared_ptr<ObjectCodec<BlockEnvironment>> block_with_hole() {
  auto block = object<BlockEnvironment>();
  block->optional(
      "size_m", [](auto& b) -> Vec3& { return b.block.size; }, vector3(kLength),
      "edges of the block, centred at x = y = 0, top face in z = 0");
  block->optional(
      "hole_diameter_m", [](auto& b) -> double& { return b.block.hole_diameter; }, number(kLength), "round blind hole");
  block->optional(
      "hole_depth_m", [](auto& b) -> double& { return b.block.hole_depth; }, number(kLength), "below the top face");
  block->optional(
      "grid_m", [](auto& b) -> double& { return b.grid; }, number(kLength),
      "grid of the density field; its nodes lie at half-integer multiples");
  block->optional(
      "density", [](auto& b) -> std::string& { return b.density; }, name_of({"signed_distance", "binary"}, "density"),
      "what the nodes store: minus the signed distance, or 1 and 0");
  block->relation(check_block);
  return block;
}

std::shared_ptr<ObjectCodec<PointShellEnvironment>> point_shell() {
  auto shell = object<PointShellEnvironment>();
  shell->required(
      "file", [](auto& s) -> std::string& { return s.file; }, text(4096),
      "CSV with header x_m,y_m,z_m,nx,ny,nz, or PLY with normals; relative to the scenario file");
  shell->optional(
      "grid_m", [](auto& s) -> std::optional<double>& { return s.grid; }, nullable<double>(number(kLength)),
      "cell of the local average; null: no grid");
  return shell;
}

std::shared_ptr<ObjectCodec<MeshEnvironment>> mesh() {
  auto mesh = object<MeshEnvironment>();
  mesh->required(
      "file", [](auto& m) -> std::string& { return m.file; }, text(4096),
      "surface as OBJ, PLY, STL or OFF, ASCII or binary; relative to the scenario file");
  mesh->required(
      "scale", [](auto& m) -> double& { return m.scale; }, number({0.0, 1e6, "m", true}),
      "length of the file's unit: 0.001 for millimetres");
  mesh->optional(
      "spacing_m", [](auto& m) -> std::optional<double>& { return m.spacing; }, nullable<double>(number(kLength)),
      "resamples: no edge longer, one point in a cube of this size; null: the mesh's own vertices");
  mesh->optional(
      "grid_m", [](auto& m) -> std::optional<double>& { return m.grid; }, nullable<double>(number(kLength)),
      "cell of the local average; null: no grid");
  return mesh;
}

std::shared_ptr<TaggedCodec<Environment>> make_codec() {
  auto codec = tagged<Environment>("environment");
  codec->alternative("springs", springs())
      .alternative("hole_2d", hole_2d())
      .alternative("plane", plane())
      .alternative("slot", slot())
      .alternative("block_with_hole", block_with_hole())
      .alternative("point_shell", point_shell())
      .alternative("mesh", mesh());
  return codec;
}

const std::shared_ptr<TaggedCodec<Environment>>& the_codec() {
  static const auto codec = make_codec();
  return codec;
}

}  // namespace

CodecPtr<Environment> environment_codec() {
  return the_codec();
}

std::vector<std::string> environment_names() {
  return the_codec()->names();
}

}  // namespace hapbench
