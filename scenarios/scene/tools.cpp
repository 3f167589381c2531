#include "scenarios/scene/tools.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <stdexcept>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/shared_cache.hpp"
#include "scenarios/input/text_lines.hpp"
#include "scenarios/scene/field_checks.hpp"
#include "sim/tool/bur_profile.hpp"
#include "sim/tool/mesh_tool.hpp"
#include "sim/tool/revolved.hpp"

namespace hapbench {
namespace {

/// Maximum number of points of a tool's outline. The computing time of a time step grows with the number of points.
constexpr std::size_t kMaxProfilePoints = 1000;

/// Types of tools, in the order of the variant ToolFields.
constexpr TypeName kToolTypes[] = {
    {"cylinder", "cylinder with a flat or a round tip, like a drill's stylus"},
    {"revolved", "solid of revolution, given by its profile"},
    {"bur", "dental or bone bur with its shank, given by the name of its shape"},
    {"mesh", "surface from an OBJ, PLY, STL or OFF file"},
};

/// Checks a shape: calls `make`, which constructs the shape. Converts a std::invalid_argument into an InputError at the
/// JSON pointer `at`.
template <class Make>
void check_shape(const std::string& at, const char* allowed, const Make& make) {
  try {
    make();
  } catch (const std::invalid_argument& error) {
    fail_at(at, fmt::format("{}; allowed: {}", error.what(), allowed));
  }
}

/// Returns the shape of a bur. Throws std::invalid_argument if no bur has these dimensions.
Revolved revolved_of(const BurFields& bur) {
  const BurProfile of_bur = bur_profile(bur.family, bur.diameter, bur.length.value_or(bur.diameter),
                                        bur.shank_diameter.value_or(BurFields::kShankRatio * bur.diameter));
  return Revolved(of_bur.profile, of_bur.tip);
}

}  // namespace

static void describe(Fields& f, CylinderFields& tool) {
  f.number("diameter_m", tool.diameter, kLength, "diameter of the cylinder; default 0.001", Presence::no_default);
  f.number("length_m", tool.length, kLength,
           "length from the tip plane to the far end; default 0.005 in hole_2d, else 0.01", Presence::no_default);
  f.choice("tip", tool.tip, {"flat", "round"}, "tip",
           "flat, or round with a half ball added; default round in hole_2d, else flat", Presence::no_default);
}

static void describe(Fields& f, RevolvedFields& tool) {
  f.list(
      "profile_m", tool.profile, {2, kMaxProfilePoints},
      "corners [s, rho] of the outline, from the far end to the tip: s <= 0 is the position along the axis from the "
      "tip centre, rho the distance from the axis",
      [](Fields& p, ProfilePoint& point) {
        p.pair("two numbers [s, rho]: position along the axis from the tip centre, and distance from the axis [m]",
               point.s, {-1000.0, 1000.0, "m"}, point.rho, {0.0, 1000.0, "m"});
      },
      Presence::required);
  f.choice("tip", tool.tip, {"flat", "round"}, "tip", "flat, or round with a half ball added beyond the last corner");
  if (f.reads()) {
    check_shape(f.at() + "/profile_m", "an outline from the far end to the tip that does not intersect itself",
                [&tool] { Revolved(tool.profile, tool.tip); });
  }
}

static void describe(Fields& f, BurFields& tool) {
  f.choice("family", tool.family, {"ball", "cylinder", "round_cylinder", "tapered", "inverted_cone", "pear", "flame"},
           "family", "shape of the bur's head", Presence::required);
  f.number("diameter_m", tool.diameter, kLength, "largest diameter of the head", Presence::required);
  f.number("length_m", tool.length, kLength,
           "length of the head, including its round end; null: equal to its diameter");
  f.number(
      "shank_diameter_m", tool.shank_diameter, kLength,
      "diameter of the shank (neck) behind the head; the shank is ten times as long as its diameter; null: 0.6 of the "
      "head's diameter");
  if (f.reads()) check_shape(f.at(), "lengths that suit the family", [&tool] { revolved_of(tool); });
}

static void describe(Fields& f, MeshToolFields& tool) {
  f.file(tool.file, {FileContent::Kind::mesh, {tool.scale, {}}},
         "closed surface as OBJ, PLY, STL or OFF; tip_m and tip_axis give the position and direction of its tip; path "
         "relative to the scenario file");
  f.number("scale", tool.scale, {0.0, 1e6, "m", true},
           "length of one unit of the file in metres: 0.001 for millimetres", Presence::required);
  f.vector3("tip_m", tool.tip, {-1000.0, 1000.0, "m"},
            "position of the tip centre in the file's coordinates, after scaling");
  f.vector3(
      "tip_axis", tool.tip_axis, {-1e9, 1e9, "1"},
      "direction of the tip in the file's coordinates; the smallest rotation maps it to -z, the tool's axis in its "
      "reference orientation");
  f.number("grid_m", tool.grid, kLength,
           "spacing of the grid that stores the signed distances; null: chosen for about 128^3 nodes");
  if (f.reads()) require_direction(tool.tip_axis, f.at() + "/tip_axis");
}

void describe(Fields& f, ToolFields& tool) {
  f.variant(tool, "tool", kToolTypes, Untyped::first);
}

std::vector<std::string> tool_names() {
  return names_of(kToolTypes, &TypeName::name);
}

namespace {

/// Computes the grid of signed distances from a mesh tool's surface, in the tool frame: origin at the tip centre,
/// axis along -z. Throws InputError that names the file if the surface is not closed or the grid would be too
/// large.
std::shared_ptr<const SignedDistanceGrid> make_grid(const MeshToolFields& fields, const NamedFiles& files) {
  // Transform the surface from the file's frame to the tool frame.
  TriangleSoup surface = files.at(kToolFile).mesh().triangles();
  const Mat3 to_file = ToolPose{.position = fields.tip, .axis = fields.tip_axis.normalized()}.rotation();
  for (Vec3& vertex : surface.vertices) vertex = to_file.transpose() * (vertex - fields.tip);
  // Compute the grid.
  try {
    const double spacing = fields.grid.value_or(SignedDistanceGrid::suggested_spacing(surface.vertices));
    return std::make_shared<const SignedDistanceGrid>(ClosedSurface(surface.vertices, surface.triangles), spacing);
  } catch (const std::invalid_argument& error) {
    throw InputError(fmt::format("{}: {}", files.at(kToolFile).path().string(), error.what()));
  }
}

/// Constructs the shape of each type of tool.
struct Make {
  const NamedFiles& files;

  std::shared_ptr<const ToolShape> operator()(const CylinderFields& f) const {
    return std::make_shared<Cylinder>(f.diameter / 2.0, f.length, f.tip);
  }
  std::shared_ptr<const ToolShape> operator()(const RevolvedFields& f) const {
    return std::make_shared<Revolved>(f.profile, f.tip);
  }
  std::shared_ptr<const ToolShape> operator()(const BurFields& f) const {
    return std::make_shared<Revolved>(revolved_of(f));
  }
  std::shared_ptr<const ToolShape> operator()(const MeshToolFields& f) const {
    const std::string content = fmt::format("grid {} {} {} {} {}", files.at(kToolFile).hash(), f.scale,
                                            f.grid.value_or(0.0), fmt::join(f.tip, " "), fmt::join(f.tip_axis, " "));
    const auto bytes = [](const SignedDistanceGrid& grid) { return sizeof(double) * grid.nodes().size(); };
    return std::make_shared<MeshTool>(shared_cache().get<SignedDistanceGrid>(
        content, [&] { return make_grid(f, files); }, bytes));
  }
};

}  // namespace

std::shared_ptr<const ToolShape> make_tool(const Scenario& scenario, const NamedFiles& files) {
  return std::visit(Make{files}, scenario.tool);
}

Cylinder make_cylinder(const ToolFields& fields) {
  if (const auto* f = std::get_if<CylinderFields>(&fields)) return {f->diameter / 2.0, f->length, f->tip};
  const std::vector<std::string> names = tool_names();
  fail_at("/tool/type", fmt::format("got \"{}\"; allowed here: \"{}\"", names[fields.index()], names.front()));
}

}  // namespace hapbench
