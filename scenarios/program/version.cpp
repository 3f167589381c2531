#include "scenarios/program/version.hpp"

#include <fmt/format.h>

#include "results/summary/summary.hpp"
#include "scenarios/input/json_file.hpp"

namespace hapbench {

std::string version_text(bool as_json) {
  const Provenance program = provenance();
  if (!as_json) return fmt::format("hapbench {} ({})", program.version, program.commit);
  Json json = {
      {"version", program.version},
      {"commit", program.commit},
      {"compiler", program.compiler},
      {"build_type", program.build_type},
      {"flags", program.flags},
      {"instruction_set", {{"march", program.march}, {"widest", program.widest}, {"simd", program.simd}}},
      {"promise",
       "Within a major version (before 1.0: a minor one) no field of scenarios, no file or column of results, no "
       "command, option or exit status goes away or changes its meaning; there may be more of them. Computed "
       "numbers may change with every version: results name the commit that made them."}};
  return json.dump(2);
}

}  // namespace hapbench
