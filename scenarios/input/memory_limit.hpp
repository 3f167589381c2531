#pragma once

#include <optional>
#include <string>

/// How much memory this process may take.
namespace hapbench {

/// Limits the memory of this process and of programs that it starts [B]; by default to three quarters of what is free.
/// Beyond it an allocation throws std::bad_alloc. Never raises a limit that the system or the user has set.
void limit_memory(std::optional<double> bytes);

/// The limit that holds, whoever set it [B]; infinite without one.
double memory_limit();
/// It in words, with what sets it.
std::string memory_limit_text();

/// Refuses, before it is begun, work that is expected to take more than memory_limit(). Throws InputError, whose text
/// says what needs so much and how the limit is raised.
void require_memory(double bytes, const std::string& what);

/// An amount of data, as in "271 MB".
std::string bytes_text(double bytes);

}  // namespace hapbench
