#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

/// Samples of the unit cube: Latin hypercubes, Sobol sequences, and independent points.
namespace hapbench {

/// Number of axes that have direction numbers.
inline constexpr std::size_t kSobolAxes = 53;

/// One coordinate of the Sobol sequence: a (t, s)-sequence in base two. Of its first 2^k points, one lies in each of
/// the 2^k elementary intervals of length 2^-k.
///
/// Direction numbers: S. Joe and F. Y. Kuo, "Constructing Sobol sequences with better two-dimensional projections",
/// SIAM J. Sci. Comput. 30 (2008) 2635-2654, the set new-joe-kuo-6.21201, here for polynomials up to degree 8. Points
/// come in the Gray-code order of Antonov and Saleev (1979); the first one is 0.
class SobolAxis {
 public:
  /// Precondition: axis < kSobolAxes.
  explicit SobolAxis(std::size_t axis);

  /// The coordinate of a point, in units of 2^-32.
  std::uint32_t at(std::uint32_t point) const;

 private:
  std::array<std::uint32_t, 32> directions_;  ///< in units of 2^-32
};

/// How points are distributed over the unit cube.
enum class SamplingMethod {
  latin_hypercube,  ///< along each axis one point in each of `count` equal strata (McKay, Beckman, Conover 1979)
  sobol,            ///< low-discrepancy sequence, best for counts that are powers of two
  random            ///< independent and uniform
};

/// The name of a method, as in --sample.
std::string_view sampling_name(SamplingMethod method);

/// A sample of the unit cube. Equal samples have the same points to the last bit on every machine.
struct Sampling {
  SamplingMethod method = SamplingMethod::latin_hypercube;
  std::size_t count = 1;   ///< points
  std::uint64_t seed = 1;  ///< of the shuffles, the digital shift, or the points themselves
};

/// Reads "lhs:N", "sobol:N" or "random:N" with 1 <= N <= kMostRuns. Throws InputError.
Sampling parse_sampling(const std::string& text, std::uint64_t seed);

/// One point, a coordinate in [0, 1) for each axis.
using UnitPoint = std::vector<double>;

/// The points of a sample. A Sobol sequence is shifted digitally (the bits of each coordinate are combined with the
/// same random bits by exclusive or; Cranley-Patterson in base two, Owen 2003), which keeps its balance and makes it
/// depend on the seed; its points are computed on demand. The points of the other methods come from one stream of
/// random numbers for each axis and are stored, in 8 bytes for each point and axis.
class UnitSample {
 public:
  /// Throws InputError for a Sobol sample of more axes than there are direction numbers.
  UnitSample(const Sampling& sampling, std::size_t axes);

  /// A coordinate in [0, 1). Precondition: point and axis are in the sample.
  double at(std::size_t point, std::size_t axis) const;
  /// All coordinates of a point. Precondition: it is in the sample.
  UnitPoint point(std::size_t number) const;

 private:
  struct ShiftedSobol {
    SobolAxis sequence;
    std::uint32_t shift;
  };
  std::vector<ShiftedSobol> sobol_;          ///< by axis; empty for the other methods
  std::vector<std::vector<double>> points_;  ///< by axis; empty for a Sobol sequence
};

}  // namespace hapbench
