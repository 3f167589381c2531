#include "scenarios/studies/stability/edge_search.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "sim/core/bisection.hpp"
#include "sim/core/math.hpp"

namespace hapbench {
namespace {

constexpr int kBeside = 3;  // values tried on either side of the edge, up to an interval away
constexpr int kRounds = 6;  // of bisection, each towards an edge that values beside the last one showed

}  // namespace

double SearchWay::value_at(double part) const {
  const double value = range.value_at(smallest ? 1.0 - part : part);
  return whole ? std::round(value) : value;
}

std::optional<double> SearchWay::own_part() const {
  if (!own) return std::nullopt;
  const auto [from, to, logarithmic] = range;
  const double part = logarithmic ? math::log(*own / from) / math::log(to / from) : (*own - from) / (to - from);
  return smallest ? 1.0 - part : part;
}

bool SearchWay::apart(double a, double b, double resolution_asked) const {
  const double low = std::min(value_at(a), value_at(b)), high = std::max(value_at(a), value_at(b));
  if (whole) return high - low > 1.0;
  if (range.logarithmic) return high > (1.0 + resolution_asked) * low;
  return high - low > resolution_asked * (range.to - range.from);
}

std::map<double, bool> scanned(int intervals, const std::function<bool(double)>& stable) {
  std::map<double, bool> tried;
  for (int i = 0; i <= intervals; ++i) {
    const double part = static_cast<double>(i) / intervals;
    tried[part] = stable(part);
  }
  return tried;
}

FoundEdge find_edge(const SearchWay& way, std::map<double, bool> tried, const std::function<bool(double)>& stable,
                    double resolution, bool beside) {
  const auto holds = [&](double part) { return tried[part] = stable(part); };
  const std::optional<double> own = way.own_part();
  const double start = own && holds(*own) ? *own : 0.0;
  const auto middle = [](double a, double b) { return 0.5 * (a + b); };
  const auto apart = [&](double a, double b) { return way.apart(a, b, resolution); };
  const auto with_other_end = [&](FoundEdge edge) {
    if (!beside) return edge;
    auto first = tried.find(*edge.stable);
    while (first != tried.begin() && std::prev(first)->second) --first;
    double high = first->first;
    edge.first = high;
    if (first == tried.begin()) return edge;
    double low = std::prev(first)->first;
    bisect(high, low, holds, middle, [&](double a, double b) { return apart(b, a); });
    edge.first = high;
    edge.before = low;
    return edge;
  };
  FoundEdge edge;
  for (int round = 0; round < kRounds; ++round) {
    const auto is = [](bool wanted) { return [wanted](const auto& value) { return value.second == wanted; }; };
    const auto first = std::find_if(tried.lower_bound(start), tried.end(), is(true));
    if (first == tried.end()) return {};
    const auto end = std::find_if(first, tried.end(), is(false));
    if (end == tried.end()) return with_other_end({tried.rbegin()->first, {}, {}, {}});
    double low = std::prev(end)->first, high = end->first;
    if (edge.stable == low) return with_other_end(edge);
    bisect(low, high, holds, middle, apart);
    edge = {low, high, {}, {}};
    if (!beside) return edge;
    const double before = std::max(first->first, low - 1.0 / kEdgeIntervals),
                 behind = std::min(1.0, high + 1.0 / kEdgeIntervals);
    for (int i = 1; i <= kBeside; ++i) {
      const double share = static_cast<double>(i) / (kBeside + 1);
      holds(before + share * (low - before));
      holds(high + share * (behind - high));
    }
  }
  return with_other_end(edge);
}

}  // namespace hapbench
