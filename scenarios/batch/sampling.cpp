#include "scenarios/batch/sampling.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <numeric>

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

std::vector<double> latin_hypercube(Random& random, std::size_t count) {
  std::vector<std::size_t> strata(count);
  std::iota(strata.begin(), strata.end(), std::size_t{0});
  random.shuffle(strata);
  std::vector<double> points(count);
  for (std::size_t i = 0; i < count; ++i) {
    points[i] = std::min((static_cast<double>(strata[i]) + random.uniform()) / static_cast<double>(count), kLast);
  }
  return points;
}

std::vector<double> independent(Random& random, std::size_t count) {
  std::vector<double> points(count);
  for (double& point : points) point = random.uniform();
  return points;
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

UnitSample::UnitSample(const Sampling& sampling, std::size_t axes) {
  if (sampling.method == SamplingMethod::sobol && axes > kSobolAxes) {
    throw InputError(fmt::format("--sample: got a Sobol sample of {} fields; allowed: at most {}", axes, kSobolAxes));
  }
  for (std::size_t axis = 0; axis < axes; ++axis) {
    // A stream for each axis: one more axis does not change the others.
    Random random(Random::derive(sampling.seed, axis));
    switch (sampling.method) {
      case SamplingMethod::latin_hypercube:
        points_.push_back(latin_hypercube(random, sampling.count));
        break;
      case SamplingMethod::sobol:
        sobol_.push_back({SobolAxis(axis), static_cast<std::uint32_t>(random.below(std::uint64_t{1} << 32))});
        break;
      case SamplingMethod::random:
        points_.push_back(independent(random, sampling.count));
        break;
    }
  }
}

double UnitSample::at(std::size_t point, std::size_t axis) const {
  if (sobol_.empty()) return points_[axis][point];
  const ShiftedSobol& sobol = sobol_[axis];
  return static_cast<double>(sobol.sequence.at(static_cast<std::uint32_t>(point)) ^ sobol.shift) * 0x1.0p-32;
}

UnitPoint UnitSample::point(std::size_t number) const {
  UnitPoint point(std::max(sobol_.size(), points_.size()));
  for (std::size_t axis = 0; axis < point.size(); ++axis) point[axis] = at(number, axis);
  return point;
}

}  // namespace hapbench
