#include "algorithms/laws/exact_shaping.hpp"

#include <Eigen/Cholesky>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "algorithms/registry.hpp"
#include "sim/core/simd.hpp"

namespace hapbench {
namespace {

/// The solver of exact_shaping and merged_shaping: projects the identity onto the cone of the contact tensors.
namespace cone_projection {

using Vec6 = Eigen::Matrix<double, 6, 1>;
using Mat6 = Eigen::Matrix<double, 6, 6>;

constexpr double kEps = kExactShapingEpsilon;
/// Maximum number of Newton steps with the final epsilon, before the solver follows kPath. Nearly all sets of contacts
/// need one or two steps.
constexpr int kDirectSteps = 6;
/// Decreasing values of epsilon, the weight of the regularisation. The solver uses one value after the other if it has
/// not converged after kDirectSteps steps with the final epsilon (see solve).
constexpr double kPath[] = {1e-2, 1e-4, kEps};
/// Maximum number of Newton steps for each value of kPath; never reached in exact arithmetic.
constexpr int kMaxNewtonSteps = 1000;
constexpr int kMaxLineSearchSteps = 40;
constexpr int kMaxRefinements = 5;
/// A residual of the optimality condition up to this value counts as rounding error. The residual contains S, whose
/// rounding error has this size: S is the sum of up to n terms of at most 1 each, added in eight partial sums.
constexpr double kResidualRounding = 1e-14;

/// The identity tensor in the basis of TensorPack.
const Vec6& identity6() {
  static const Vec6 identity = (Vec6() << 1, 1, 1, 0, 0, 0).finished();
  return identity;
}

/// Eight symmetric tensors a_i in the orthonormal basis (xx, yy, zz, sqrt2 xy, sqrt2 xz, sqrt2 yz). In this
/// basis, the Frobenius product of two tensors is the dot product of their six-vectors.
struct TensorPack {
  simd::Pack a[6];

  simd::Pack dot(const Vec6& w) const {
    return ((a[0] * simd::Pack(w[0]) + a[1] * simd::Pack(w[1])) + (a[2] * simd::Pack(w[2]) + a[3] * simd::Pack(w[3]))) +
           (a[4] * simd::Pack(w[4]) + a[5] * simd::Pack(w[5]));
  }
};

// The cone consists of the sums of tensors a_i with weights c_i >= 0. The functions below get the tensors as an object
// of a class of this form:
//
//   struct Tensors { std::size_t size, padded_size; double* weight; TensorPack pack(std::size_t i) const; };
//
// The object contains `size` tensors of trace 1, and one weight for each tensor. `pack(i)` returns the eight tensors
// from index i on. Tensors and weights are padded to whole packs with zeros.

/// Sums over the tensors and their weights c_i.
struct TensorSums {
  Mat6 G;            ///< sum a_i a_i^T over the active tensors (c_i > 0)
  Vec6 S;            ///< sum c_i a_i
  bool same_active;  ///< true if the last change of the weights made no tensor active or inactive
};

/// Sets the weight of every tensor to c_i = max(0, weight_of(a_i, previous c_i)) and returns the sums.
template <class Tensors, class WeightOf>
TensorSums update_weights(const Tensors& tensors, WeightOf weight_of) noexcept {
  using simd::Pack;
  Pack g[21], s[6];
  std::fill(std::begin(g), std::end(g), Pack(0.0));
  std::fill(std::begin(s), std::end(s), Pack(0.0));
  const Pack zero(0.0), one(1.0);
  bool same = true;
  for (std::size_t i = 0; i < tensors.padded_size; i += simd::lanes) {
    const TensorPack u = tensors.pack(i);
    const Pack c_before = simd::load(tensors.weight + i);
    const Pack t = weight_of(u, c_before);
    const simd::Mask active = t > zero, before = c_before > zero;
    same = same && !simd::any((active && !before) || (before && !active));
    const Pack c = simd::select(active, t, zero), on = simd::select(active, one, zero);
    simd::store(c, tensors.weight + i);
    for (int j = 0, k = 0; j < 6; ++j) {
      s[j] += c * u.a[j];
      const Pack masked = on * u.a[j];
      for (int l = 0; l <= j; ++l) g[k++] += masked * u.a[l];
    }
  }
  TensorSums sums;
  sums.same_active = same;
  for (int j = 0, k = 0; j < 6; ++j) {
    sums.S[j] = simd::sum(s[j]);
    for (int l = 0; l <= j; ++l) sums.G(j, l) = sums.G(l, j) = simd::sum(g[k++]);
  }
  return sums;
}

/// Sets the weights c_i = max(0, a_i . w) that belong to the point w of the dual problem, and returns the sums.
template <class Tensors>
TensorSums evaluate_at(const Tensors& tensors, const Vec6& w) noexcept {
  return update_weights(tensors, [&w](const TensorPack& u, const simd::Pack&) { return u.dot(w); });
}

/// Returns (eps I + G)^-1 b.
Vec6 solve_step(const Mat6& G, double eps, const Vec6& b) noexcept {
  return Eigen::LDLT<Mat6>(G + eps * Mat6::Identity()).solve(b);
}

/// Returns the gradient of the convex dual function ½|eps w - I|² / eps + ½ sum max(0, a_i . w)². It is zero at
/// the optimum.
Vec6 dual_gradient(const Vec6& w, double eps, const TensorSums& sums) noexcept {
  return eps * w - identity6() + sums.S;
}

/// Line search by bisection: moves w to `target` if the dual function still decreases there. Otherwise moves w towards
/// `target` to a point where the slope of the dual function along this line is at most half of `slope_at_w`, the slope
/// at the start (both as absolute values). The function is convex and piecewise quadratic, so its slope is monotone.
/// The line search decreases the function, and Newton's method therefore converges from any start. On entry `sums`
/// holds the sums at `target`, on return the sums at the new w. Returns false if kMaxLineSearchSteps bisections find no
/// such point; `slope_at_w` is then only rounding.
template <class Tensors>
bool line_search(const Tensors& tensors, const Vec6& target, double eps, double slope_at_w, Vec6& w,
                 TensorSums& sums) noexcept {
  const Vec6 start = w, direction = target - w;
  w = target;
  double low = 0.0, high = 1.0, fraction = 1.0;
  for (int i = 0; i < kMaxLineSearchSteps; ++i) {
    const double slope = dual_gradient(w, eps, sums).dot(direction);
    const bool still_descending_at_target = fraction == 1.0 && slope <= 0.0;
    if (still_descending_at_target || std::abs(slope) <= 0.5 * std::abs(slope_at_w)) return true;
    (slope > 0.0 ? high : low) = fraction;
    fraction = 0.5 * (low + high);
    w = start + fraction * direction;
    sums = evaluate_at(tensors, w);
  }
  return false;
}

/// Newton's method for one epsilon. On entry `sums` holds the sums at w; updates w and `sums`. Adds the number of
/// steps to `steps`. Returns true if the method has converged up to rounding.
template <class Tensors>
bool newton(const Tensors& tensors, double eps, int max_steps, Vec6& w, TensorSums& sums, int& steps) noexcept {
  const double n = static_cast<double>(tensors.size);
  for (int step = 0; step < max_steps; ++step) {
    ++steps;
    // With a fixed active set the dual function is quadratic, and its minimum solves (eps I + G) w = identity.
    const Vec6 target = solve_step(sums.G, eps, identity6());
    const double slope = dual_gradient(w, eps, sums).dot(target - w);
    sums = evaluate_at(tensors, target);
    // A contact whose exact weight is zero may change between active and inactive because a_i . target is rounded.
    const double rounding = 1e-15 * (1.0 + n) * (1.0 + target.norm());
    const bool flickers_only = sums.same_active || dual_gradient(target, eps, sums).norm() <= rounding;
    // In exact arithmetic the slope is negative before the optimum. A slope >= 0 is therefore only rounding.
    if (flickers_only || slope >= 0.0) {
      w = target;
      return true;
    }
    if (!line_search(tensors, target, eps, slope, w, sums)) return true;
  }
  return false;
}

/// Removes the rounding error of the last solve, which the factor 1/eps has amplified: adds the correction
/// (eps I + G)^-1 R to w, with the residual R of the optimality condition. Adds the small product a_i . correction to
/// each positive weight c_i; computing the weight again as a_i . w would lose digits.
template <class Tensors>
void refine(const Tensors& tensors, Vec6 w, TensorSums sums) noexcept {
  const simd::Pack zero(0.0);
  for (int round = 0; round < kMaxRefinements; ++round) {
    const Vec6 residual = -dual_gradient(w, kEps, sums);
    if (residual.norm() <= kResidualRounding) return;
    const Vec6 correction = solve_step(sums.G, kEps, residual);
    w += correction;
    sums = update_weights(tensors, [&](const TensorPack& u, const simd::Pack& c) {
      return simd::select(c > zero, c + u.dot(correction), u.dot(w));
    });
  }
}

/// Computes weights as solve_exact_shaping() does, but for any tensors a_i of trace 1 in place of u_i u_i^T, with S =
/// sum c_i a_i and rho_i = <a_i, S>. Returns the number of Newton steps. Precondition: all weights are 1.
template <class Tensors>
int solve(const Tensors& tensors) noexcept {
  // Start at w = identity. A tensor a_i is active if a_i . w > 0. Every tensor is active, because a_i . identity is the
  // trace of a_i, which is 1.
  Vec6 w = identity6();
  TensorSums sums = evaluate_at(tensors, w);
  int steps = 0;
  if (!newton(tensors, kEps, kDirectSteps, w, sums, steps)) {
    // The direct steps do not converge for dense clusters of nearly equal gradients. The optimum gives positive weights
    // to a few of hundreds of contacts, and Newton's method would find these contacts one by one. Following the optimum
    // from a large epsilon to a small epsilon takes a few steps for each epsilon. Measured total number of steps: at
    // most 32 for 6e6 adversarial sets of contacts, and at most 135 for 1e6 mixtures of such sets. With direct steps
    // alone, an adversarial set takes about a hundred steps.
    double eps = kPath[0];
    w = identity6() / eps;
    sums = evaluate_at(tensors, w);
    for (const double next : kPath) {
      // Keep the product eps w at the next epsilon: w and the sums S scale by eps / next, and the active set stays.
      w *= eps / next;
      sums.S *= eps / next;
      eps = next;
      newton(tensors, eps, kMaxNewtonSteps, w, sums, steps);
    }
  }
  refine(tensors, w, sums);
  return steps;
}

}  // namespace cone_projection

using simd::load, simd::Pack;

/// The tensors u u^T of the contacts.
struct GradientTensors {
  const ContactBuffer& contacts;
  std::size_t size, padded_size;
  double* weight;

  cone_projection::TensorPack pack(std::size_t i) const {
    const Pack x = load(&contacts.ux[i]), y = load(&contacts.uy[i]), z = load(&contacts.uz[i]);
    const Pack root2(std::numbers::sqrt2);
    return {{x * x, y * y, z * z, root2 * x * y, root2 * x * z, root2 * y * z}};
  }
};

class ExactShaping final : public ForceLaw {
 public:
  using ForceLaw::ForceLaw;

  LawForce evaluate(ContactBuffer& contacts) noexcept override {
    iterations_ += static_cast<std::uint64_t>(solve_exact_shaping(contacts));
    return weighted_force(contacts, K_);
  }
};

/// Number of cells along each edge of a cube whose faces are divided into square cells. A direction belongs to the cell
/// that a ray from the cube's centre in this direction crosses. 15 cells along each edge give 1350 cells of about 6
/// degrees, the angle up to which the point reduction counts gradients as similar by default. The number is odd, so
/// that the coordinate axes cross the middle of cells.
constexpr int kDirectionCells = 15;

constexpr std::size_t kFaces = 6, kCells = kFaces * kDirectionCells * kDirectionCells;

/// Returns the index along one edge of a face, from 0 to kDirectionCells - 1, of the cells that contain `tangent`.
/// `tangent` is the position along this edge, in [-1, 1]: a component of the direction, divided by the magnitude of the
/// largest component.
std::size_t edge_cell(double tangent) noexcept {
  // The negated comparison is true also for NaN, which gets the cell 0.
  const double position = 0.5 * kDirectionCells * (tangent + 1.0);
  if (!(position > 0.0)) return 0;
  return position < kDirectionCells ? static_cast<std::size_t>(position) : kDirectionCells - 1;
}

/// Returns the index of the cell that the direction (x, y, z) crosses, in [0, kCells).
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
  return (side * kDirectionCells + edge_cell(u * scale)) * kDirectionCells + edge_cell(v * scale);
}

using PerCell = std::array<double, simd::padded(kCells)>;

/// The tensors of the groups, each divided by its trace, in the order of the cells. Each of the six tensor components
/// has its own array.
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

/// Exact shaping of groups of contacts. Unlike the point reduction, it drops no contact, and its result does not depend
/// on the order of the contacts.
///
/// The sphere of directions is divided into 1350 fixed cells, kDirectionCells x kDirectionCells on each face of
/// a cube. Contacts whose gradients lie in the same cell form a group k and share a weight c_k. A group acts by
/// its exact tensor and its exact depth vector; see the formula of merged_shaping_entry.
///
/// In each group with positive weight, the mean stiffness ratio is 1. As for exact_shaping, lambda_max(S) <= (1
/// + sqrt 3)/2; the proof needs tensors of trace 1, not of rank 1. With one contact in each group the law
/// equals exact_shaping. Contacts with nearly equal gradients on both sides of a cell's border form two groups, and the
/// weight is divided between the two. O(n) once, then O(groups) for each Newton step.
class MergedShaping final : public ForceLaw {
 public:
  explicit MergedShaping(const RenderingConfig& config) : ForceLaw(config) { groups_.weight = weight_.data(); }

  void prepare(std::size_t capacity) override {
    cell_.resize(capacity);
    touched_.reserve(kCells);
  }

  LawForce evaluate(ContactBuffer& contacts) noexcept override {
    gather(contacts);
    make_groups();
    iterations_ += static_cast<std::uint64_t>(cone_projection::solve(groups_));
    for (std::size_t k = 0; k < groups_.size; ++k) group_weight_[touched_[k]] = weight_[k] / trace_[k];
    for (std::size_t i = 0; i < contacts.size(); ++i) contacts.weight[i] = group_weight_[cell_[i]];
    contacts.pad();
    return weighted_force(contacts, K_);
  }

 private:
  /// Sums u u^T over the contacts of each cell, and lists the cells that have contacts.
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

  /// Creates one group from each cell in touched_, and resets the sums of the cell.
  void make_groups() noexcept {
    groups_.size = touched_.size();
    for (std::size_t k = 0; k < groups_.size; ++k) {
      CellSum& cell = cells_[touched_[k]];
      const double trace = cell.tensor[0] + cell.tensor[1] + cell.tensor[2];
      // A cell that contains only zero gradients has a zero tensor. The weight of its group then has no effect.
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
  std::vector<std::uint16_t> cell_;  ///< cell of each contact
  std::vector<CellSum> cells_ = std::vector<CellSum>(kCells);
  std::vector<std::uint16_t> touched_;  ///< indices of the cells that have contacts, ascending; one group for each
  PerCell group_weight_{};              ///< c_k of each cell
  PerCell trace_{};
  alignas(64) PerCell weight_{};  ///< C_k = c_k tr T_k of each group
  Groups groups_;
};

/// Bound of |f_spring| / K: |f_spring| / K <= sum c_i d_i <= d sum c_i = d tr S, with the weights c_i, the depths d_i,
/// the largest depth d and the stiffness tensor S. At the optimum tr S >= |S|^2_F (Frobenius norm), and always
/// |S|^2_F >= (tr S)^2 / 3, so tr S <= 3.
constexpr auto* kBound = bound_of_springs<3>;

}  // namespace

int solve_exact_shaping(ContactBuffer& contacts) noexcept {
  set_weights(contacts, 1.0);
  return cone_projection::solve(
      GradientTensors{contacts, contacts.size(), contacts.padded_size(), contacts.weight.data()});
}

AlgorithmEntry exact_shaping_entry() {
  static constexpr ModelInfo kInfo = {
      .name = "exact_shaping",
      .summary = "the limit of the shaping iteration, computed exactly",
      .formula =
          "c = argmin ½|S - I|²_F + (epsilon/2)|c|² over c >= 0, epsilon = 1e-6: the projection of the identity onto "
          "the cone of contact tensors u u^T",
      .source =
          "not in the thesis; the iteration is the multiplicative update of Sha, Lin, Saul, Lee, Neural Computation "
          "2007",
      .known_failure =
          "the force jumps when contacts appear or disappear, by more than with shaped_stiffness; ratios above 1 where "
          "the weight is zero; soft in the direction out of a wedge, 2 sin^2 w / (1 + cos^2 2w) K for half angle w, "
          "about w^2 K",
      .parameters = kStiffnessAlone,
  };
  return {.info = &kInfo, .make_law = law_of<ExactShaping>, .force_bound = kBound};
}

AlgorithmEntry merged_shaping_entry() {
  static constexpr ModelInfo kInfo = {
      .name = "merged_shaping",
      .summary =
          "exact shaping of groups of contacts with similar gradients, each group with its whole tensor and depth "
          "vector",
      .formula =
          "groups: 1350 fixed cells of directions; S = sum c_k T_k, T_k = sum u u^T, f = -K sum c_k sum d u; C_k = c_k "
          "tr T_k = argmin ½|S - I|²_F + (epsilon/2)|C|² over C >= 0, epsilon = 1e-6",
      .source = "not in the thesis; replaces the reduction of thesis C.3 and 4.1; always without reduction",
      .known_failure =
          "contacts of a group share a weight, so that single ratios deviate from 1 by about the square of a cell's "
          "angle; the force jumps when a gradient moves from one cell to another",
      .parameters = kStiffnessAlone,
  };
  return {.info = &kInfo, .make_law = law_of<MergedShaping>, .force_bound = kBound, .may_reduce = false};
}

}  // namespace hapbench
