#include "scenarios/run/progress.hpp"

#include <unistd.h>

#include <cstdio>

namespace hapbench {
namespace {

constexpr auto kSilence = std::chrono::seconds(2);
constexpr auto kRedraw = std::chrono::milliseconds(200);
constexpr std::uint64_t kLookEvery = 1024;  // steps between two looks at the clock
constexpr int kWidth = 40;

}  // namespace

Progress::Progress(std::string label, std::uint64_t steps, bool enabled)
    : label_(std::move(label)),
      steps_(steps),
      enabled_(enabled && isatty(STDERR_FILENO) == 1),
      next_(Clock::now() + kSilence) {}

Progress::~Progress() {
  if (drawn_) std::fprintf(stderr, "\r\033[K");
}

void Progress::on_step(const StepRecord& record) noexcept {
  if (record.step % kLookEvery == 0) show(record.step);
}

void Progress::show(std::uint64_t done) noexcept {
  if (!enabled_) return;
  const auto now = Clock::now();
  if (now < next_) return;
  next_ = now + kRedraw;
  drawn_ = true;
  const double part = static_cast<double>(done) / static_cast<double>(steps_);
  const int filled = static_cast<int>(part * kWidth);
  char bar[kWidth + 1] = {};
  for (int i = 0; i < kWidth; ++i) bar[i] = i < filled ? '#' : '.';
  std::fprintf(stderr, "\r%s [%s] %3.0f %%", label_.c_str(), bar, 100.0 * part);
  std::fflush(stderr);
}

}  // namespace hapbench
