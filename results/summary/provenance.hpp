#pragma once

#include <istream>
#include <string>

namespace hapbench {

/// Identifies the program and the machine that computed a result. The instruction set (`march`, `widest` and `simd`)
/// affects only times. Therefore only timing.json contains it, and summary.json is byte-identical for the scalar and
/// the SIMD build of one source tree. Fields with an unknown value are "unknown".
struct Provenance {
  std::string version;     ///< version of hapbench
  std::string commit;      ///< commit of the built source tree; ends in "-dirty" if tracked files differ from it
  std::string compiler;    ///< name and version
  std::string build_type;  ///< CMake build type
  std::string flags;       ///< compiler flags that can change numbers
  std::string cpu;         ///< model name
  std::string march = {};  ///< value of -march; empty for the compiler's default
  /// Widest vector extension that the build may use: "avx512f", "avx2", "avx", "sse2" or "none known".
  std::string widest = {};
  bool simd = false;             ///< true for the SIMD build, false for the scalar reference build
  std::string plugin = {};       ///< file of the plugin whose algorithm was used; empty: none
  std::string plugin_hash = {};  ///< hash of the content of the plugin's file; empty without a plugin

  /// Returns true if the commit identifies the source code.
  bool identifies_source() const { return commit != "unknown" && !commit.ends_with("-dirty"); }
};

/// Returns the provenance of the running program. Reads /proc/cpuinfo.
Provenance provenance();
/// Returns the CPU's model name from a text in the format of /proc/cpuinfo; "unknown" if the text contains no model
/// name.
std::string cpu_model(std::istream& cpuinfo);

}  // namespace hapbench
