#include "scenarios/input/child_process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <fstream>
#include <mutex>
#include <new>
#include <system_error>

namespace hapbench {
namespace {

using Clock = std::chrono::steady_clock;
using End = ChildAnswer::End;

enum ChildStatus : int { kAnswered = 0, kFailed = 1, kOutOfMemory = 2 };

[[noreturn]] void fail(const char* what) {
  throw std::system_error(errno, std::generic_category(), what);
}

/// The soft limit may only go down.
void limit(decltype(RLIMIT_CPU) resource, rlim_t most) {
  rlimit limit{};
  ::getrlimit(resource, &limit);
  if (most < limit.rlim_cur) limit.rlim_cur = most;
  ::setrlimit(resource, &limit);
}

/// Address space of this process [bytes]; it grows with the number of the parent's threads.
std::size_t address_space() {
  std::size_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
}

void restrict_child(const ChildLimits& limits) {
  // Libraries complain on standard error, the C library too when the heap is broken.
  const int null = ::open("/dev/null", O_RDWR);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) ::dup2(null, stream);
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_CPU, limits.cpu_seconds);
#if !defined(__SANITIZE_ADDRESS__)  // whose shadow memory is larger than any limit
  limit(RLIMIT_AS, address_space() + limits.memory);
#endif
}

bool write_all(int pipe, const std::string& bytes) {
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t n = ::write(pipe, bytes.data() + done, bytes.size() - done);
    if (n < 0 && errno != EINTR) return false;
    if (n > 0) done += static_cast<std::size_t>(n);
  }
  return true;
}

/// Ends without the destructors and buffers that belong to the parent.
[[noreturn]] void be_child(const std::function<std::string()>& work, const ChildLimits& limits, int pipe) {
  int status = kFailed;
  try {
    // A file that the parent has locked would stay locked for as long as the child lives.
    ::close_range(STDERR_FILENO + 1, static_cast<unsigned>(pipe - 1), 0);
    ::close_range(static_cast<unsigned>(pipe + 1), ~0u, 0);
    restrict_child(limits);
    if (write_all(pipe, work())) status = kAnswered;
  } catch (const std::bad_alloc&) {
    status = kOutOfMemory;
  } catch (...) {
    status = kFailed;
  }
  ::_exit(status);
}

/// Reads to the end of the pipe, which is the child's; `answered` then, or why not.
End read_answer(int pipe, const ChildLimits& limits, std::string& bytes) {
  const auto deadline = Clock::now() + std::chrono::seconds(limits.wall_seconds);
  std::array<char, 1 << 16> piece;
  for (;;) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now()).count();
    if (left <= 0) return End::too_slow;
    pollfd ready{pipe, POLLIN, 0};
    if (::poll(&ready, 1, static_cast<int>(left)) <= 0) continue;
    const ssize_t n = ::read(pipe, piece.data(), piece.size());
    if (n == 0) return End::answered;
    if (n < 0 && errno != EINTR) return End::failed;
    if (n > 0) bytes.append(piece.data(), static_cast<std::size_t>(n));
    if (bytes.size() > limits.answer) return End::too_large;
  }
}

End end_of(int status) {
  if (WIFSIGNALED(status)) return WTERMSIG(status) == SIGXCPU ? End::too_slow : End::crashed;
  switch (WEXITSTATUS(status)) {
    case kAnswered:
      return End::answered;
    case kOutOfMemory:
      return End::too_large;
    case kFailed:
      return End::failed;
    default:  // a sanitizer ended it
      return End::crashed;
  }
}

}  // namespace

ChildAnswer answer_of_child(const std::function<std::string()>& work, const ChildLimits& limits) {
  // Two at a time would hold each other's pipes open, whose ends are what the answers end with.
  static std::mutex one_at_a_time;
  const std::lock_guard lock(one_at_a_time);
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) fail("cannot make a pipe");
  const pid_t child = ::fork();
  if (child < 0) fail("cannot start a process");
  if (child == 0) be_child(work, limits, ends[1]);
  ::close(ends[1]);
  ChildAnswer answer;
  answer.end = read_answer(ends[0], limits, answer.bytes);
  ::close(ends[0]);
  if (answer.end != End::answered) ::kill(child, SIGKILL);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
  // Only a child that was not killed can tell why it ended.
  if (answer.end == End::answered) answer.end = end_of(status);
  return answer;
}

}  // namespace hapbench
