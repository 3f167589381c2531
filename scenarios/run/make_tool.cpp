#include "scenarios/run/make_tool.hpp"

#include <fmt/format.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <list>
#include <mutex>
#include <stdexcept>

#include "scenarios/description/descriptions.hpp"
#include "scenarios/input/input_error.hpp"
#include "sim/tool/mesh_tool.hpp"
#include "sim/tool/revolved.hpp"

namespace hapbench {
namespace {

using Grid = std::shared_ptr<const SignedDistanceGrid>;

/// The mesh in the tool's own frame: tip centre at the origin, axis along -z.
TriangleSoup tool_surface(const MeshToolFields& fields, const NamedFiles& files) {
  TriangleSoup surface = files.at(kToolFile).mesh().triangles();
  const Mat3 to_file = ToolPose{.position = fields.tip, .axis = fields.tip_axis.normalized()}.rotation();
  for (Vec3& vertex : surface.vertices) vertex = to_file.transpose() * (vertex - fields.tip);
  return surface;
}

Grid make_grid(const MeshToolFields& fields, const NamedFiles& files) {
  const TriangleSoup surface = tool_surface(fields, files);
  const double spacing = fields.grid.value_or(SignedDistanceGrid::suggested_spacing(surface.vertices));
  try {
    return std::make_shared<const SignedDistanceGrid>(surface.vertices, surface.triangles, spacing);
  } catch (const std::invalid_argument& error) {
    throw InputError(fmt::format("{}: {}", files.at(kToolFile).path().string(), error.what()));
  }
}

/// The grids used last, the very last first: 20 MB each as suggested.
class RecentGrids {
 public:
  Grid of(const MeshToolFields& fields, const NamedFiles& files) {
    const std::string content =
        fmt::format("{} {} {} {} {}", files.at(kToolFile).hash(), fields.scale, fields.grid.value_or(0.0),
                    fmt::join(fields.tip, " "), fmt::join(fields.tip_axis, " "));
    const std::lock_guard lock(mutex_);
    const auto found =
        std::find_if(grids_.begin(), grids_.end(), [&](const auto& known) { return known.first == content; });
    if (found != grids_.end()) {
      grids_.splice(grids_.begin(), grids_, found);
    } else {
      // Isolated, or this thread might take up another run while it waits, and wait for itself at the lock.
      grids_.emplace_front(content, tbb::this_task_arena::isolate([&] { return make_grid(fields, files); }));
      if (grids_.size() > kMost) grids_.pop_back();
    }
    return grids_.front().second;
  }

 private:
  static constexpr std::size_t kMost = 4;
  std::mutex mutex_;
  std::list<std::pair<std::string, Grid>> grids_;
};

struct Make {
  const NamedFiles& files;

  std::shared_ptr<const ToolShape> operator()(const CylinderFields& f) const {
    return std::make_shared<Cylinder>(f.diameter / 2.0, f.length, f.tip);
  }
  std::shared_ptr<const ToolShape> operator()(const RevolvedFields& f) const {
    return std::make_shared<Revolved>(f.profile, f.tip);
  }
  std::shared_ptr<const ToolShape> operator()(const BurFields& f) const {
    const BurProfile bur = profile_of(f);
    return std::make_shared<Revolved>(bur.profile, bur.tip);
  }
  std::shared_ptr<const ToolShape> operator()(const MeshToolFields& f) const {
    static RecentGrids recent;
    return std::make_shared<MeshTool>(recent.of(f, files));
  }
};

}  // namespace

std::shared_ptr<const ToolShape> make_tool(const Scenario& scenario, const NamedFiles& files) {
  return std::visit(Make{files}, scenario.tool);
}

std::shared_ptr<const ToolShape> make_tool(const Scenario& scenario) {
  return make_tool(scenario, NamedFiles(scenario));
}

Cylinder make_cylinder(const ToolFields& fields) {
  if (const auto* f = std::get_if<CylinderFields>(&fields)) return {f->diameter / 2.0, f->length, f->tip};
  const std::vector<std::string> names = tool_names();
  throw InputError(InputError::Kind::relation, "/tool/type",
                   fmt::format("got \"{}\"; allowed here: \"{}\"", names[fields.index()], names.front()));
}

}  // namespace hapbench
