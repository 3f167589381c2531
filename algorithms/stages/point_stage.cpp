#include "algorithms/stages/point_stage.hpp"

#include <algorithm>
#include <bit>
#include <numeric>
#include <vector>

#include "sim/core/random.hpp"
#include "sim/core/simd.hpp"
#include "sim/tool/refuse.hpp"

namespace hapbench {

constexpr ParameterInfo kLocalAverageParameters[] = {
    {parameter::kLocalAverage, "switches the stage on"},
};
constexpr ParameterInfo kReductionParameters[] = {
    {parameter::kThreshold, "alpha_TH: gradients with an inner product above this value count as similar"},
    {parameter::kMaxPoints, "n_ext: largest number of kept points; further points are dropped and counted"},
    {parameter::kShuffleSeed, "visit the shell points in a fixed random order instead of ascending index"},
};

const ModelInfo kLocalAverageInfo = {
    .name = "local_average",
    .summary = "merges the colliding points of one grid cell of the shell into one",
    .formula = "D = mean of d_i u_i over the cell's colliding points; d = |D|, u = D/|D|; dropped when D = 0",
    .source = "thesis C.2 (optional step, off by default)",
    .known_failure = "opposite points in one cell cancel",
    .parameters = kLocalAverageParameters,
};

const ModelInfo kGradientReductionInfo = {
    .name = "reduction",
    .summary = "keeps, of colliding points with similar gradients, only the deepest",
    .formula =
        "visit contacts in order; the first kept k with <u_i, u_k> > alpha_TH absorbs i (replaced if d_i > d_k); "
        "none similar: append, or drop when n_ext are kept",
    .source =
        "thesis C.3, 2.8; algorithm C.1 as printed appends replaced points and continues comparing after a similar "
        "one, which is probably a misprint",
    .known_failure = "depends on the order of the points; collapses gradually curved surfaces (thesis 4.1)",
    .parameters = kReductionParameters,
};

namespace {

/// Merges the contacts of each grid cell into one contact. The merged contact has the index, point and normal of the
/// first colliding point of its cell. Merged contacts are in the order in which their cells first appear.
class LocalAverage final : public PointStage {
 public:
  void prepare(const Scene& scene) override {
    if (scene.shell == nullptr || !(scene.shell->cell_size() > 0.0))
      refuse("local_average needs a point shell with a grid");
    cell_of_point_ = scene.shell->cell_of_points();
    std::uint32_t cells = 0;
    for (const std::uint32_t cell : cell_of_point_) cells = std::max(cells, cell + 1);
    slot_of_cell_.assign(cells, kNone);
    count_.assign(simd::padded(cells), 1.0);
  }

  void process(ContactBuffer& contacts) noexcept override {
    const std::size_t merged = gather(contacts);
    for (std::size_t slot = 0; slot < merged; ++slot) slot_of_cell_[cell_of_point_[contacts.index[slot]]] = kNone;
    contacts.shrink(merged);
    const bool any_cancelled = average(contacts);
    if (any_cancelled) drop_cancelled(contacts);
    contacts.pad();
  }

 private:
  static constexpr std::uint32_t kNone = 0xffffffff;

  /// Moves the first contact of each cell to the front, stores the cell's sum of d u as the gradient of this contact,
  /// and returns the number of cells. Points of a cell are mostly consecutive, so their sum stays in registers.
  std::size_t gather(ContactBuffer& contacts) noexcept {
    const auto depth_vector = [&](std::size_t i) { return Vec3(contacts.depth[i] * contacts.gradient(i)); };
    std::size_t cells = 0;
    for (std::size_t i = 0; i < contacts.size();) {
      const std::uint32_t cell = cell_of_point_[contacts.index[i]];
      std::uint32_t& slot = slot_of_cell_[cell];
      Vec3 sum = depth_vector(i);
      double count = 1.0;
      if (slot == kNone) {
        slot = static_cast<std::uint32_t>(cells++);
        if (slot != i) contacts.copy(i, slot);
      } else {
        sum = contacts.gradient(slot) + sum;
        count += count_[slot];
      }
      for (++i; i < contacts.size() && cell_of_point_[contacts.index[i]] == cell; ++i) {
        sum += depth_vector(i);
        count += 1.0;
      }
      contacts.set_gradient(slot, sum);
      count_[slot] = count;
    }
    return cells;
  }

  /// Turns the sums into depths and gradients. Returns true if at least one contact has depth zero and therefore an
  /// undefined gradient.
  bool average(ContactBuffer& contacts) const noexcept {
    using simd::load, simd::Pack, simd::store;
    unsigned cancelled = 0;
    for (std::size_t i = 0; i < contacts.size(); i += simd::lanes) {
      const Pack count = load(&count_[i]);
      const Pack x = load(&contacts.ux[i]) / count, y = load(&contacts.uy[i]) / count,
                 z = load(&contacts.uz[i]) / count;
      const Pack depth = simd::sqrt(x * x + (y * y + z * z));  // additions in the order of Vec3::norm
      const std::size_t n = std::min(simd::lanes, contacts.size() - i);
      cancelled |= simd::bits(depth <= Pack(0.0)) & (0xffu >> (simd::lanes - n));
      store(depth, &contacts.depth[i]);
      store(x / depth, &contacts.ux[i]);
      store(y / depth, &contacts.uy[i]);
      store(z / depth, &contacts.uz[i]);
    }
    return cancelled != 0;
  }

  static void drop_cancelled(ContactBuffer& contacts) noexcept {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < contacts.size(); ++i)
      if (contacts.depth[i] != 0.0) contacts.copy(i, kept++);
    contacts.shrink(kept);
  }

  std::vector<std::uint32_t> cell_of_point_;
  /// Position of each cell's merged contact in the buffer; kNone between steps.
  std::vector<std::uint32_t> slot_of_cell_;
  /// Number of contacts that each merged contact replaces, by the position of the merged contact in the buffer.
  AlignedDoubles count_;
};

/// Keeps the deepest of the contacts with similar gradients by a greedy filter (kGradientReductionInfo). Takes O(n *
/// kept) inner products.
class GradientReduction final : public PointStage {
 public:
  explicit GradientReduction(const ReductionConfig& config) : config_(config) {}

  void prepare(const Scene& scene) override {
    if (!config_.shuffle_seed) return;
    // rank_[i] is the position of shell point or spring i in the visiting order.
    rank_.resize(scene.shell != nullptr ? scene.shell->size() : scene.capacity);
    std::iota(rank_.begin(), rank_.end(), 0u);
    Random(*config_.shuffle_seed).shuffle(rank_);
    order_.resize(scene.capacity);
    shuffled_ = std::make_unique<ContactBuffer>(scene.capacity);
  }

  void process(ContactBuffer& contacts) noexcept override {
    if (shuffled_) shuffle(contacts);
    const std::size_t n = contacts.size();
    std::size_t kept = 0;
    for (std::size_t i = 0; i < n; i += simd::lanes) visit_pack(contacts, i, std::min(simd::lanes, n - i), kept);
    contacts.shrink(kept);
    contacts.pad();
  }

 private:
  /// Visits the `n` <= 8 contacts from i on. The loops over contacts and kept contacts are exchanged: one kept
  /// contact after the other is compared with all contacts of the pack that are not similar to an earlier kept
  /// contact. The result is unchanged, because a kept contact depends only on the contacts that are not similar to
  /// the earlier kept contacts, and on their order.
  void visit_pack(ContactBuffer& c, std::size_t i, std::size_t n, std::size_t& kept) noexcept {
    using simd::load, simd::Pack;
    const Pack x = load(&c.ux[i]), y = load(&c.uy[i]), z = load(&c.uz[i]), depth = load(&c.depth[i]);
    const Pack threshold(config_.threshold);
    // Keep the pointers in local variables, so that the program does not load them again for each test.
    const double *const ux = c.ux.data(), *const uy = c.uy.data(), *const uz = c.uz.data(), *const d = c.depth.data();
    const auto first = [i](unsigned lanes) { return i + static_cast<std::size_t>(std::countr_zero(lanes)); };
    // Writes the kept contact k: the contact at index `index`, or the contact in `lanes` that replaces this contact.
    // Returns the subset of `lanes` whose contacts are not similar to the kept contact.
    const auto refused_by = [&](std::size_t k, std::size_t index, unsigned lanes) {
      unsigned refused = 0;
      for (;;) {
        const Pack inner = x * Pack(ux[index]) + y * Pack(uy[index]) + z * Pack(uz[index]);
        const unsigned similar = simd::bits(inner > threshold) & lanes;
        // Most kept contacts are similar to no contact of the pack. Skip the comparison of depths for them.
        const unsigned deeper = similar == 0 ? 0 : simd::bits(depth > Pack(d[index])) & similar;
        if (deeper == 0) {
          if (index != k) c.copy(index, k);
          return refused | (lanes & ~similar);
        }
        // The first deeper contact replaces the kept contact, and the lanes after it are compared with the new
        // kept contact.
        const unsigned visited = deeper ^ (deeper - 1);
        refused |= lanes & ~similar & visited;
        lanes &= ~visited;
        index = first(deeper);
      }
    };
    unsigned lanes = 0xffu >> (simd::lanes - n);
    for (std::size_t k = 0; k < kept && lanes != 0; ++k) lanes = refused_by(k, k, lanes);
    for (; lanes != 0 && kept < config_.max_points; ++kept) lanes = refused_by(kept, first(lanes), lanes & (lanes - 1));
    dropped_ += static_cast<std::uint64_t>(std::popcount(lanes));
  }

  void shuffle(ContactBuffer& contacts) noexcept {
    const auto end = order_.begin() + static_cast<std::ptrdiff_t>(contacts.size());
    std::iota(order_.begin(), end, 0u);
    std::sort(order_.begin(), end,
              [&](std::uint32_t a, std::uint32_t b) { return rank_[contacts.index[a]] < rank_[contacts.index[b]]; });
    shuffled_->clear();
    for (auto slot = order_.begin(); slot != end; ++slot) shuffled_->push_copy_of(contacts, *slot);
    contacts.clear();
    for (std::size_t i = 0; i < shuffled_->size(); ++i) contacts.push_copy_of(*shuffled_, i);
  }

  ReductionConfig config_;
  std::vector<std::uint32_t> rank_;
  std::vector<std::uint32_t> order_;
  std::unique_ptr<ContactBuffer> shuffled_;  ///< null without shuffling
};

}  // namespace

std::unique_ptr<PointStage> make_local_average() {
  return std::make_unique<LocalAverage>();
}

std::unique_ptr<PointStage> make_gradient_reduction(const ReductionConfig& config) {
  return std::make_unique<GradientReduction>(config);
}

}  // namespace hapbench
