#include "scenarios/input/memory_limit.hpp"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>

#include "scenarios/input/input_error.hpp"

namespace hapbench {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Memory that can be had without swapping [B], as the kernel estimates it; infinite where it does not say.
double free_memory() {
  std::ifstream file("/proc/meminfo");
  std::string name;
  double kilobytes = 0.0;
  for (std::string unit; file >> name >> kilobytes && std::getline(file, unit);) {
    if (name == "MemAvailable:") return 1024.0 * kilobytes;
  }
  return kInfinity;
}

#ifdef HAPBENCH_SANITIZED
// The sanitizers' own maps of memory, terabytes of addresses, would count as the program's data.
rlimit sanitized_limit = {RLIM_INFINITY, RLIM_INFINITY};

int get_limit(rlimit& limit) {
  limit = sanitized_limit;
  return 0;
}

void set_limit(const rlimit& limit) {
  sanitized_limit = limit;
}
#else
int get_limit(rlimit& limit) {
  return ::getrlimit(RLIMIT_DATA, &limit);
}

void set_limit(const rlimit& limit) {
  ::setrlimit(RLIMIT_DATA, &limit);
}
#endif

}  // namespace

void limit_memory(std::optional<double> bytes) {
  rlimit limit = {};
  if (get_limit(limit) != 0) return;
  const double wanted = std::min(bytes.value_or(0.75 * free_memory()), static_cast<double>(limit.rlim_max));
  limit.rlim_cur = wanted < 0x1p62 ? static_cast<rlim_t>(wanted) : limit.rlim_max;
  set_limit(limit);
}

double memory_limit() {
  rlimit limit = {};
  return get_limit(limit) == 0 && limit.rlim_cur != RLIM_INFINITY ? static_cast<double>(limit.rlim_cur) : kInfinity;
}

std::string memory_limit_text() {
  return fmt::format("{}, three quarters of what was free or what --memory sets", bytes_text(memory_limit()));
}

void require_memory(double bytes, const std::string& what) {
  if (bytes <= memory_limit()) return;
  throw InputError(fmt::format("{} would take about {}; allowed: {}", what, bytes_text(bytes), memory_limit_text()));
}

std::string bytes_text(double bytes) {
  if (bytes < 1e6) return fmt::format("{:.0f} kB", std::ceil(1e-3 * bytes));
  return bytes < 1e9 ? fmt::format("{:.3g} MB", 1e-6 * bytes) : fmt::format("{:.3g} GB", 1e-9 * bytes);
}

}  // namespace hapbench
