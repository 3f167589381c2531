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

constexpr ParameterInfo kReductionParameters[] = {
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
    .parameters = kReductionParameters,
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
    for (std::size_t i = 0; i < n; i += simd::lanes) visit_pack(contacts, i, std::min(simd::lanes, n - i), kept);
    contacts.shrink(kept);
    contacts.pad();
  }

 private:
  /// Visits the `n` contacts from i on. Instead of each in turn asking all that are kept, each that is kept, in turn,
  /// is asked by all eight that none before it has absorbed: the same, because what becomes of a kept contact depends
  /// only on those that the ones before it refuse, in their order.
  void visit_pack(ContactBuffer& c, std::size_t i, std::size_t n, std::size_t& kept) noexcept {
    using simd::load, simd::Pack;
    const Pack x = load(&c.ux[i]), y = load(&c.uy[i]), z = load(&c.uz[i]), depth = load(&c.depth[i]);
    const Pack threshold(config_.threshold);
    // Read once, not anew for each test.
    const double *const ux = c.ux.data(), *const uy = c.uy.data(), *const uz = c.uz.data(), *const d = c.depth.data();
    const auto first = [i](unsigned lanes) { return i + static_cast<std::size_t>(std::countr_zero(lanes)); };
    // Of the lanes those that the contact at `place`, kept as number k, refuses.
    const auto refused_by = [&](std::size_t k, std::size_t place, unsigned lanes) {
      unsigned refused = 0;
      for (;;) {
        const Pack inner = x * Pack(ux[place]) + y * Pack(uy[place]) + z * Pack(uz[place]);
        const unsigned similar = simd::bits(inner > threshold) & lanes;
        // Most kept contacts are similar to none of the eight, and their depth needs no look.
        const unsigned deeper = similar == 0 ? 0 : simd::bits(depth > Pack(d[place])) & similar;
        if (deeper == 0) {
          if (place != k) c.copy(place, k);
          return refused | (lanes & ~similar);
        }
        // The first that is deeper is kept instead, and those behind it meet that one.
        const unsigned visited = deeper ^ (deeper - 1);
        refused |= lanes & ~similar & visited;
        lanes &= ~visited;
        place = first(deeper);
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
  std::unique_ptr<ContactBuffer> shuffled_;  ///< only with a shuffle
};

}  // namespace

std::unique_ptr<PointStage> make_gradient_reduction(const ReductionConfig& config) {
  return std::make_unique<GradientReduction>(config);
}

}  // namespace hapbench
