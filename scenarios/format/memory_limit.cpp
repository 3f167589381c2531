#include "scenarios/format/memory_limit.hpp"

#include <fmt/format.h>
#include <sys/resource.h>

#include <cmath>
#include <fstream>
#include <limits>

namespace hapbench {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Memory that can be had without swapping [B], as the kernel estimates it; infinite where it does not say.
[[maybe_unused]] double free_memory() {
  std::ifstream file("/proc/meminfo");
  std::string name;
  double kilobytes = 0.0;
  for (std::string unit; file >> name >> kilobytes && std::getline(file, unit);) {
    if (name == "MemAvailable:") return 1024.0 * kilobytes;
  }
  return kInfinity;
}

}  // namespace

void limit_memory() {
#ifndef HAPBENCH_SANITIZED  // the sanitizers' own maps of memory, terabytes of addresses, would count
  rlimit limit = {};
  if (::getrlimit(RLIMIT_DATA, &limit) != 0) return;
  const double wanted = 0.75 * free_memory();
  if (!(wanted < static_cast<double>(limit.rlim_cur))) return;
  limit.rlim_cur = static_cast<rlim_t>(wanted);
  ::setrlimit(RLIMIT_DATA, &limit);
#endif
}

std::string memory_limit_text() {
  rlimit limit = {};
  const bool is_known = ::getrlimit(RLIMIT_DATA, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY;
  return fmt::format("{}, three quarters of what was free or what \"ulimit -d\" sets",
                     is_known ? bytes_text(static_cast<double>(limit.rlim_cur)) : "what the system gives");
}

std::string bytes_text(double bytes) {
  if (bytes < 1e6) return fmt::format("{:.0f} kB", std::ceil(1e-3 * bytes));
  return bytes < 1e9 ? fmt::format("{:.3g} MB", 1e-6 * bytes) : fmt::format("{:.3g} GB", 1e-9 * bytes);
}

}  // namespace hapbench
