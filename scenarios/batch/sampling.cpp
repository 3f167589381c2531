#include "scenarios/batch/sampling.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <numeric>

#include "scenarios/batch/sobol.hpp"
#include "scenarios/batch/sweep_points.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/text_lines.hpp"
#include "sim/core/random.hpp"

namespace hapbench {
namespace {

struct NamedMethod {
  std::string_view name;
  SamplingMethod method;
};
constexpr NamedMethod kMethods[] = {
    {"lhs", SamplingMethod::latin_hypercube}, {"sobol", SamplingMethod::sobol}, {"random", SamplingMethod::random}};

/// Below 1, whatever rounding makes of a point in the last stratum.
constexpr double kLast = 1.0 - 0x1.0p-53;

void fill_latin_hypercube(Random& random, std::size_t axis, std::vector<UnitPoint>& points) {
  std::vector<std::size_t> strata(points.size());
  std::iota(strata.begin(), strata.end(), std::size_t{0});
  random.shuffle(strata);
  const auto count = static_cast<double>(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i][axis] = std::min((static_cast<double>(strata[i]) + random.uniform()) / count, kLast);
  }
}

void fill_sobol(Random& random, std::size_t axis, std::vector<UnitPoint>& points) {
  SobolAxis sequence(axis);
  const auto shift = static_cast<std::uint32_t>(random.below(std::uint64_t{1} << 32));
  for (UnitPoint& point : points) point[axis] = static_cast<double>(sequence.next() ^ shift) * 0x1.0p-32;
}

}  // namespace

std::string_view sampling_name(SamplingMethod method) {
  return std::find_if(std::begin(kMethods), std::end(kMethods),
                      [method](const NamedMethod& m) { return m.method == method; })
      ->name;
}

Sampling parse_sampling(const std::string& text, std::uint64_t seed) {
  const std::size_t colon = std::min(text.find(':'), text.size());
  const auto found = std::find_if(std::begin(kMethods), std::end(kMethods), [&](const NamedMethod& m) {
    return m.name == std::string_view(text).substr(0, colon);
  });
  const auto count = whole_number(std::string_view(text).substr(std::min(colon + 1, text.size())));
  if (found == std::end(kMethods) || !count || *count < 1 || *count > kMostRuns) {
    throw InputError(
        fmt::format("--sample: got \"{}\"; allowed: lhs:N, sobol:N or random:N with 1 <= N <= {}", text, kMostRuns));
  }
  return {found->method, *count, seed};
}

std::vector<UnitPoint> sample_unit_cube(const Sampling& sampling, std::size_t axes) {
  if (sampling.method == SamplingMethod::sobol && axes > kSobolAxes) {
    throw InputError(fmt::format("--sample: got a Sobol sample of {} fields; allowed: at most {}", axes, kSobolAxes));
  }
  std::vector<UnitPoint> points(sampling.count, UnitPoint(axes));
  for (std::size_t axis = 0; axis < axes; ++axis) {
    // A stream for each axis: one more axis does not change the others.
    Random random(Random::derive(sampling.seed, axis));
    switch (sampling.method) {
      case SamplingMethod::latin_hypercube:
        fill_latin_hypercube(random, axis, points);
        break;
      case SamplingMethod::sobol:
        fill_sobol(random, axis, points);
        break;
      case SamplingMethod::random:
        for (UnitPoint& point : points) point[axis] = random.uniform();
        break;
    }
  }
  return points;
}

}  // namespace hapbench
