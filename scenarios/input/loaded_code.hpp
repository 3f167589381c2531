#pragma once

#include <string>

namespace hapbench {

/// Identifies the machine code of this process: the build IDs of the program and of every library it was started with,
/// in hexadecimal. Two processes with the same text compute the same numbers from the same input, so it tells whether
/// what an earlier one stored still holds; nobody has to remember to raise a version. Empty when one of them was linked
/// without a build ID, because then nothing is known.
std::string loaded_code_id();

}  // namespace hapbench
