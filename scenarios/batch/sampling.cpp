#include "scenarios/batch/sampling.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <iterator>
#include <numeric>

#include "scenarios/batch/sweep_points.hpp"
#include "scenarios/input/input_error.hpp"
#include "scenarios/input/text_lines.hpp"
#include "sim/core/random.hpp"

namespace hapbench {
namespace {

constexpr std::size_t kLargestDegree = 8;

/// A row of the table of Joe and Kuo: the primitive polynomial x^s + a_1 x^(s-1) + … + a_(s-1) x + 1 over GF(2), with
/// the inner coefficients as the bits of `a`, a_1 first, and the free direction numbers m_1 … m_s.
struct DirectionNumbers {
  std::uint32_t s;
  std::uint32_t a;
  std::array<std::uint32_t, kLargestDegree> m;
};

/// Numbers of the second and later axes. The first axis is van der Corput's sequence.
constexpr DirectionNumbers kNumbers[] = {{1, 0, {{1}}},
                                         {2, 1, {{1, 3}}},
                                         {3, 1, {{1, 3, 1}}},
                                         {3, 2, {{1, 1, 1}}},
                                         {4, 1, {{1, 1, 3, 3}}},
                                         {4, 4, {{1, 3, 5, 13}}},
                                         {5, 2, {{1, 1, 5, 5, 17}}},
                                         {5, 4, {{1, 1, 5, 5, 5}}},
                                         {5, 7, {{1, 1, 7, 11, 19}}},
                                         {5, 11, {{1, 1, 5, 1, 1}}},
                                         {5, 13, {{1, 1, 1, 3, 11}}},
                                         {5, 14, {{1, 3, 5, 5, 31}}},
                                         {6, 1, {{1, 3, 3, 9, 7, 49}}},
                                         {6, 13, {{1, 1, 1, 15, 21, 21}}},
                                         {6, 16, {{1, 3, 1, 13, 27, 49}}},
                                         {6, 19, {{1, 1, 1, 15, 7, 5}}},
                                         {6, 22, {{1, 3, 1, 15, 13, 25}}},
                                         {6, 25, {{1, 1, 5, 5, 19, 61}}},
                                         {7, 1, {{1, 3, 7, 11, 23, 15, 103}}},
                                         {7, 4, {{1, 3, 7, 13, 13, 15, 69}}},
                                         {7, 7, {{1, 1, 3, 13, 7, 35, 63}}},
                                         {7, 8, {{1, 3, 5, 9, 1, 25, 53}}},
                                         {7, 14, {{1, 3, 1, 13, 9, 35, 107}}},
                                         {7, 19, {{1, 3, 1, 5, 27, 61, 31}}},
                                         {7, 21, {{1, 1, 5, 11, 19, 41, 61}}},
                                         {7, 28, {{1, 3, 5, 3, 3, 13, 69}}},
                                         {7, 31, {{1, 1, 7, 13, 1, 19, 1}}},
                                         {7, 32, {{1, 3, 7, 5, 13, 19, 59}}},
                                         {7, 37, {{1, 1, 3, 9, 25, 29, 41}}},
                                         {7, 41, {{1, 3, 5, 13, 23, 1, 55}}},
                                         {7, 42, {{1, 3, 7, 3, 13, 59, 17}}},
                                         {7, 50, {{1, 3, 1, 3, 5, 53, 69}}},
                                         {7, 55, {{1, 1, 5, 5, 23, 33, 13}}},
                                         {7, 56, {{1, 1, 7, 7, 1, 61, 123}}},
                                         {7, 59, {{1, 1, 7, 9, 13, 61, 49}}},
                                         {7, 62, {{1, 3, 3, 5, 3, 55, 33}}},
                                         {8, 14, {{1, 3, 1, 15, 31, 13, 49, 245}}},
                                         {8, 21, {{1, 3, 5, 15, 31, 59, 63, 97}}},
                                         {8, 22, {{1, 3, 1, 11, 11, 11, 77, 249}}},
                                         {8, 38, {{1, 3, 1, 11, 27, 43, 71, 9}}},
                                         {8, 47, {{1, 1, 7, 15, 21, 11, 81, 45}}},
                                         {8, 49, {{1, 3, 7, 3, 25, 31, 65, 79}}},
                                         {8, 50, {{1, 3, 1, 1, 19, 11, 3, 205}}},
                                         {8, 52, {{1, 1, 5, 9, 19, 21, 29, 157}}},
                                         {8, 56, {{1, 3, 7, 11, 1, 33, 89, 185}}},
                                         {8, 67, {{1, 3, 3, 3, 15, 9, 79, 71}}},
                                         {8, 70, {{1, 3, 7, 11, 15, 39, 119, 27}}},
                                         {8, 84, {{1, 1, 3, 1, 11, 31, 97, 225}}},
                                         {8, 97, {{1, 1, 1, 3, 23, 43, 57, 177}}},
                                         {8, 103, {{1, 3, 7, 7, 17, 17, 37, 71}}},
                                         {8, 115, {{1, 3, 1, 5, 27, 63, 123, 213}}},
                                         {8, 122, {{1, 1, 3, 5, 11, 43, 53, 133}}}};
static_assert(std::size(kNumbers) + 1 == kSobolAxes);

constexpr std::size_t kBits = 32;

struct NamedMethod {
  std::string_view name;
  SamplingMethod method;
};
constexpr NamedMethod kMethods[] = {
    {"lhs", SamplingMethod::latin_hypercube}, {"sobol", SamplingMethod::sobol}, {"random", SamplingMethod::random}};

/// Largest coordinate, since rounding could move a point in the last stratum to 1.
constexpr double kLast = 1.0 - 0x1.0p-53;

std::vector<double> latin_hypercube(Random& random, std::size_t count) {
  std::vector<std::size_t> strata(count);
  std::iota(strata.begin(), strata.end(), std::size_t{0});
  random.shuffle(strata);
  std::vector<double> points(count);
  for (std::size_t i = 0; i < count; ++i)
    points[i] = std::min((static_cast<double>(strata[i]) + random.uniform()) / static_cast<double>(count), kLast);
  return points;
}

std::vector<double> independent(Random& random, std::size_t count) {
  std::vector<double> points(count);
  for (double& point : points) point = random.uniform();
  return points;
}

}  // namespace

SobolAxis::SobolAxis(std::size_t axis) {
  if (axis == 0) {
    for (std::size_t i = 0; i < kBits; ++i) directions_[i] = std::uint32_t{1} << (kBits - 1 - i);
    return;
  }
  const DirectionNumbers& numbers = kNumbers[axis - 1];
  const std::size_t s = numbers.s;
  for (std::size_t i = 0; i < s; ++i) directions_[i] = numbers.m[i] << (kBits - 1 - i);
  // The recurrence of Bratley and Fox (1988) that the polynomial defines.
  for (std::size_t i = s; i < kBits; ++i) {
    std::uint32_t v = directions_[i - s] ^ (directions_[i - s] >> s);
    for (std::size_t k = 1; k < s; ++k)
      if ((numbers.a >> (s - 1 - k) & 1) != 0) v ^= directions_[i - k];
    directions_[i] = v;
  }
}

std::uint32_t SobolAxis::at(std::uint32_t point) const {
  std::uint32_t value = 0;
  for (std::uint32_t bits = point ^ (point >> 1); bits != 0; bits &= bits - 1)  // those of the Gray code
    value ^= directions_[static_cast<std::size_t>(std::countr_zero(bits))];
  return value;
}

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
  if (sampling.method == SamplingMethod::sobol && axes > kSobolAxes)
    throw InputError(fmt::format("--sample: got a Sobol sample of {} fields; allowed: at most {}", axes, kSobolAxes));
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
