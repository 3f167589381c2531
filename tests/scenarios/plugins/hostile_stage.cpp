// A force stage in C++ as it should not be: its config says how.
#include <algorithms/plugin/stage_library.hpp>
#include <cmath>
#include <stdexcept>
#include <string>

namespace {

class HostileStage {
 public:
  HostileStage(const char* config, const HapbenchStageRun&) : config_(config) {
    if (is("unmade")) throw std::runtime_error("the oven\nis cold");
  }
  void reset() {}
  void force(const HapbenchStageStep& step, double force[3]) const {
    if (is("forgets")) return;
    for (int k = 0; k < 3; ++k) force[k] = is("nan") ? std::nan("") : step.force[k];
    if (is("beyond")) force[is("before") ? -1 : 3] = 1.0;
    if (is("throws") && step.row == 5) throw std::runtime_error("row 5");
    if (is("odd") && step.row == 5) throw 5;
  }

 private:
  bool is(const char* word) const { return config_.find(word) != std::string::npos; }
  std::string config_;
};

}  // namespace

const HapbenchForceStage* hapbench_force_stage(std::uint32_t version) {
  static const HapbenchForceStage stage = hapbench::stage_library<HostileStage>("hostile_stage");
  return version == HAPBENCH_FORCE_STAGE_VERSION ? &stage : nullptr;
}
