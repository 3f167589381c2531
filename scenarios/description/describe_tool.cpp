#include <fmt/format.h>

#include <stdexcept>

#include "scenarios/description/descriptions.hpp"
#include "scenarios/input/input_error.hpp"
#include "sim/tool/revolved.hpp"

namespace hapbench {
namespace {

constexpr std::size_t kMostCorners = 1000;  // of a profile; each costs every step

/// In the order of the variant.
constexpr std::array kToolTypes = {"cylinder", "revolved", "bur", "mesh"};

constexpr Choice<Tip> kTips[] = {{"flat", Tip::flat}, {"round", Tip::round}};
constexpr Choice<BurFamily> kFamilies[] = {
    {"ball", BurFamily::ball},
    {"cylinder", BurFamily::cylinder},
    {"round_cylinder", BurFamily::round_cylinder},
    {"tapered", BurFamily::tapered},
    {"inverted_cone", BurFamily::inverted_cone},
    {"pear", BurFamily::pear},
    {"flame", BurFamily::flame},
};

/// What the shape has to say against its fields, at `at`.
template <class Make>
void check_shape(const std::string& at, const char* allowed, const Make& make) {
  try {
    make();
  } catch (const std::invalid_argument& error) {
    throw InputError(InputError::Kind::relation, at, fmt::format("{}; allowed: {}", error.what(), allowed));
  }
}

}  // namespace

static void describe(Fields& f, ProfilePoint& point) {
  f.pair(
      "two numbers [s, rho]: along the axis from the tip centre, and from the axis [m]",
      [&point](Fields& s) {
        s.number(point.s, {-1000.0, 1000.0, "m"});
      },
      [&point](Fields& rho) {
        rho.number(point.rho, {0.0, 1000.0, "m"});
      });
}

static void describe(Fields& f, CylinderFields& tool) {
  f.number("diameter_m", tool.diameter, kLength, "diameter of the cylinder; default 0.001", Presence::no_default);
  f.number("length_m", tool.length, kLength, "from the tip plane to the bottom; default 0.005 in hole_2d, else 0.01",
           Presence::no_default);
  f.choice("tip", tool.tip, kTips, "tip", "round adds a half ball; default round in hole_2d, else flat",
           Presence::no_default);
}

static void describe(Fields& f, RevolvedFields& tool) {
  f.list(
      "profile_m", tool.profile, {2, kMostCorners},
      "corners [s, rho] of the outline beside the axis, from the far end to the tip: s <= 0 along the axis from the tip "
      "centre, rho from the axis",
      [](Fields& p, ProfilePoint& point) { describe(p, point); }, Presence::required);
  f.choice("tip", tool.tip, kTips, "tip", "round adds a half ball beyond the last corner");
  if (f.reads()) {
    check_shape(f.at() + "/profile_m", "an outline from the far end to the tip that does not meet itself",
                [&tool] { Revolved(tool.profile, tool.tip); });
  }
}

static void describe(Fields& f, BurFields& tool) {
  f.choice("family", tool.family, kFamilies, "family", "shape of the head", Presence::required);
  f.number("diameter_m", tool.diameter, kLength, "of the head, where it is widest", Presence::required);
  f.number("length_m", tool.length, kLength, "of the head, its round end included; null: its diameter");
  f.number("shank_diameter_m", tool.shank_diameter, kLength,
           "of the shank, or neck, behind the head, which is ten times as long; null: 0.6 of the head's");
  if (!f.reads()) return;
  check_shape(f.at(), "lengths that suit the family", [&tool] {
    const BurProfile bur = profile_of(tool);
    Revolved(bur.profile, bur.tip);
  });
}

static void describe(Fields& f, MeshToolFields& tool) {
  f.file(tool.file, {FileContent::Kind::mesh, {tool.scale, {}}},
         "closed surface as OBJ, PLY, STL or OFF, its tip where tip_m and tip_axis say; relative to the scenario file");
  f.number("scale", tool.scale, {0.0, 1e6, "m", true}, "length of the file's unit: 0.001 for millimetres",
           Presence::required);
  f.vector3("tip_m", tool.tip, {-1000.0, 1000.0, "m"}, "place in the file, scaled, that is the tip centre");
  f.vector3("tip_axis", tool.tip_axis, {-1e9, 1e9, "1"},
            "where the tip points in the file; the least turn takes it to -z, where the tool's axis points unturned");
  f.number("grid_m", tool.grid, kLength,
           "spacing of the grid that holds the signed distances; null: such that it has about 128^3 nodes");
  if (f.reads()) require_direction(tool.tip_axis, f.at() + "/tip_axis");
}

void describe(Fields& f, ToolFields& tool) {
  f.variant(
      tool, "tool", kToolTypes, [](Fields& t, auto& fields) { describe(t, fields); }, Untyped::first);
}

std::vector<std::string> tool_names() {
  return {kToolTypes.begin(), kToolTypes.end()};
}

}  // namespace hapbench
