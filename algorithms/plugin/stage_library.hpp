#pragma once

#include <cstdio>
#include <exception>

#include "algorithms/plugin/hapbench_force_stage.h"

/// Force stages in C++ behind the C interface.
namespace hapbench {

/// The functions of a force stage that is a class with
///
///   Stage(const char* config, const HapbenchStageRun& run);
///   void reset();
///   void force(const HapbenchStageStep& step, double force[3]);
///
/// all of which but `reset` may throw.
template <class Stage>
HapbenchForceStage stage_library(const char* name) {
  static constexpr auto guarded = [](char* fault, std::size_t fault_size, const auto& call) {
    try {
      return call(), true;
    } catch (const std::exception& error) {
      std::snprintf(fault, fault_size, "%s", error.what());
    } catch (...) {
      std::snprintf(fault, fault_size, "unknown error");
    }
    return false;
  };
  HapbenchForceStage library = {};
  library.version = HAPBENCH_FORCE_STAGE_VERSION;
  library.name = name;
  library.create = [](const char* config, const HapbenchStageRun* run, char* fault, std::size_t fault_size) -> void* {
    Stage* stage = nullptr;
    guarded(fault, fault_size, [&] { stage = new Stage(config, *run); });
    return stage;
  };
  library.destroy = [](void* stage) { delete static_cast<Stage*>(stage); };
  library.reset = [](void* stage) { static_cast<Stage*>(stage)->reset(); };
  library.force = [](void* stage, const HapbenchStageStep* step, double force[3], char* fault, std::size_t fault_size) {
    return guarded(fault, fault_size, [&] { static_cast<Stage*>(stage)->force(*step, force); }) ? 0 : 1;
  };
  return library;
}

}  // namespace hapbench
