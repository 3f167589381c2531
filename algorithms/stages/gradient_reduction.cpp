#include "algorithms/stages/gradient_reduction.hpp"

#include <algorithm>
#include <bit>
#include <numeric>
#include <vector>

#include "algorithms/parameters.hpp"
#include "sim/core/random.hpp"
#include "sim/core/simd.hpp"

namespace hapbench {
namespace {

constexpr ParameterInfo kParameters[] = {
    {parameter::kThreshold, "alpha_TH: gradients with a larger inner product are similar"},
    {parameter::kMaxPoints, "n_ext: most points kept; further ones are dropped and counted"},
    {parameter::kShuffleSeed, "visit the shell points in a fixed random order instead of ascending index"},
};

}  // namespace

const ModelInfo kGradientReductionInfo = {
    .name = "reduction",
    .summary = "of colliding points with similar gradients only the deepest is kept",
    .formula =
        "visit contacts in order; the first kept k with <u_i, u_k> > alpha_TH absorbs i (replaced if d_i > d_k); "
        "none similar: append, or drop when n_ext are kept",
    .source =
        "thesis C.3, 2.8; algorithm C.1 as printed appends replaced points and compares on after a similar one, which "
        "cannot be meant",
    .known_failure = "depends on the order of the points; collapses gradually curved surfaces (thesis 4.1)",
    .parameters = kParameters,
};

namespace {

/// O(n * kept) inner products.
class GradientReduction final : public PointStage {
 public:
  explicit GradientReduction(const ReductionConfig& config) : config_(config) {}

  void prepare(const Scene& scene) override {
    if (!config_.shuffle_seed) return;
    // rank_[i] is the place of shell point, or spring, i in the visiting order.
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
    bool try_whole_pack = false;
    for (std::size_t i = 0; i < n; i += simd::lanes) {
      if (try_whole_pack && absorbs_pack(contacts, i, kept)) continue;
      try_whole_pack = true;
      for (std::size_t j = i; j < std::min(i + simd::lanes, n); ++j) try_whole_pack &= absorbs(contacts, j, kept);
    }
    contacts.shrink(kept);
    contacts.pad();
  }

 private:
  /// Visits contact i. True if one that is kept, and stays as it is, absorbs it.
  bool absorbs(ContactBuffer& contacts, std::size_t i, std::size_t& kept) noexcept {
    const std::size_t k = first_similar(contacts, i, kept);
    if (k < kept) {
      if (!(contacts.depth[i] > contacts.depth[k])) return true;
      contacts.copy(i, k);
    } else if (kept < config_.max_points) {
      contacts.copy(i, kept++);
    } else {
      ++dropped_;
    }
    return false;
  }

  /// True if those that are kept, as they are, absorb all of the eight contacts from i on, which then need no visit.
  /// After the first packs of a smooth surface that is so for most.
  bool absorbs_pack(const ContactBuffer& c, std::size_t i, std::size_t kept) const noexcept {
    using simd::load, simd::Pack;
    if (c.size() - i < simd::lanes) return false;
    const Pack x = load(&c.ux[i]), y = load(&c.uy[i]), z = load(&c.uz[i]), threshold(config_.threshold);
    const Pack depth = load(&c.depth[i]);
    unsigned open = 0xff;  // lanes that nothing similar was found for
    for (std::size_t k = 0; k < kept && open != 0; ++k) {
      const Pack inner = x * Pack(c.ux[k]) + y * Pack(c.uy[k]) + z * Pack(c.uz[k]);
      const unsigned similar = simd::bits(inner > threshold) & open;
      if ((similar & simd::bits(depth > Pack(c.depth[k]))) != 0) return false;
      open &= ~similar;
    }
    return open == 0;
  }

  std::size_t first_similar(const ContactBuffer& c, std::size_t i, std::size_t kept) const noexcept {
    using simd::load, simd::Pack;
    const Pack x(c.ux[i]), y(c.uy[i]), z(c.uz[i]), threshold(config_.threshold);
    for (std::size_t k = 0; k < kept; k += simd::lanes) {
      const Pack inner = x * load(&c.ux[k]) + y * load(&c.uy[k]) + z * load(&c.uz[k]);
      if (const unsigned similar = simd::bits(inner > threshold); similar != 0) {
        // Beyond `kept` lie contacts that are still to be visited.
        return std::min(kept, k + static_cast<std::size_t>(std::countr_zero(similar)));
      }
    }
    return kept;
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
  std::unique_ptr<ContactBuffer> shuffled_;  ///< only with a shuffle
};

}  // namespace

std::unique_ptr<PointStage> make_gradient_reduction(const ReductionConfig& config) {
  return std::make_unique<GradientReduction>(config);
}

}  // namespace hapbench
