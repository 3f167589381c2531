#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstdio>
#include <cstring>

/// Guards against plugins behind a C interface: they name the one whose code is running when the process crashes, exits
/// or cannot be stopped in it, find writes beyond an answer and keep the reason of a failure.
namespace hapbench {

/// Marks that this thread runs a function of a plugin, from construction to destruction. Costs some nanoseconds; the
/// first on a thread allocates. Calls do not nest. Both texts must outlive the object.
class PluginCall {
 public:
  PluginCall(const char* plugin, const char* function) noexcept;
  ~PluginCall();
  PluginCall(const PluginCall&) = delete;
  PluginCall& operator=(const PluginCall&) = delete;
};

/// From now on a crash (SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT) or `exit` inside a plugin first writes one line with
/// the plugin's name to standard error. A crash then ends the process as it would have, `exit` with `exit_status`. For
/// programs, not for hosts with handlers of their own.
void name_plugins_that_end_the_process(int exit_status);

/// Writes one line to standard error for each thread that is inside a plugin; false if there is none. May be called in
/// a signal handler.
bool write_running_plugins() noexcept;

/// Numbers before and after what a plugin writes. No computation gives this signalling NaN.
struct Canaries {
  static constexpr std::size_t kCount = 8;
  double values[kCount];

  Canaries() { std::fill_n(values, kCount, std::bit_cast<double>(std::uint64_t{0x7ff4deadc0ffee00})); }
  void write(double* to) const noexcept { std::memcpy(to, values, sizeof values); }
  bool are_at(const double* from) const noexcept { return std::memcmp(from, values, sizeof values) == 0; }
};
inline const Canaries kCanaries;

/// An answer that a plugin writes, between canaries.
template <class Answer>
struct Guarded {
  Canaries before;
  Answer answer;
  Canaries after;

  bool intact() const noexcept { return kCanaries.are_at(before.values) && kCanaries.are_at(after.values); }
};

/// Why a library failed, in one printable line; allocates nothing.
class FaultText {
 public:
  void set(const char* library, const char* problem) noexcept {
    std::snprintf(text_.data(), text_.size(), "%s fails: %s", library, problem);
    for (char& c : text_) c = c == '\0' || (c >= ' ' && c <= '~') ? c : c == '\n' ? ' ' : '?';
  }
  void clear() noexcept { text_[0] = '\0'; }
  /// Null without a fault.
  const char* text() const noexcept { return text_[0] == '\0' ? nullptr : text_.data(); }

 private:
  std::array<char, 256> text_{};
};

}  // namespace hapbench
