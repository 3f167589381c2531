#pragma once

#include <istream>
#include <string>

namespace hapbench {

/// Identifies the program and the machine that computed a result: part of summary.json, but for the instruction set,
/// of which only times depend. So summary.json is byte-identical between the scalar and the SIMD build of one tree, and
/// timing.json names the set. Unknown parts are "unknown".
struct Provenance {
  std::string version;      ///< of hapbench
  std::string commit;       ///< of the source tree at build time; ends in "-dirty" when tracked files differ from it
  std::string compiler;     ///< name and version
  std::string build_type;   ///< of CMake
  std::string flags;        ///< compiler flags that can change numbers
  std::string cpu;          ///< model name
  std::string march = {};   ///< value of -march; empty for the compiler's default
  std::string widest = {};  ///< vector extension allowed: "avx512f", "avx2", "avx", "sse2" or "none known"
  bool simd = false;        ///< false for the scalar reference
  std::string plugin = {};  ///< file of the plugin whose algorithm was used; else empty
  std::string plugin_hash = {};  ///< of that file's content

  /// True when the commit identifies the source.
  bool identifies_source() const { return commit != "unknown" && !commit.ends_with("-dirty"); }
};

/// The provenance of the running program. Reads /proc/cpuinfo.
Provenance provenance();
/// The model name in a text like /proc/cpuinfo; "unknown" when it has none.
std::string cpu_model(std::istream& cpuinfo);

}  // namespace hapbench
