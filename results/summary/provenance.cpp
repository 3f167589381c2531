#include "results/summary/provenance.hpp"

#include <fstream>

#include "hapbench_commit.hpp"

#ifndef HAPBENCH_MARCH
#define HAPBENCH_MARCH ""
#endif

namespace hapbench {

Provenance provenance() {
#if defined(__AVX512F__)
  const char* widest = "avx512f";
#elif defined(__AVX2__)
  const char* widest = "avx2";
#elif defined(__AVX__)
  const char* widest = "avx";
#elif defined(__SSE2__)
  const char* widest = "sse2";
#else
  const char* widest = "none known";
#endif
  std::ifstream cpuinfo("/proc/cpuinfo");
  return {.version = HAPBENCH_VERSION,
          .commit = HAPBENCH_COMMIT,
          .compiler = HAPBENCH_COMPILER,
          .build_type = HAPBENCH_BUILD_TYPE,
          .flags = HAPBENCH_FLAGS,
          .cpu = cpu_model(cpuinfo),
          .march = HAPBENCH_MARCH,
          .widest = widest,
          .simd = HAPBENCH_SIMD != 0};
}

std::string cpu_model(std::istream& cpuinfo) {
  for (std::string line; std::getline(cpuinfo, line);) {
    if (!line.starts_with("model name")) continue;
    const std::size_t value = line.find_first_not_of(" \t", line.find(':') + 1);
    if (value != std::string::npos) return line.substr(value);
  }
  return "unknown";
}

}  // namespace hapbench
