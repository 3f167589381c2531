#include "device_model/theory/sampled_loop.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include "device_model/theory/eigenvalue_edge.hpp"
#include "sim/core/random.hpp"

namespace hapbench::sampled_loop_test {
namespace {

/// An undamped handle of 1 kg and a period of 1 s: K is alpha = K T^2/m and B is beta = B T/m.
SampledLoop unit_loop(double delay, double beta) {
  SampledLoop loop;
  loop.handle_mass = loop.period = 1.0;
  loop.delay = delay;
  loop.wall_damping = beta;
  return loop;
}

/// Coefficients from the constant up.
using Polynomial = std::vector<double>;

Polynomial product(const Polynomial& a, const Polynomial& b) {
  Polynomial out(a.size() + b.size() - 1, 0.0);
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t j = 0; j < b.size(); ++j) out[i + j] += a[i] * b[j];
  return out;
}

Polynomial sum(Polynomial a, const Polynomial& b) {
  a.resize(std::max(a.size(), b.size()), 0.0);
  for (std::size_t i = 0; i < b.size(); ++i) a[i] += b[i];
  return a;
}

/// By the companion matrix.
double largest_root(const Polynomial& p) {
  const auto n = static_cast<Eigen::Index>(p.size()) - 1;
  Eigen::MatrixXd companion = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index i = 0; i + 1 < n; ++i) companion(i, i + 1) = 1.0;
  for (Eigen::Index i = 0; i < n; ++i) companion(n - 1, i) = -p[static_cast<std::size_t>(i)] / p.back();
  return spectral_radius(companion);
}

Polynomial z_to(int power) {
  Polynomial p(static_cast<std::size_t>(power) + 1, 0.0);
  p.back() = 1.0;
  return p;
}

/// 2 z^(d+1) (z - 1)^2 + (z + 1) ((alpha + beta) z - beta)
Polynomial undamped(int d, double alpha, double beta) {
  return sum(product(z_to(d + 1), {2.0, -4.0, 2.0}), product({1.0, 1.0}, {-beta, alpha + beta}));
}

/// z^(d+1) (z - 1) (z - e) + (b1 z + b2) ((alpha + beta) z - beta), of a handle damped with b T/m.
Polynomial damped(int d, double alpha, double beta, double b) {
  const double e = std::exp(-b), b1 = (b - 1.0 + e) / (b * b), b2 = (1.0 - e - b * e) / (b * b);
  return sum(product(z_to(d + 1), product({-1.0, 1.0}, {-e, 1.0})), product({b2, b1}, {-beta, alpha + beta}));
}

double polynomial_edge(int d, double beta) {
  const auto stable = [&](double alpha) { return largest_root(undamped(d, alpha, beta)) <= 1.0 + 1e-12; };
  return stable(1e-8) ? largest_stable(1e-8, 1e-11, stable, 1e6, 1.1) : 0.0;
}

/// The largest value over beta, found between 0 and 2 by the golden section; the edge rises and falls once.
template <class Edge>
double best_over_damping(Edge edge) {
  const double ratio = std::numbers::phi - 1.0;
  double low = 0.01, high = 1.9;
  while (high - low > 1e-5) {
    const double a = high - ratio * (high - low), b = low + ratio * (high - low);
    (edge(a) < edge(b) ? low : high) = edge(a) < edge(b) ? a : b;
  }
  return edge(0.5 * (low + high));
}

TEST(SampledLoop, RendersAtMostTheseStiffnessesOnAnUndampedHandle) {
  // To the digits given; with half a sample more or less of delay they would be others.
  const double published[] = {0.6863, 0.1445, 0.0624, 0.0348};
  for (const int d : {0, 1, 2, 3}) {
    const double by_polynomial = best_over_damping([d](double beta) { return polynomial_edge(d, beta); });
    const double by_state = best_over_damping([d](double beta) { return eigenvalue_edge(unit_loop(d, beta)); });
    EXPECT_NEAR(by_polynomial, published[d], 0.00005) << d;
    EXPECT_NEAR(by_state, by_polynomial, 1e-9 * by_polynomial) << d;
  }
}

TEST(SampledLoop, HasTheEdgeOfTheClosedFormWithoutDelay) {
  for (const double beta : {0.01, 0.1, 0.5, 2.0 * std::numbers::sqrt2 - 2.0, 1.2, 1.9}) {
    const double closed = 2.0 * beta * (2.0 - beta) / (2.0 + beta);
    EXPECT_NEAR(eigenvalue_edge(unit_loop(0.0, beta)), closed, 1e-10 * closed) << beta;
  }
  EXPECT_EQ(eigenvalue_edge(unit_loop(0.0, 2.1)), 0.0);
  EXPECT_EQ(eigenvalue_edge(unit_loop(0.0, 0.0)), 0.0) << "nothing damps";
}

TEST(SampledLoop, HasTheRootsOfTheTransferFunctionOfADampedHandle) {
  Random random(1);
  for (int i = 0; i < 200; ++i) {
    const int d = i % 4;
    SampledLoop loop = unit_loop(d, random.uniform());
    loop.damping = 0.05 + random.uniform();
    loop.stiffness = random.uniform();
    const double root = largest_root(damped(d, loop.stiffness, loop.wall_damping, loop.damping));
    // Double roots are known to the root of rounding.
    EXPECT_NEAR(spectral_radius(loop.state_matrix()), root, 1e-7);
  }
}

TEST(SampledLoop, CountsAHandsMassAndDampingAsTheHandles) {
  SampledLoop held = unit_loop(1.5, 0.2), heavy = held;
  held.handle_mass = 0.6;
  held.damping = 0.01;
  held.hand = {0.4, 0.0, 0.02};
  heavy.damping = 0.03;
  EXPECT_NEAR(eigenvalue_edge(held), eigenvalue_edge(heavy), 1e-10);
}

TEST(SampledLoop, OfAHandWithASpringMovesAsTheClosedFormHasIt) {
  SampledLoop loop;  // no wall: x'' + 2 zeta w x' + w^2 x = 0
  loop.handle_mass = 0.1;
  loop.hand = {0.3, 500.0, 2.0};
  const double w = std::sqrt(500.0 / 0.4), zeta = 2.0 / (2.0 * std::sqrt(500.0 * 0.4)), T = loop.period;
  const double wd = w * std::sqrt(1.0 - zeta * zeta), decay = std::exp(-zeta * w * T);
  const Eigen::MatrixXd A = loop.state_matrix();
  EXPECT_NEAR(A(0, 0), decay * (std::cos(wd * T) + zeta * w / wd * std::sin(wd * T)), 1e-15);
  EXPECT_NEAR(A(0, 1) * T, decay * std::sin(wd * T) / wd, 1e-15 * T);
}

TEST(SampledLoop, HasAFractionalDelayBetweenTheWholeOnes) {
  double last = std::numeric_limits<double>::infinity();
  for (double delay = 0.0; delay <= 3.0; delay += 0.125) {
    const double edge = eigenvalue_edge(unit_loop(delay, 0.2));
    EXPECT_LT(edge, last) << delay;
    last = edge;
  }
  // From either side of a whole one to it.
  const double whole = eigenvalue_edge(unit_loop(1.0, 0.2));
  EXPECT_NEAR(eigenvalue_edge(unit_loop(1.0 - 1e-7, 0.2)), whole, 1e-6);
  EXPECT_NEAR(eigenvalue_edge(unit_loop(1.0 + 1e-7, 0.2)), whole, 1e-6);
}

TEST(SampledLoop, AWideLowPassIsTheDifference) {
  SampledLoop loop = unit_loop(0.0, 0.3);
  const double difference = eigenvalue_edge(loop);
  loop.cutoff = 20.0;  // a = e^-126
  EXPECT_NEAR(eigenvalue_edge(loop), difference, 1e-10);
  loop.cutoff = 0.05;
  EXPECT_LT(eigenvalue_edge(loop), 0.9 * difference) << "a filter is late";
}

/// The wall enters the state matrix as K times a matrix of rank one, u v^T. An eigenvalue e^(j theta) needs
/// K v^T (e^(j theta) I - A_0)^(-1) u = 1: a real positive K, which a frequency response shows for every theta.
double first_crossing(SampledLoop loop) {
  loop.stiffness = 0.0;
  const Eigen::MatrixXd A = loop.state_matrix();
  loop.stiffness = 1.0;
  const Eigen::MatrixXd wall = loop.state_matrix() - A;
  const Eigen::VectorXcd u = wall.col(0).cast<std::complex<double>>();  // v^T: the position
  const auto stiffness_at = [&](double theta) {
    const Eigen::MatrixXcd shifted =
        std::polar(1.0, theta) * Eigen::MatrixXcd::Identity(A.rows(), A.rows()) - A.cast<std::complex<double>>();
    return 1.0 / Eigen::VectorXcd(shifted.partialPivLu().solve(u))[0];
  };
  double first = std::numeric_limits<double>::infinity(), low = 1e-3;
  std::complex<double> before = stiffness_at(low);
  for (int i = 1; i <= 2000; ++i) {
    const double high = 1e-3 + (std::numbers::pi - 1e-3) * i / 2000;
    const std::complex<double> at = stiffness_at(high);
    if (before.imag() * at.imag() <= 0.0 && std::abs(before - at) < std::abs(at)) {  // no pole in between
      double a = low, b = high;
      bisect(
          a, b, [&](double theta) { return stiffness_at(theta).imag() * before.imag() > 0.0; },
          [](double c, double d) { return 0.5 * (c + d); }, [](double c, double d) { return d - c > 1e-13; });
      const double K = stiffness_at(a).real();
      if (K > 0.0) first = std::min(first, K);
    }
    before = at;
    low = high;
  }
  return first;
}

TEST(SampledLoop, HasNoCrossingBelowItsEdge) {
  Random random(3);
  for (int i = 0; i < 12; ++i) {
    SampledLoop loop = unit_loop(std::floor(10.0 * random.uniform()) / 4.0, 0.4 * random.uniform());
    loop.damping = 0.05 + 0.1 * random.uniform();
    loop.hand = {2.0 * random.uniform(), i % 2 == 0 ? 0.0 : 0.01 * random.uniform(), 0.0};
    if (i % 3 == 0) loop.cutoff = 0.1;
    const double edge = eigenvalue_edge(loop);
    ASSERT_GT(edge, 0.0);
    // A crossing at pi, with K real all about it, is the end of the sweep: none of these loops has it first.
    EXPECT_NEAR(first_crossing(loop), edge, 1e-8 * edge) << i;
  }
}

TEST(HandFamily, NeedsLessStiffnessThanAnyOfItsHands) {
  SampledLoop loop;
  loop.damping = 0.5;
  loop.wall_damping = 5.0;
  const double worst = worst_hand_edge(loop);
  bool met = false;
  for (const AttachedHand& hand : hand_family()) {
    loop.hand = hand;
    const double edge = eigenvalue_edge(loop);
    EXPECT_GE(edge, worst);
    met = met || edge == worst;
  }
  EXPECT_TRUE(met);
}

}  // namespace
}  // namespace hapbench::sampled_loop_test
