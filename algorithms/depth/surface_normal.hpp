#pragma once

#include <memory>

#include "algorithms/depth/depth_model.hpp"
#include "sim/core/model_info.hpp"

namespace hapbench {

extern const ModelInfo kSurfaceNormalInfo;

std::unique_ptr<DepthModel> make_surface_normal();

}  // namespace hapbench
