#pragma once

#include <optional>

namespace hapbench {

/// Parameters for converting a mesh file to a point shell.
struct MeshSampling {
  double scale = 1.0;  ///< length of the file's unit [m]
  std::optional<double>
      spacing;        ///< largest distance between neighbouring points [m]; empty: the points are the mesh's vertices
  bool flip = false;  ///< true: all normals are reversed; allowed for an open surface only
};

}  // namespace hapbench
