#include "algorithms/plugin/plugin_call.hpp"

#include <unistd.h>

#include <array>
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <utility>

namespace hapbench {
namespace {

/// The call in which a thread is. States are never freed, because handlers of signals on any thread read them; a thread
/// that ends leaves its state to another one.
struct ThreadState {
  std::atomic<bool> taken = true;
  std::atomic<const char*> plugin = nullptr;  ///< null outside of plugins
  std::atomic<const char*> function = nullptr;
  ThreadState* next = nullptr;
  std::array<char, 1 << 15> handler_stack;  ///< so that the overflow of the thread's own stack can be reported
};
static_assert(std::atomic<const char*>::is_always_lock_free, "a signal handler may not lock");

std::atomic<ThreadState*> threads{nullptr};
thread_local ThreadState* this_thread = nullptr;
std::atomic<bool> handles_crashes{false};
int status_of_exit = 0;

/// A state that an ended thread has left, or a new one.
ThreadState* take_state() {
  for (ThreadState* left = threads; left != nullptr; left = left->next) {
    if (!left->taken.exchange(true)) return left;
  }
  ThreadState* made = new ThreadState;
  made->next = threads;
  while (!threads.compare_exchange_weak(made->next, made)) {
  }
  return made;
}

/// The state of this thread, which it leaves at its end.
class OwnState {
 public:
  OwnState() {
    this_thread = take_state();
    if (!handles_crashes) return;  // the host may have a stack of its own for its handlers
    stack_t stack = {};
    stack.ss_sp = this_thread->handler_stack.data();
    stack.ss_size = this_thread->handler_stack.size();
    ::sigaltstack(&stack, nullptr);
  }
  ~OwnState() {
    if (this_thread->plugin != nullptr) return;  // the plugin has called exit, and on_exit will name it
    if (handles_crashes) {
      stack_t none = {};
      none.ss_flags = SS_DISABLE;
      ::sigaltstack(&none, nullptr);
    }
    std::exchange(this_thread, nullptr)->taken = false;
  }
  OwnState(const OwnState&) = delete;
  OwnState& operator=(const OwnState&) = delete;
};

ThreadState& state() {
  if (this_thread == nullptr) thread_local const OwnState own;
  return *this_thread;
}

/// Writes the line if the thread is inside a plugin. Calls nothing that a signal handler may not.
bool write_line(const ThreadState* thread, const char* what) noexcept {
  const char* plugin = thread != nullptr ? thread->plugin.load() : nullptr;
  if (plugin == nullptr) return false;
  for (const char* part : {"hapbench: error: the plugin ", plugin, what, thread->function.load(), "\n"}) {
    if (::write(STDERR_FILENO, part, std::strlen(part)) < 0) return true;
  }
  return true;
}

constexpr int kCrashes[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};
struct sigaction before[std::size(kCrashes)];

/// Gives the signal back to its former handler, which receives it when this one returns and the instruction that
/// crashed runs again.
void on_crash(int signal, siginfo_t* info, void*) {
  write_line(this_thread, signal == SIGABRT ? " aborted in " : " crashed in ");
  for (std::size_t i = 0; i < std::size(kCrashes); ++i) {
    if (kCrashes[i] == signal) ::sigaction(signal, &before[i], nullptr);
  }
  if (info->si_code <= 0) ::raise(signal);  // sent by a process, this one included
}

void on_exit() {
  if (write_line(this_thread, " ended the program in ")) ::_exit(status_of_exit);
}

}  // namespace

PluginCall::PluginCall(const char* plugin, const char* function) noexcept {
  ThreadState& thread = state();
  thread.function.store(function, std::memory_order_relaxed);
  thread.plugin.store(plugin, std::memory_order_release);
}

PluginCall::~PluginCall() {
  this_thread->plugin.store(nullptr, std::memory_order_relaxed);
}

void name_plugins_that_end_the_process(int exit_status) {
  handles_crashes = true;
  status_of_exit = exit_status;
  std::atexit(on_exit);
  std::at_quick_exit(on_exit);
  struct sigaction action {};
  action.sa_sigaction = on_crash;
  action.sa_flags = SA_SIGINFO | SA_ONSTACK;
  for (std::size_t i = 0; i < std::size(kCrashes); ++i) ::sigaction(kCrashes[i], &action, &before[i]);
}

bool write_running_plugins() noexcept {
  bool any = false;
  for (const ThreadState* thread = threads; thread != nullptr; thread = thread->next) {
    any |= write_line(thread, " does not return from ");
  }
  return any;
}

}  // namespace hapbench
