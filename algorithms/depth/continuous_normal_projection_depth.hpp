#pragma once

#include <memory>

#include "algorithms/depth/depth_model.hpp"
#include "sim/core/model_info.hpp"

namespace hapbench {

extern const ModelInfo kContinuousNormalProjectionDepthInfo;

/// Normal projection without the jump (thesis F.1, Fig. F.4): a depth between the shortest distance d_sd to the tool's
/// surface and the exit distance d_np along the gradient, which each point remembers from step to step:
///
///   d = d_sd                                  when the point enters the tool, or the run starts
///   d <- min(d_np, max(d_sd, d + <dx, u>))    while it stays
///
/// where dx = dp + turn x (x - p) is how far the tool's material at the point has moved in the step.
///
///  - No depth grows by more in a step than |dx|, at entry neither: d_sd is the distance from the surface of a point
///    that, seen from the tool, has moved by dx. A tool at rest creeps nowhere.
///  - Moving the tool along u changes d_np by as much: a point that the tool has pressed along u from the first touch
///    on has d = d_np, beyond the median line too, where d_sd saturates.
///  - What d gains from <dx, u> is work done against the force -K d u. Energy out of nothing comes from d_sd alone, as
///    in depth model surface_normal, never from the projection. Some is lost where a point leaves sideways.
///
/// A depth that is a function of the pose cannot do the same: continuous entry wants 0 on all of the tool's surface, no
/// saturation wants the whole diameter there for a point that has been pressed across the tool. Hence the memory, 16
/// bytes for each point of the shell. Only to subtract what a point had at once when it entered would take the support
/// from a tool that slides over a flat, where points keep entering from the side. O(n) a step.
std::unique_ptr<DepthModel> make_continuous_normal_projection_depth();

}  // namespace hapbench
