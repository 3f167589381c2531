#pragma once

#include <string>
#include <vector>

namespace hapbench {

/// One field that a sweep varies and the values it takes.
struct Axis {
  std::string path;                 ///< dotted, as in --set
  std::vector<std::string> values;  ///< as in --set; numbers as shortest decimals, nothing that CSV would have to quote
};

/// Reads "path=a:b:n" (n numbers from a to b, both exactly, in equal steps), "path=a:b:n:log" (in equal ratios) or
/// "path=v,w,…" (numbers or texts). Throws InputError. Whether the field exists and takes the values is for the
/// scenario to say.
Axis parse_axis(const std::string& text);

}  // namespace hapbench
