#include "sim/contact/most_points.hpp"

#include <algorithm>
#include <cmath>

#include "sim/contact/grid_index.hpp"

namespace hapbench {
namespace {

/// Replaces each of `count` numbers, `stride` apart, by the sum of those from it to `window` - 1 further on.
void sum_windows(std::uint32_t* first, std::size_t count, std::size_t stride, std::size_t window) {
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t k = 1; k < window && i + k < count; ++k) first[i * stride] += first[(i + k) * stride];
  }
}

}  // namespace

std::size_t most_points_in(const PointShell& shell, const ToolShape::Cover& cover) {
  if (shell.size() == 0) return 0;
  // A little larger than the ball's radius, so that an interval as long as the ball meets three cells at most.
  const GridCells cells = GridCells::of_edge(shell.bounds(), shell.size(), cover.radius * (1.0 + 1e-6));
  const auto window = static_cast<std::size_t>(std::floor(2.0 * cover.radius / cells.size())) + 2;
  std::vector<std::uint32_t> points(cells.count());
  for (std::size_t i = 0; i < shell.size(); ++i) ++points[cells.cell_of(shell.point(i).position)];
  const std::size_t nx = cells.count(0), ny = cells.count(1), nz = cells.count(2);
  for (std::size_t column = 0; column < nx * ny; ++column) sum_windows(&points[column * nz], nz, 1, window);
  for (std::size_t i = 0; i < nx; ++i) {
    for (std::size_t k = 0; k < nz; ++k) sum_windows(&points[i * ny * nz + k], ny, nz, window);
  }
  for (std::size_t k = 0; k < ny * nz; ++k) sum_windows(&points[k], nx, ny * nz, window);
  return std::min(shell.size(), cover.balls * *std::max_element(points.begin(), points.end()));
}

}  // namespace hapbench
