#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "scenarios/batch/axis.hpp"

/// Points of a sample (--sample, --points) in the unit cube, with one coordinate for each axis.
namespace hapbench {

// Distributions of the points over the unit cube, as in --sample.
/// Latin hypercube: along each axis, one point in each of `count` equal intervals (McKay, Beckman, Conover
/// 1979).
inline constexpr std::string_view kLatinHypercube = "lhs";
inline constexpr std::string_view kRandomPoints = "random";  ///< independent, uniformly distributed points
/// Name for points that are read from a file (--points).
inline constexpr std::string_view kPointsOfFile = "points";

/// A sample of the unit cube. Samples with equal members have bit-identical points on every machine.
struct Sampling {
  std::string_view method = kLatinHypercube;      ///< kLatinHypercube, kRandomPoints or kPointsOfFile
  std::size_t count = 1;                          ///< number of points
  std::uint64_t seed = 1;                         ///< seed of the random points
  std::vector<std::vector<double>> of_file = {};  ///< coordinates of points from a file, by axis, then by point
  std::filesystem::path file = {};                ///< the file of --points
  std::vector<std::size_t> lines = {};            ///< line of each point in this file, from 1
  std::string warning = {};                       ///< what is odd about this file; empty if nothing is
};

/// Parses "lhs:N" or "random:N" with 1 <= N <= kMaxRuns. Throws InputError.
Sampling parse_sampling(const std::string& text, std::uint64_t seed);

/// Returns the coordinates in [0, 1) of all points along an axis. Each axis has its own stream of random numbers, so
/// that an additional axis does not change the coordinates along the other axes.
std::vector<double> unit_sample(const Sampling& sampling, std::size_t axis);

/// Reads the table of --points. Its header contains paths of fields, and each further row the values of one point.
/// Appends to `axes` an axis for each field; the axis lists each value once. Commas, semicolons, tabs or white space
/// separate cells. Lines that begin with '#' or '%' are comments. A comment with paths is the header if the first line
/// that is not a comment has no paths. Throws InputError with the number of the line.
Sampling read_points(const std::filesystem::path& file, std::vector<Axis>& axes);

}  // namespace hapbench
