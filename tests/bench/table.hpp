#pragma once

namespace hapbench::bench {

/// Measures every target of the bench and prints a Markdown table of them, with machine, compiler and commit. Takes
/// about ten seconds. Returns the exit status: 0, also when a target is missed, because a busy machine misses some; 1
/// when an answer is wrong.
int print_table();

}  // namespace hapbench::bench
