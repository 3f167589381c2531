#include "scenarios/run/open_edges.hpp"

#include <fmt/format.h>

#include "scenarios/run/quantity_text.hpp"
#include "sim/contact/grid_index.hpp"

namespace hapbench {

OpenEdgeObserver::OpenEdgeObserver(const PointShell& shell, const std::vector<Vec3>& edges, double reach)
    : reach_(reach), is_near_edge_(shell.size(), false) {
  const GridIndex grid(shell);
  const Vec3 half = Vec3::Constant(reach);
  for (const Vec3& edge : edges) {
    const Box box{edge - half, edge + half};
    grid.for_each_run(box, [&](std::uint32_t first, std::uint32_t last) {
      for (std::uint32_t i = first; i < last; ++i) {
        const Vec3 point(grid.x()[i], grid.y()[i], grid.z()[i]);
        if (distance_to(box, point) == 0.0) is_near_edge_[grid.shell_index(i)] = true;
      }
    });
  }
}

void OpenEdgeObserver::on_step(const StepRecord& record) noexcept {
  const ContactBuffer& contacts = *record.rendered;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    if (!is_near_edge_[contacts.index[i]]) continue;
    if (rows_ == 0) {
      first_time_ = record.time;
      first_place_ = contacts.point(i);
    }
    ++rows_;
    return;
  }
}

std::optional<std::string> OpenEdgeObserver::warning() const {
  if (rows_ == 0) return std::nullopt;
  const Vec3 p = 1e3 * first_place_;
  return fmt::format(
      "touched the mesh within {} of where it is open in {} rows, first at {:.4g} s near ({:.3g}, {:.3g}, {:.3g}) mm: "
      "beyond the edge there is no surface",
      length_text(reach_), rows_, first_time_, p.x(), p.y(), p.z());
}

}  // namespace hapbench
