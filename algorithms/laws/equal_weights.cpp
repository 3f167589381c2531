#include "algorithms/registry.hpp"

/// Laws that give all contacts the same weight c, which depends only on the number n of contacts: f = -K c sum
/// d_i u_i. `mean` is the shortest example of a law.
namespace hapbench {
namespace {

class Summation final : public ForceLaw {
 public:
  using ForceLaw::ForceLaw;

  LawForce evaluate(ContactBuffer& contacts) noexcept override {
    set_weights(contacts, 1.0);
    return weighted_force(contacts, K_);
  }
};

class Mean final : public ForceLaw {
 public:
  using ForceLaw::ForceLaw;

  LawForce evaluate(ContactBuffer& contacts) noexcept override {
    set_weights(contacts, 1.0 / static_cast<double>(contacts.size()));
    return weighted_force(contacts, K_);
  }
};

constexpr AlgorithmParameter kPoints[] = {
    {"points", {1.0, 1e5, "1"}, 10.0, "largest number of springs that are added without scaling"}};

double points_of(const RenderingConfig& config) {
  return parameter_value(config, "mcneely", kPoints[0]);
}

class McNeely final : public ForceLaw {
 public:
  explicit McNeely(const RenderingConfig& config) : ForceLaw(config), points_(points_of(config)) {}

  LawForce evaluate(ContactBuffer& contacts) noexcept override {
    const auto n = static_cast<double>(contacts.size());
    set_weights(contacts, n > points_ ? points_ / n : 1.0);
    return weighted_force(contacts, K_);
  }

 private:
  double points_;
};

/// Upper bound of |f_spring| / K [m]: n springs of weight min(1, p / n), all in one direction. p is the
/// parameter `points`.
double mcneely_bound(const RenderingConfig& config, const ToolShape&, std::size_t n, double depth) {
  return std::min(static_cast<double>(n), points_of(config)) * depth;
}

}  // namespace

AlgorithmEntry summation_entry() {
  static constexpr ModelInfo kInfo = {
      .name = "summation",
      .summary = "sum of all penalty springs",
      .formula = "c_i = 1",
      .source = "thesis 1.2, Fig. 2b",
      .known_failure =
          "stiffness and damping grow with the number of points; unstable when lambda_max(S) K exceeds the "
          "integrator's limit (thesis A.3)",
      .parameters = kStiffnessAlone,
  };
  // The bound is the force of all n springs, because all of them may pull in the same direction.
  return {.info = &kInfo, .make_law = law_of<Summation>, .force_bound = bound_of_springs<>};
}

AlgorithmEntry mean_entry() {
  static constexpr ModelInfo kInfo = {
      .name = "mean",
      .summary = "mean of all penalty springs",
      .formula = "c_i = 1/n",
      .source = "thesis Fig. 2c",
      .known_failure =
          "directions with few points have almost no stiffness: the tool sinks in where the majority of points is "
          "parallel",
      .parameters = kStiffnessAlone,
  };
  // |sum c d_i u_i| <= d sum c with the largest depth d and c = 1 / n, so the force is at most the force of one
  // spring.
  return {.info = &kInfo, .make_law = law_of<Mean>, .force_bound = bound_of_springs<1>};
}

AlgorithmEntry mcneely_entry() {
  static constexpr ModelInfo kInfo = {
      .name = "mcneely",
      .summary = "the 10/N rule: adds the springs; the sum of more than ten springs is scaled to the sum of ten",
      .formula = "c_i = min(1, p / n), p = 10 points, n colliding points; always without reduction",
      .source =
          "McNeely, Puterbaugh and Troy, Six degree-of-freedom haptic rendering using voxel sampling (SIGGRAPH 1999)",
      .known_failure =
          "the sum is still ten times as stiff as one spring where all points share a direction, and the force "
          "follows the direction with the largest number of points; a point that appears or disappears rescales all "
          "others",
      .parameters = kStiffnessAlone,
  };
  return {.info = &kInfo,
          .make_law = law_of<McNeely>,
          .force_bound = mcneely_bound,
          .may_reduce = false,
          .algorithm_parameters = kPoints};
}

}  // namespace hapbench
