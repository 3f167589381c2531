#pragma once

#include <string>

/// How much memory this process may take.
namespace hapbench {

/// Limits the memory of this process and of programs that it starts to three quarters of what is free. Beyond it an
/// allocation throws std::bad_alloc. Never raises a limit that the system or the user has set.
void limit_memory();

/// The limit that holds, whoever set it, in words, with what sets it.
std::string memory_limit_text();

/// An amount of data, as in "271 MB".
std::string bytes_text(double bytes);

}  // namespace hapbench
