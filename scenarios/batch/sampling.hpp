#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "scenarios/batch/axis.hpp"

/// Points of a sample (--sample, --points) in the unit cube, one coordinate for each axis.
namespace hapbench {

// How points are distributed over the unit cube, as in --sample.
/// Along each axis one point in each of `count` equal strata (McKay, Beckman, Conover 1979).
inline constexpr std::string_view kLatinHypercube = "lhs";
inline constexpr std::string_view kRandomPoints = "random";  ///< independent and uniform
inline constexpr std::string_view kPointsOfFile = "points";

/// A sample of the unit cube. Equal samples have the same points to the last bit on every machine.
struct Sampling {
  std::string_view method = kLatinHypercube;      ///< one of these names
  std::size_t count = 1;                          ///< points
  std::uint64_t seed = 1;                         ///< of the shuffles, or the points themselves
  std::vector<std::vector<double>> of_file = {};  ///< by axis: the coordinates of the points of a file
};

/// Reads "lhs:N" or "random:N" with 1 <= N <= kMostRuns. Throws InputError.
Sampling parse_sampling(const std::string& text, std::uint64_t seed);

/// The coordinates in [0, 1) of each point along an axis, from a stream of random numbers of its own: one more axis
/// does not change the others.
std::vector<double> unit_sample(const Sampling& sampling, std::size_t axis);

/// Reads the table of --points: a header of fields' paths, which become axes that list each value once, and a row of
/// values for each point. Throws InputError with the line.
Sampling read_points(const std::filesystem::path& file, std::vector<Axis>& axes);

}  // namespace hapbench
