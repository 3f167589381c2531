#include "scenarios/analysis/stability/interval_search.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <utility>

#include "sim/core/math.hpp"

namespace hapbench {
namespace {

bool is_stable_part(const TriedParts::value_type& tried) {
  return tried.second;
}

bool is_unstable_part(const TriedParts::value_type& tried) {
  return !tried.second;
}

/// One search of find_edge.
class EdgeSearch {
 public:
  EdgeSearch(const SearchWay& way, TriedParts& tried, const IsStable& stable)
      : way_(way), tried_(tried), stable_(stable) {}

  /// Returns the first transition without a look at its surroundings.
  FoundEdge first() {
    start();
    const std::optional<Transition> transition = next_transition();
    return transition ? edge_of(*transition) : FoundEdge{};
  }

  /// Returns the first transition that samples on either side of it confirm, and the other end of its interval.
  FoundEdge confirmed() {
    constexpr int kRounds = 6;  // of bisection, each at the transition that samples beside the last one revealed
    start();
    FoundEdge edge;
    for (int round = 0; round < kRounds; ++round) {
      const std::optional<Transition> transition = next_transition();
      if (!transition) return {};
      const bool is_confirmed = transition->high && edge.stable == transition->low;
      if (is_confirmed) break;
      edge = edge_of(*transition);
      if (!edge.beyond) break;
      try_beside(transition->first_stable, edge);
    }
    add_other_end(edge);
    return edge;
  }

 private:
  /// Two neighbours among the evaluated parameters, the first stable and the second unstable.
  struct Transition {
    double first_stable;         ///< where the stable parameters begin
    double low;                  ///< the last stable one
    std::optional<double> high;  ///< the unstable one above it; empty if the range ends stable
  };

  bool evaluate(double t) {
    const bool is_stable = stable_(t);
    tried_[t] = is_stable;
    return is_stable;
  }

  /// The search starts at the current value, or at t = 0 if that is unstable.
  void start() {
    const std::optional<double> own = way_.own_part();
    start_ = own && evaluate(*own) ? *own : 0.0;
  }

  std::optional<Transition> next_transition() const {
    const auto first = std::find_if(tried_.lower_bound(start_), tried_.end(), is_stable_part);
    if (first == tried_.end()) return std::nullopt;
    const auto end = std::find_if(first, tried_.end(), is_unstable_part);
    Transition transition{first->first, std::prev(end)->first, std::nullopt};
    if (end != tried_.end()) transition.high = end->first;
    return transition;
  }

  FoundEdge edge_of(const Transition& transition) {
    if (!transition.high) return {.stable = transition.low};
    const auto [stable, unstable] = bisected(transition.low, *transition.high);
    return {.stable = stable, .beyond = unstable};
  }

  /// Bisects between a stable and an unstable parameter.
  std::pair<double, double> bisected(double stable, double unstable) {
    while (way_.apart(stable, unstable)) {
      const double middle = 0.5 * (stable + unstable);
      if (evaluate(middle))
        stable = middle;
      else
        unstable = middle;
    }
    return {stable, unstable};
  }

  /// Evaluates parameters on either side of a transition, up to an interval of the scan away.
  void try_beside(double first_stable, const FoundEdge& edge) {
    constexpr int kBeside = 3;  // on either side
    constexpr double kInterval = 1.0 / kEdgeIntervals;
    const double before = std::max(first_stable, *edge.stable - kInterval);
    const double behind = std::min(1.0, *edge.beyond + kInterval);
    for (int i = 1; i <= kBeside; ++i) {
      const double share = static_cast<double>(i) / (kBeside + 1);
      evaluate(before + share * (*edge.stable - before));
      evaluate(*edge.beyond + share * (behind - *edge.beyond));
    }
  }

  /// Finds the other end of the interval of stable parameters.
  void add_other_end(FoundEdge& edge) {
    auto first = tried_.find(*edge.stable);
    while (first != tried_.begin() && std::prev(first)->second) --first;
    edge.first = first->first;
    if (first == tried_.begin()) return;
    const auto [stable, unstable] = bisected(first->first, std::prev(first)->first);
    edge.first = stable;
    edge.before = unstable;
  }

  const SearchWay& way_;
  TriedParts& tried_;
  const IsStable& stable_;
  double start_ = 0.0;
};

}  // namespace

double SearchWay::value_at(double t) const {
  const double value = range.value_at(smallest ? 1.0 - t : t);
  return whole ? std::round(value) : value;
}

std::optional<double> SearchWay::own_part() const {
  if (!own) return std::nullopt;
  const auto [from, to, logarithmic] = range;
  const double t = logarithmic ? math::log(*own / from) / math::log(to / from) : (*own - from) / (to - from);
  return smallest ? 1.0 - t : t;
}

bool SearchWay::apart(double a, double b) const {
  const auto [low, high] = std::minmax({value_at(a), value_at(b)});
  if (whole) return high - low > 1.0;
  if (range.logarithmic) return high > (1.0 + resolution) * low;
  return high - low > resolution * (range.to - range.from);
}

TriedParts scanned(int intervals, const IsStable& stable) {
  TriedParts tried;
  for (int i = 0; i <= intervals; ++i) {
    const double t = static_cast<double>(i) / intervals;
    tried[t] = stable(t);
  }
  return tried;
}

FoundEdge find_edge(const SearchWay& way, TriedParts& tried, const IsStable& stable, bool beside) {
  EdgeSearch search(way, tried, stable);
  return beside ? search.confirmed() : search.first();
}

double may_fail_share(std::size_t tried) {
  return 1.0 - math::pow(0.05, 1.0 / static_cast<double>(tried));
}

std::vector<double> parts_between(double from, double to, std::size_t count) {
  constexpr double kGolden = std::numbers::phi - 1.0;
  std::vector<double> parts;
  double share = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    share += kGolden;
    share -= std::floor(share);
    parts.push_back(from + share * (to - from));
  }
  return parts;
}

std::vector<double> parts_below(const SearchWay& way, double t) {
  const auto [from, to, logarithmic] = way.range;
  const double near = logarithmic ? math::log(1.0 + kNear) / math::log(to / from)
                                  : kNear * std::max(std::abs(way.value_at(t)) / (to - from), way.resolution);
  return parts_between(t, std::max(0.0, t - near), kTriedNear);
}

FoundEdge find_tried_edge(const SearchWay& way, TriedParts& tried, const IsStable& stable, bool near,
                          const std::function<void(std::span<const double>)>& ahead) {
  bool scattered = false;
  double scattered_up_to = -1.0;  // up to here the stable parameters are scattered, and none counts as stable
  const auto counts_as_stable = [&](double t) { return t > scattered_up_to && stable(t); };
  // Returns the first of these samples that is not stable; `tried` then has it.
  const auto first_failing = [&](const std::vector<double>& samples) -> std::optional<double> {
    ahead(samples);
    for (const double t : samples) {
      tried[t] = counts_as_stable(t);
      if (!tried[t]) return t;
    }
    return std::nullopt;
  };
  while (true) {
    const FoundEdge edge = find_edge(way, tried, counts_as_stable, true);
    if (!edge.stable) return {.scattered = scattered};
    const double first = edge.first.value_or(*edge.stable);
    if (first_failing(parts_between(first, *edge.stable, kTriedBetween))) continue;
    if (!near || way.whole || !edge.beyond) return edge;
    const std::optional<double> failing = first_failing(parts_below(way, *edge.stable));
    if (!failing) return edge;
    if (*failing > first) continue;
    // A sample below the interval fails: the interval is shorter than kNear. The search continues above it.
    scattered = true;
    const std::optional<double> own = way.own_part();
    if (own && first <= *own && *own <= *edge.stable) return {.scattered = true};
    scattered_up_to = *edge.stable;
    for (auto& [t, is_stable] : tried) is_stable = is_stable && t > scattered_up_to;
  }
}

}  // namespace hapbench
