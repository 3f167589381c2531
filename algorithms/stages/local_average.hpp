#pragma once

#include <memory>

#include "sim/core/model_info.hpp"
#include "algorithms/stages/point_stage.hpp"

namespace hapbench {

extern const ModelInfo kLocalAverageInfo;

/// Needs a shell with grid cells (PointShell::cell_size > 0).
std::unique_ptr<PointStage> make_local_average();

}  // namespace hapbench
