#pragma once

#include <istream>
#include <string>

/// Identifies the program and the machine that computed a result.
///
/// The instruction set (-march, SIMD on or off) is kept apart: only times depend on it, so timing.json names it, and
/// summary.json is byte-identical between the scalar and the SIMD build of one tree.
namespace hapbench {

/// Part of summary.json. Unknown parts are "unknown".
struct Provenance {
  std::string version;      ///< of hapbench
  std::string commit;       ///< of the source tree at build time; ends in "-dirty" when tracked files differ from it
  std::string compiler;     ///< name and version
  std::string build_type;   ///< of CMake
  std::string flags;        ///< compiler flags that can change numbers
  std::string cpu;          ///< model name
  std::string plugin = {};  ///< file of the plugin whose algorithm was used; else empty
  std::string plugin_hash = {};  ///< of that file's content

  /// True when the commit identifies the source.
  bool identifies_source() const { return commit != "unknown" && !commit.ends_with("-dirty"); }
};

/// Returns the provenance of the running program. Reads /proc/cpuinfo.
Provenance provenance();

/// Part of timing.json only.
struct InstructionSet {
  std::string march;   ///< value of -march; empty for the compiler's default
  std::string widest;  ///< vector extension the compiler was allowed: "avx512f", "avx2", "avx", "sse2" or "none known"
  bool simd = false;   ///< false for the scalar reference
};

InstructionSet instruction_set();

/// The model name in a text like /proc/cpuinfo; "unknown" when it has none.
std::string cpu_model(std::istream& cpuinfo);

}  // namespace hapbench
