#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace hapbench {

/// How points are strewn over the unit cube.
enum class SamplingMethod {
  latin_hypercube,  ///< along each axis one point in each of `count` equal strata (McKay, Beckman, Conover 1979)
  sobol,            ///< low-discrepancy sequence, best for counts that are powers of two; see sobol.hpp
  random            ///< independent and uniform
};

/// The name of a method, as in --sample.
std::string_view sampling_name(SamplingMethod method);

/// A sample of the unit cube; equal ones are equal to the last bit on every machine.
struct Sampling {
  SamplingMethod method = SamplingMethod::latin_hypercube;
  std::size_t count = 1;   ///< points
  std::uint64_t seed = 1;  ///< of the shuffles, of the digital shift, or of the points themselves
};

/// Reads "lhs:N", "sobol:N" or "random:N" with 1 <= N <= kMostRuns. Throws InputError.
Sampling parse_sampling(const std::string& text, std::uint64_t seed);

/// One point, a coordinate in [0, 1) for each axis.
using UnitPoint = std::vector<double>;

/// The points of a sample. A Sobol sequence is shifted digitally (each coordinate's bits are combined with the same
/// random bits by exclusive or; Cranley-Patterson in base two, Owen 2003), which keeps its balance and gives the seed a
/// meaning. O(count * axes) time and memory. Throws InputError for a Sobol sample of more axes than there are direction
/// numbers.
std::vector<UnitPoint> sample_unit_cube(const Sampling& sampling, std::size_t axes);

}  // namespace hapbench
