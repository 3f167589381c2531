#include "scenarios/run/stop_signal.hpp"

#include <unistd.h>

#include <atomic>
#include <ctime>
#include <string_view>

#include "algorithms/plugin/plugin_call.hpp"

namespace hapbench {

namespace {

constexpr int kSignals[] = {SIGINT, SIGTERM};

std::atomic<int> received_signal{0};
static_assert(std::atomic<int>::is_always_lock_free, "a signal handler may not lock");

/// Time after which a signal that nobody has asked for ends the process: a plugin may loop, a pipe may never deliver.
constexpr unsigned kPatience = 2;  // [s]

/// Time within which a further signal is the same one: timeout(1) and process groups deliver each twice.
constexpr double kSameSignal = 0.2;  // [s]

void end_process(int signal) {
  ::signal(signal, SIG_DFL);
  ::raise(signal);
}

void end_without_notice(int) {
  constexpr std::string_view kText = "hapbench: ended amid work that did not notice the signal for two seconds\n";
  if (!write_running_plugins()) {
    [[maybe_unused]] const auto written = ::write(STDERR_FILENO, kText.data(), kText.size());
  }
  end_process(received_signal);
}

/// Seconds of a clock that only goes forward.
double now() {
  timespec time;
  ::clock_gettime(CLOCK_MONOTONIC, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

void note(int signal) {
  static std::atomic<double> first{0.0};
  if (received_signal != 0) {
    if (now() - first > kSameSignal) end_process(signal);
    return;
  }
  first = now();
  received_signal = signal;
  ::signal(SIGALRM, end_without_notice);
  ::alarm(kPatience);
}

}  // namespace

StopSignal::StopSignal() {
  received_signal = 0;
  struct sigaction action {};
  action.sa_handler = note;
  action.sa_flags = SA_RESTART;
  for (const int signal : kSignals) sigaddset(&action.sa_mask, signal);  // one at a time
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

SimulationResult run_to_end(Simulation& simulation) {
  do {
    throw_if_stopped();
  } while (simulation.advance(kAskEvery));
  throw_if_stopped();  // a force law may have ended the run by a force that is none, because the work is to stop
  return simulation.result();
}

}  // namespace hapbench
