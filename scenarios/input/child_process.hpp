#pragma once

#include <cstddef>
#include <functional>
#include <string>

namespace hapbench {

/// What a child process may use up before it is ended.
struct ChildLimits {
  unsigned cpu_seconds = 1;
  unsigned wall_seconds = 60;     ///< in case it waits for something
  std::size_t memory = 1u << 30;  ///< address space beyond what it has of its parent [bytes]; not under sanitizers
  std::size_t answer = 1u << 30;  ///< [bytes]
};

/// How the work of a child process ended.
struct ChildAnswer {
  enum class End {
    answered,
    failed,     ///< the work threw an exception
    crashed,    ///< a signal ended it
    too_slow,   ///< it used up its time
    too_large,  ///< it used up its memory, or its answer grew too long
  };
  End end = End::crashed;
  std::string bytes;  ///< of an answer
};

/// Does `work`, which may crash, hang or eat memory, in a child process, and returns the bytes it returns. The child
/// prints nothing and leaves nothing behind. Several threads may call it, one child works at a time; beside other
/// threads the work may use memory, which the C library keeps usable in a child, but no lock that those threads hold.
/// Linux. Throws std::system_error when there can be no child.
ChildAnswer answer_of_child(const std::function<std::string()>& work, const ChildLimits& limits);

}  // namespace hapbench
