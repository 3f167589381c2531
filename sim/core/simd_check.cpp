// Program that checks the SIMD operations. The build compiles this program with the flags of the simulation kernels and
// runs it before it compiles the kernels.
#include "sim/core/simd_check.hpp"

#include <cstdio>

int main() {
  const std::string wrong = hapbench::simd::first_wrong_operation(hapbench::simd::kOperations);
  if (wrong.empty()) return 0;
  std::fprintf(
      stderr,
      "hapbench: compiled by this compiler, the operation \"%s\" on eight doubles at a time gives wrong results; use "
      "another compiler or -DHAPBENCH_SIMD=OFF\n",
      wrong.c_str());
  return 1;
}
