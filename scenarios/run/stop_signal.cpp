#include "scenarios/run/stop_signal.hpp"

#include <unistd.h>

#include <atomic>
#include <string_view>

#include "algorithms/plugin/plugin_call.hpp"

namespace hapbench {

namespace {

constexpr int kSignals[] = {SIGINT, SIGTERM};

std::atomic<int> received_signal{0};
static_assert(std::atomic<int>::is_always_lock_free, "a signal handler may not lock");

/// Time after which a signal that nobody has asked for ends the process: a plugin may loop, a pipe may never deliver.
constexpr unsigned kPatience = 2;  // [s]

void end_process(int) {
  const int signal = received_signal;
  constexpr std::string_view kText = "hapbench: ended amid work that did not notice the signal for two seconds\n";
  if (!write_running_plugins()) {
    [[maybe_unused]] const auto written = ::write(STDERR_FILENO, kText.data(), kText.size());
  }
  ::signal(signal, SIG_DFL);
  ::raise(signal);
}

void note(int signal) {
  received_signal = signal;
  ::signal(SIGALRM, end_process);
  ::alarm(kPatience);
}

}  // namespace

StopSignal::StopSignal() {
  received_signal = 0;
  struct sigaction action {};
  action.sa_handler = note;
  action.sa_flags = static_cast<int>(SA_RESETHAND) | SA_RESTART;
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
