#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "sim/core/types.hpp"

namespace hapbench {

/// Two triangles with a common edge.
struct Hinge {
  std::array<std::uint32_t, 2> triangles;
  std::array<std::uint32_t, 2> corners;  ///< of each: the one where the edge starts
  bool opposed;                          ///< they run along the edge in opposite directions, as neighbours should
};

/// The connected parts of a surface and which of its triangles to turn so that each part is wound consistently.
class MeshParts {
 public:
  /// Turns triangles until neighbours agree, each part's first triangle kept. O(triangles).
  MeshParts(std::size_t triangles, const std::vector<Hinge>& hinges);

  /// A place where neighbours do not agree whatever is turned: the surface has one side only.
  std::optional<Hinge> contradiction() const;

  /// Turns the parts of which most triangles were turned, so that most keep their winding; how many do not.
  std::size_t follow_majority();

  /// Turns closed parts that enclose a negative volume, with the parts in the bounding box of one of the thousand
  /// largest; how many were.
  std::size_t turn_outwards(const std::vector<Vec3>& vertices,
                            const std::vector<std::array<std::uint32_t, 3>>& triangles);

  /// True for each triangle whose winding must be reversed.
  const std::vector<bool>& turned() const { return turned_; }

 private:
  std::size_t count() const { return closed_.size(); }
  void turn(const std::vector<bool>& parts);

  const std::vector<Hinge>& hinges_;
  std::vector<std::uint32_t> part_;  ///< of each triangle
  std::vector<bool> turned_;
  std::vector<bool> closed_;  ///< of each part: every edge has two triangles
};

}  // namespace hapbench
