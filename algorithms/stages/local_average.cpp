#include "algorithms/stages/local_average.hpp"
#include "algorithms/parameters.hpp"

#include <algorithm>
#include <stdexcept>
#include <vector>

namespace hapbench {
namespace {

constexpr ParameterInfo kLocalAverageParameters[] = {
    {parameter::kLocalAverage, "switches the stage on"},
};

}  // namespace

const ModelInfo kLocalAverageInfo = {
    .name = "local_average",
    .summary = "colliding points that share a grid cell of the shell become one",
    .formula = "D = mean of d_i u_i over the cell's colliding points; d = |D|, u = D/|D|; dropped when D = 0",
    .source = "thesis C.2 (optional step, off by default)",
    .known_failure = "opposite points in one cell cancel",
    .parameters = kLocalAverageParameters,
};

namespace {

/// The merged contact keeps index, point and normal of the cell's first colliding point, and the merged contacts keep
/// the order in which their cells first appear.
class LocalAverage final : public PointStage {
 public:
  void prepare(const Scene& scene) override {
    if (scene.shell == nullptr || !(scene.shell->cell_size() > 0.0)) {
      throw std::invalid_argument("local_average needs a point shell with a grid");
    }
    cell_of_point_ = scene.shell->cell_of_points();
    std::uint32_t cells = 0;
    for (const std::uint32_t cell : cell_of_point_) cells = std::max(cells, cell + 1);
    slot_of_cell_.assign(cells, kNone);
    sum_.resize(scene.shell->size());
  }

  void process(ContactBuffer& contacts) noexcept override {
    const std::size_t merged = gather(contacts);
    std::size_t kept = 0;
    for (std::size_t slot = 0; slot < merged; ++slot) {
      slot_of_cell_[cell_of_point_[contacts.index[slot]]] = kNone;
      const Vec3 mean = sum_[slot].vector / sum_[slot].count;
      const double depth = mean.norm();
      if (depth == 0.0) continue;
      contacts.copy(slot, kept);
      contacts.depth[kept] = depth;
      contacts.set_gradient(kept, mean / depth);
      ++kept;
    }
    contacts.shrink(kept);
    contacts.pad();
  }

 private:
  static constexpr std::uint32_t kNone = 0xffffffff;
  struct Sum {
    Vec3 vector;
    double count;
  };

  /// Moves each cell's first contact to the front and sums d u per cell; returns the number of cells.
  std::size_t gather(ContactBuffer& contacts) noexcept {
    std::size_t cells = 0;
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      const Vec3 depth_vector = contacts.depth[i] * contacts.gradient(i);
      std::uint32_t& slot = slot_of_cell_[cell_of_point_[contacts.index[i]]];
      if (slot == kNone) {
        slot = static_cast<std::uint32_t>(cells++);
        sum_[slot] = {depth_vector, 1.0};
        contacts.copy(i, slot);
      } else {
        sum_[slot].vector += depth_vector;
        sum_[slot].count += 1.0;
      }
    }
    return cells;
  }

  std::vector<std::uint32_t> cell_of_point_;
  std::vector<std::uint32_t> slot_of_cell_;  ///< kNone between steps
  std::vector<Sum> sum_;
};

}  // namespace

std::unique_ptr<PointStage> make_local_average() {
  return std::make_unique<LocalAverage>();
}

}  // namespace hapbench
