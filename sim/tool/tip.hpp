#pragma once

namespace hapbench {

/// How a solid of revolution ends: in a plane, or in half a ball of the same radius about the tip centre, beyond that
/// plane.
enum class Tip { flat, round };

}  // namespace hapbench
