#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "scenarios/batch/sobol.hpp"

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
/// meaning; its points are computed when they are asked for. The others come from one stream of random numbers for each
/// axis and are kept, in 8 bytes a point and axis.
class UnitSample {
 public:
  /// Throws InputError for a Sobol sample of more axes than there are direction numbers.
  UnitSample(const Sampling& sampling, std::size_t axes);

  /// A coordinate in [0, 1). Precondition: point and axis are in the sample.
  double at(std::size_t point, std::size_t axis) const;
  /// All of a point. Precondition: it is in the sample.
  UnitPoint point(std::size_t number) const;

 private:
  struct ShiftedSobol {
    SobolAxis sequence;
    std::uint32_t shift;
  };
  std::vector<ShiftedSobol> sobol_;          ///< by axis, or none
  std::vector<std::vector<double>> points_;  ///< by axis, or none
};

}  // namespace hapbench
