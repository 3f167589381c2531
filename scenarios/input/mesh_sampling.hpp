#pragma once

#include <optional>

namespace hapbench {

/// How a mesh becomes a point shell.
struct MeshSampling {
  double scale = 1.0;             ///< [m] for each unit of the file
  std::optional<double> spacing;  ///< [m]; none: take the mesh's own vertices
  bool flip = false;              ///< turn all normals of an open surface round; a closed one is refused
};

}  // namespace hapbench
