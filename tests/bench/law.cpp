#include <fmt/format.h>

#include <algorithm>
#include <functional>

#include "algorithms/laws/exact_shaping.hpp"
#include "algorithms/registry.hpp"
#include "tests/bench/bench.hpp"
#include "tests/bench/contact_samples.hpp"
#include "tests/support/dense_laws.hpp"

namespace hapbench::bench {
namespace {

using test::Dense;

/// The spring force in units of K as the law's formula is written.
Vec3 original_averaging(const Dense& c) {
  const Vec3 sum = c.U.rowwise().sum();
  return -c.d.sum() / sum.norm() * sum.normalized();
}

Vec3 virtual_coupling(const Dense& c) {
  const Mat3 series = Mat3::Identity() + c.S(Eigen::VectorXd::Ones(c.n()));
  return series.inverse() * c.spring(1.0, Eigen::VectorXd::Ones(c.n()));
}

Vec3 least_squares(const Dense& c) {
  const Mat3 normal = RenderingConfig().regularisation * Mat3::Identity() + c.S(Eigen::VectorXd::Ones(c.n()));
  return normal.inverse() * c.spring(1.0, Eigen::VectorXd::Ones(c.n()));
}

Vec3 highest_depth(const Dense& c) {
  return -c.d.maxCoeff() * c.U.rowwise().sum().normalized();
}

/// Of a law that is weights on penalty springs.
using Weights = std::function<Eigen::VectorXd(const Dense&)>;
Vec3 weighted(const Dense& c, const Weights& weights) {
  return c.spring(1.0, weights(c));
}

/// Empty for algorithms that are not in here: add the formula with the algorithm.
std::function<Vec3(const Dense&)> reference(std::string_view algorithm) {
  const auto ones = [](const Dense& c) -> Eigen::VectorXd { return Eigen::VectorXd::Ones(c.n()); };
  const auto shaped = [](const Dense& c) { return test::shaped_weights(c.A(), 3); };
  if (algorithm == "original_averaging") return original_averaging;
  if (algorithm == "virtual_coupling") return virtual_coupling;
  if (algorithm == "least_squares") return least_squares;
  if (algorithm == "highest_depth") return highest_depth;
  if (algorithm == "summation") return [=](const Dense& c) { return weighted(c, ones); };
  if (algorithm == "mean") return [=](const Dense& c) -> Vec3 { return weighted(c, ones) / double(c.n()); };
  if (algorithm == "mcneely")
    return [=](const Dense& c) -> Vec3 { return weighted(c, ones) * std::min(1.0, 10.0 / double(c.n())); };
  if (algorithm == "tandpasta") return [](const Dense& c) { return weighted(c, test::tandpasta_weights); };
  if (algorithm == "shaped_stiffness" || algorithm.ends_with("normal_projection")) {
    return [=](const Dense& c) { return weighted(c, shaped); };
  }
  return {};
}

/// How the force of k copies of every contact follows from that of one, for laws whose formulas are matrices of all
/// pairs, too large for many: shaping divides each weight by a sum over all contacts, so that k copies share the weight
/// of one; tandpasta's weights are ratios of such sums, so that each copy keeps it. 0 for laws without such a formula.
double force_of_copies(std::string_view algorithm, double k) {
  if (algorithm == "tandpasta") return k;
  return algorithm == "shaped_stiffness" || algorithm.ends_with("normal_projection") ? 1.0 : 0.0;
}

/// What the algorithm gets wrong; empty when nothing.
std::string wrong(std::string_view algorithm, const ContactBuffer& contacts, const RenderedForce& force, double K) {
  if (algorithm == "exact_shaping") {
    // The bound of its partial sums of n / 8 terms grows with n (shaping_optimality.hpp).
    const double rounding =
        test::kShapingRounding * std::max(1.0, static_cast<double>(contacts.size()) / static_cast<double>(kRepeated));
    const double violation = test::shaping_optimality(contacts, kExactShapingEpsilon).violation;
    return violation > rounding ? fmt::format("optimality violated by {}", violation) : "";
  }
  const auto formula = reference(algorithm);
  if (!formula) return force.spring.allFinite() ? "" : "force not finite";
  const double copies = std::max(1.0, static_cast<double>(contacts.size()) / static_cast<double>(kRepeated));
  const double factor = copies > 1.0 ? force_of_copies(algorithm, copies) : 0.0;
  const Dense dense(factor != 0.0 ? repeated_contacts(kRepeated) : contacts);
  const double scale = factor != 0.0 ? factor * K : K;
  const Vec3 expected = scale * formula(dense);
  // Sums of n terms of at most a depth each, in another order.
  const double rounding = 1e-12 * scale * dense.magnitude(Eigen::VectorXd::Ones(dense.n()));
  return (force.spring - expected).norm() <= rounding ? "" : "not the formula's force";
}

void law(benchmark::State& state, const std::string& algorithm, std::size_t n) {
  RenderingConfig config;
  config.algorithm = algorithm;
  const auto rendering = make_algorithm(config);
  // The contacts bring their depths, so that the law is what remains.
  ContactBuffer contacts = repeated_contacts(n);
  rendering->prepare({.capacity = n});
  rendering->reset();
  const ToolState tool;
  RenderedForce force;
  rendering->compute(tool, contacts, force);
  if (const std::string what = wrong(algorithm, contacts, force, config.stiffness); !what.empty()) {
    return refute(state, what);
  }
  for (auto _ : state) {
    rendering->compute(tool, contacts, force);
    benchmark::DoNotOptimize(force);
  }
  state.counters["contacts"] = static_cast<double>(n);
}

}  // namespace

void register_laws() {
  for (const AlgorithmEntry& algorithm : algorithms()) {
    // No law of contacts handed to it: it asks for its own. Timed as a step, T2_proxy.
    if (std::string_view(algorithm.info->name) == "proxy") continue;
    const std::string name(algorithm.info->name);
    for (const std::size_t n : {50u, 250u, 1000u}) {
      benchmark::RegisterBenchmark(fmt::format("law/{}/{}", name, n).c_str(), law, name, n);
    }
    for (const std::size_t n : kGrowthContacts) {
      // All pairs of contacts: seconds a call.
      if (name == "tandpasta" && n > 10'000) continue;
      benchmark::RegisterBenchmark(fmt::format("growth/law/{}/{}", name, n).c_str(), law, name, n);
    }
  }
}

}  // namespace hapbench::bench
