#include "algorithms/laws/merged_shaping.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "algorithms/laws/cone_projection.hpp"

namespace hapbench {
namespace {

constexpr ParameterInfo kMergedShapingParameters[] = {kStiffnessParameter};

}  // namespace

const ModelInfo kMergedShapingInfo = {
    .name = "merged_shaping",
    .summary =
        "exact shaping of groups of contacts with similar gradients, each with its whole tensor and depth vector",
    .formula =
        "groups: 1350 fixed cells of directions; S = sum c_k T_k, T_k = sum u u^T, f = -K sum c_k sum d u; C_k = c_k "
        "tr "
        "T_k "
        "= argmin ½|S - I|²_F + (epsilon/2)|C|² over C >= 0, epsilon = 1e-6",
    .source = "ours, instead of the reduction of thesis C.3 and 4.1; takes no reduction",
    .known_failure =
        "contacts of a group share a weight, so single ratios stray from 1 by about the square of a cell's angle; a "
        "cell's "
        "border is a jump for a gradient that turns across it",
    .parameters = kMergedShapingParameters,
};

namespace {

constexpr std::size_t kFaces = 6, kCells = kFaces * kDirectionCells * kDirectionCells;

std::size_t step_of(double tangent) noexcept {
  // Written so that a NaN lands in the grid as well.
  const double place = 0.5 * kDirectionCells * (tangent + 1.0);
  if (!(place > 0.0)) return 0;
  return place < kDirectionCells ? static_cast<std::size_t>(place) : kDirectionCells - 1;
}

/// The cell a direction lies in: the cube's face that it leaves through, and where.
std::size_t cell_of(double x, double y, double z) noexcept {
  const double ax = std::abs(x), ay = std::abs(y), az = std::abs(z);
  std::size_t face = 0;
  double major = x, u = y, v = z;
  if (ay > ax && ay >= az) {
    face = 1;
    major = y;
    u = x;
  } else if (az > ax && az > ay) {
    face = 2;
    major = z;
    u = x;
    v = y;
  }
  const double scale = 1.0 / std::abs(major);
  const std::size_t side = 2 * face + (major < 0.0);
  return (side * kDirectionCells + step_of(u * scale)) * kDirectionCells + step_of(v * scale);
}

using PerCell = std::array<double, simd::padded(kCells)>;

/// The tensors of the groups divided by their traces, in the order of the cells, one column for each component.
struct Groups {
  std::size_t size = 0, padded_size = 0;
  double* weight = nullptr;
  alignas(64) std::array<PerCell, 6> component{};

  cone_projection::TensorPack pack(std::size_t i) const {
    cone_projection::TensorPack tensors;
    for (std::size_t j = 0; j < 6; ++j) tensors.a[j] = simd::load(&component[j][i]);
    return tensors;
  }
};

class MergedShaping final : public ForceLaw {
 public:
  explicit MergedShaping(double stiffness) : ForceLaw(stiffness) { groups_.weight = weight_.data(); }

  void prepare(std::size_t capacity) override {
    cell_.resize(capacity);
    touched_.reserve(kCells);
  }

  LawForce evaluate(ContactBuffer& contacts) noexcept override {
    gather(contacts);
    make_groups();
    iterations_ += static_cast<std::uint64_t>(cone_projection::solve(groups_));
    for (std::size_t k = 0; k < groups_.size; ++k) share_[touched_[k]] = weight_[k] / trace_[k];
    for (std::size_t i = 0; i < contacts.size(); ++i) contacts.weight[i] = share_[cell_[i]];
    contacts.pad();
    return weighted_force(contacts, K_);
  }

 private:
  /// Sums u u^T over each cell, and lists the cells that have any.
  void gather(const ContactBuffer& contacts) noexcept {
    touched_.clear();
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      const double x = contacts.ux[i], y = contacts.uy[i], z = contacts.uz[i];
      cell_[i] = static_cast<std::uint16_t>(cell_of(x, y, z));
      CellSum& cell = cells_[cell_[i]];
      if (!cell.touched) touched_.push_back(cell_[i]);
      cell.touched = true;
      cell.tensor[0] += x * x;
      cell.tensor[1] += y * y;
      cell.tensor[2] += z * z;
      cell.tensor[3] += x * y;
      cell.tensor[4] += x * z;
      cell.tensor[5] += y * z;
    }
    // Sorted, so that the groups do not depend on the order of the contacts.
    std::sort(touched_.begin(), touched_.end());
  }

  /// Makes one group of each cell and sets the cell's sums back to zero.
  void make_groups() noexcept {
    groups_.size = touched_.size();
    for (std::size_t k = 0; k < groups_.size; ++k) {
      CellSum& cell = cells_[touched_[k]];
      const double trace = cell.tensor[0] + cell.tensor[1] + cell.tensor[2];
      // A cell that holds zero gradients only has a zero tensor, and its weight has no effect.
      const double scale = trace > 0.0 ? 1.0 / trace : 0.0;
      trace_[k] = trace > 0.0 ? trace : 1.0;
      weight_[k] = 1.0;
      for (std::size_t j = 0; j < 6; ++j) {
        groups_.component[j][k] = cell.tensor[j] * scale * (j < 3 ? 1.0 : std::numbers::sqrt2);
      }
      cell = {};
    }
    groups_.padded_size = simd::padded(groups_.size);
    for (std::size_t k = groups_.size; k < groups_.padded_size; ++k) {
      weight_[k] = 0.0;
      for (PerCell& column : groups_.component) column[k] = 0.0;
    }
  }

  struct CellSum {
    std::array<double, 6> tensor{};
    bool touched = false;
  };
  std::vector<std::uint16_t> cell_;  ///< of each contact
  std::vector<CellSum> cells_ = std::vector<CellSum>(kCells);
  std::vector<std::uint16_t> touched_;  ///< the groups' cells, ascending
  PerCell share_{};                     ///< c_k of the cell's group
  PerCell trace_{};
  alignas(64) PerCell weight_{};  ///< C_k
  Groups groups_;
};

}  // namespace

std::unique_ptr<ForceLaw> make_merged_shaping(const RenderingConfig& config) {
  return std::make_unique<MergedShaping>(config.stiffness);
}

}  // namespace hapbench
