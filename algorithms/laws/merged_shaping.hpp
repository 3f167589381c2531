#pragma once

#include "algorithms/laws/laws.hpp"

namespace hapbench {

/// Edge of the grid on each face of the cube of directions: cells of about 6 degrees, as near as the reduction calls
/// similar, 1350 in all. Odd, so that the axes lie in the middle of cells.
inline constexpr int kDirectionCells = 15;

/// Exact shaping of groups of contacts: a reduction that neither drops a contact nor depends on their order.
///
/// Contacts whose gradients lie in the same of 1350 fixed cells of the sphere of directions (gradients away from a
/// cube's faces, kDirectionCells x kDirectionCells on each) form a group k and share a weight c_k. A group acts as what
/// it is made of, its tensor T_k = sum u u^T and its depth vector g_k = sum d u, both exactly:
///
///   S = sum c_k T_k,  f = -K sum c_k g_k,  c = argmin 1/2 |S - I|^2_F + (epsilon/2) |C|^2,  C_k = c_k tr T_k >= 0
///
/// the projection of the identity onto the cone of the groups' tensors. The mean stiffness ratio over a group with
/// weight is 1, lambda_max(S) <= (1 + sqrt 3)/2 as for exact_shaping (the proof needs tensors of trace 1, not of rank
/// 1), and with one contact a group it is exact_shaping. A flat or gradually curved surface keeps all of its contacts,
/// a group that a cell's border cuts in two is two groups that share the weight. O(n) once, then O(groups) a Newton
/// step.
std::unique_ptr<ForceLaw> make_merged_shaping(const RenderingConfig& config);

}  // namespace hapbench
