#include "scenarios/run/stop_signal.hpp"

#include <unistd.h>

#include <atomic>
#include <chrono>
#include <string_view>

namespace hapbench {
namespace {

constexpr int kSignals[] = {SIGINT, SIGTERM};

using Clock = std::chrono::steady_clock;

std::atomic<int> received_signal{0};
std::atomic<Clock::time_point> received_at;
static_assert(std::atomic<int>::is_always_lock_free && std::atomic<Clock::time_point>::is_always_lock_free,
              "a signal handler may not lock");

/// Time after which a signal terminates the process if the work does not end, because a module never returns or a read
/// from a pipe blocks.
constexpr unsigned kStopTimeout = 2;  // [s]

/// Signals within this time count as a single signal: timeout(1) sends each signal twice, to its child and to
/// the process group.
constexpr auto kSameSignal = std::chrono::milliseconds(200);

void end_process(int signal) {
  ::signal(signal, SIG_DFL);
  ::raise(signal);
}

/// Handler of SIGALRM: prints a message and terminates the process.
void end_without_notice(int) {
  constexpr std::string_view kText = "hapbench: ended amid work that did not notice the signal for two seconds\n";
  [[maybe_unused]] const auto written = ::write(STDERR_FILENO, kText.data(), kText.size());
  end_process(received_signal);
}

/// Handler of SIGINT and SIGTERM: records the first signal and starts the alarm. A later signal terminates the
/// process.
void note(int signal) {
  const Clock::time_point now = Clock::now();
  if (received_signal != 0) {
    if (now - received_at.load() > kSameSignal) end_process(signal);
    return;
  }
  received_at = now;
  received_signal = signal;
  ::signal(SIGALRM, end_without_notice);
  ::alarm(kStopTimeout);
}

}  // namespace

StopSignal::StopSignal() {
  received_signal = 0;
  struct sigaction action {};
  action.sa_handler = note;
  action.sa_flags = SA_RESTART;
  sigfillset(&action.sa_mask);  // a handler must not interrupt another handler
  for (int i = 0; i < 2; ++i) {
    ::sigaction(kSignals[i], nullptr, &before_[i]);
    if (before_[i].sa_handler != SIG_IGN) ::sigaction(kSignals[i], &action, nullptr);
  }
}

StopSignal::~StopSignal() {
  ::alarm(0);
  for (int i = 0; i < 2; ++i) ::sigaction(kSignals[i], &before_[i], nullptr);
  received_signal = 0;
}

int StopSignal::received() noexcept {
  return received_signal;
}

void stop_work(int signal) noexcept {
  received_signal = signal;
}

void throw_if_stopped() {
  if (const int signal = StopSignal::received(); signal != 0) throw Stopped{signal};
}

}  // namespace hapbench
