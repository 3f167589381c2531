#include "scenarios/run/progress_bar.hpp"

#include <unistd.h>

#include <cstdio>

namespace hapbench {
namespace {

constexpr auto kSilence = std::chrono::seconds(2);
constexpr auto kRedraw = std::chrono::milliseconds(200);
constexpr int kWidth = 40;

/// "95 s", "12 min", "30 h"
void print_time(double seconds) {
  const bool minutes = seconds >= 120.0, hours = seconds >= 7200.0;
  std::fprintf(stderr, "%.0f %s",
               hours     ? seconds / 3600.0
               : minutes ? seconds / 60.0
                         : seconds,
               hours     ? "h"
               : minutes ? "min"
                         : "s");
}

}  // namespace

ProgressBar::ProgressBar(std::string label, std::uint64_t total, bool enabled)
    : label_(std::move(label)),
      total_(total),
      enabled_(enabled && isatty(STDERR_FILENO) == 1),
      start_(Clock::now()),
      next_(start_ + kSilence) {}

ProgressBar::~ProgressBar() {
  if (drawn_) std::fprintf(stderr, "\r\033[K");
}

void ProgressBar::show(std::uint64_t done, bool counts) noexcept {
  if (!enabled_) return;
  const auto now = Clock::now();
  if (now < next_) return;
  next_ = now + kRedraw;
  drawn_ = true;
  const double part = static_cast<double>(done) / static_cast<double>(total_);
  const int filled = static_cast<int>(part * kWidth);
  char bar[kWidth + 1] = {};
  for (int i = 0; i < kWidth; ++i) bar[i] = i < filled ? '#' : '.';
  std::fprintf(stderr, "\r%s [%s] %3.0f %%", label_.c_str(), bar, 100.0 * part);
  if (counts) {
    std::fprintf(stderr, ", %llu/%llu", static_cast<unsigned long long>(done), static_cast<unsigned long long>(total_));
    if (done > first_) {
      const double each = std::chrono::duration<double>(now - start_).count() / static_cast<double>(done - first_);
      std::fprintf(stderr, ", ");
      print_time(each * static_cast<double>(total_ - done));
      std::fprintf(stderr, " left");
    }
  }
  std::fprintf(stderr, "\033[K");
  std::fflush(stderr);
}

}  // namespace hapbench
