#pragma once

#include <istream>
#include <string>

/// Identifies the program and the machine that computed a result.
///
/// The instruction set (-march, SIMD on or off) is kept apart. Results do not depend on it, and summary.json is
/// byte-identical between the scalar and the SIMD build of one tree; it could not be if it named the build. What
/// depends on the instruction set is time, so timing.json names it.
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

  /// The source and the build, for results that only the same program may go on with; empty when the commit does not
  /// identify the source.
  std::string identity() const;
};

/// Returns the provenance of the running program. Reads /proc/cpuinfo.
Provenance provenance();

/// Part of timing.json only.
struct InstructionSet {
  std::string march;  ///< value of -march; empty for the compiler's default
  std::string
      widest;  ///< widest vector extension the compiler was allowed: "avx512f", "avx2", "avx", "sse2" or "none known"
  bool simd = false;  ///< false for the scalar reference
};

InstructionSet instruction_set();

/// The model name in a text like /proc/cpuinfo; "unknown" when it has none.
std::string cpu_model(std::istream& cpuinfo);

}  // namespace hapbench
