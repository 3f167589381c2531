#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "scenarios/batch/axis.hpp"

/// Samples of a box: Latin hypercubes, independent points, and points from a file.
namespace hapbench {

/// How points are distributed over the unit cube.
enum class SamplingMethod {
  latin_hypercube,  ///< along each axis one point in each of `count` equal strata (McKay, Beckman, Conover 1979)
  random,           ///< independent and uniform
  points            ///< as a file has them
};

/// The name of a method, as in --sample.
std::string_view sampling_name(SamplingMethod method);

/// A sample of the unit cube. Equal samples have the same points to the last bit on every machine.
struct Sampling {
  SamplingMethod method = SamplingMethod::latin_hypercube;
  std::size_t count = 1;   ///< points
  std::uint64_t seed = 1;  ///< of the shuffles, or the points themselves
};

/// Reads "lhs:N" or "random:N" with 1 <= N <= kMostRuns. Throws InputError.
Sampling parse_sampling(const std::string& text, std::uint64_t seed);

/// The coordinates in [0, 1) of each point along an axis, from a stream of random numbers of its own: one more axis
/// does not change the others. Precondition: the points are not those of a file.
std::vector<double> unit_sample(const Sampling& sampling, std::size_t axis);

/// The points of a file, a row each: the columns are the axes, whose values are listed once.
struct PointTable {
  std::vector<Axis> axes;
  std::vector<std::vector<std::uint32_t>> places;  ///< by axis: which of the axis's values a point has
};

/// Reads the table of --points: a header of fields' paths, and their values. Throws InputError with the line.
PointTable read_points(const std::filesystem::path& file);

}  // namespace hapbench
