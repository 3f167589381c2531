#include "scenarios/config/environment_codec.hpp"

#include <fmt/format.h>

#include "scenarios/codec/object.hpp"
#include "scenarios/codec/size_limits.hpp"
#include "scenarios/codec/values.hpp"

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

std::shared_ptr<TaggedCodec<Environment>> make_codec() {
  auto codec = tagged<Environment>("environment");
  codec->alternative("springs", springs())
      .alternative("hole_2d", hole_2d())
      .alternative("plane", plane())
      .alternative("slot", slot())
      .alternative("point_shell", point_shell());
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
