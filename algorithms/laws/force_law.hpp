#pragma once

#include <cstdint>

#include "algorithms/rendering_config.hpp"
#include "sim/contact/contact_buffer.hpp"
#include "sim/core/types.hpp"
#include "sim/loop/force_algorithm.hpp"

namespace hapbench {

/// Documentation of the parameter that all laws share, and the parameter list of laws with no other parameter.
inline constexpr ParameterInfo kStiffnessParameter = {parameter::kStiffness, "K of one penalty spring"};
inline constexpr ParameterInfo kStiffnessAlone[] = {kStiffnessParameter};

/// The result of a force law.
struct LawForce {
  Vec3 spring = Vec3::Zero();  ///< f_spring on the tool [N]
  Mat3 S = Mat3::Zero();       ///< stiffness tensor in units of K
};

/// A force law: combines the penalty springs of all contacts to one force (thesis C.4). Most laws compute f_spring = -K
/// sum c_i d_i u_i and S = sum c_i u_i u_i^T, with depths d_i and gradients u_i, and differ only in the weights c_i
/// (see gives_weights). One instance holds the state of one run. A law costs one virtual call in each step.
class ForceLaw {
 public:
  explicit ForceLaw(double stiffness) : K_(stiffness) {}
  explicit ForceLaw(const RenderingConfig& config) : K_(config.stiffness) {}
  virtual ~ForceLaw() = default;
  /// Called before the first step; may allocate for up to `capacity` contacts.
  virtual void prepare(std::size_t capacity) { static_cast<void>(capacity); }
  virtual void reset() noexcept { iterations_ = 0; }
  /// Returns force and stiffness tensor, both zero without contacts. Writes the weights into the buffer. Precondition:
  /// the contacts are padded.
  virtual LawForce evaluate(ContactBuffer& contacts) noexcept = 0;
  /// Returns the elastic energy of the springs of the last `evaluate` and their moment about the tip centre
  /// `tip` [m]. The arguments are the contacts and the spring force [N] of that call. Default for weighted
  /// springs: energy 1/2 K sum c_i d_i^2, and each spring force acts at its colliding point.
  virtual SpringState spring_state(const ContactBuffer& contacts, const Vec3& spring, const Vec3& tip) const noexcept;
  /// Returns the part of the normal velocity [m/s] that the tool's angular velocity omega contributes. The tool's
  /// translational velocity v contributes S v. The arguments are the contacts and S of the last `evaluate`, and the
  /// tool in that step. Default for weighted springs: sum c_i <omega x r_i, u_i> u_i, with r_i from the tip centre to
  /// the colliding point. O(n).
  virtual Vec3 turning_velocity(const ContactBuffer& contacts, const Mat3& S, const ToolState& tool) const noexcept;
  /// Returns false for laws that are not weighted springs. Their contacts have no individual loads.
  virtual bool gives_weights() const noexcept { return true; }
  /// Returns the text of the fault of external code since the last reset; null without a fault. After a fault the force
  /// is NaN.
  virtual const char* fault() const noexcept { return nullptr; }
  /// Returns the number of solver iterations since the last reset.
  std::uint64_t iterations() const noexcept { return iterations_; }

 protected:
  double K_;  ///< stiffness of one penalty spring [N/m]
  std::uint64_t iterations_ = 0;
};

/// A law that defines force and S but no individual springs. Energy and moment are computed as for one spring of
/// stiffness K that pushes along the force at the weighted mean position of the contacts.
class SingleSpringLaw : public ForceLaw {
 public:
  using ForceLaw::ForceLaw;

  SpringState spring_state(const ContactBuffer& contacts, const Vec3& spring, const Vec3& tip) const noexcept override;
  Vec3 turning_velocity(const ContactBuffer& contacts, const Mat3& S, const ToolState& tool) const noexcept override;
  bool gives_weights() const noexcept override { return gives_weights_; }

 protected:
  /// True if the last `evaluate` wrote weights that define the force. May change from step to step.
  bool gives_weights_ = false;
};

/// Sets the weight of every contact to c; the padding stays zero. O(n).
void set_weights(ContactBuffer& contacts, double c) noexcept;

/// Returns the sum of the gradients u_i. O(n).
Vec3 gradient_sum(const ContactBuffer& contacts) noexcept;

/// Returns the mean of the vectors from the tip centre `tip` to the colliding points [m], weighted by the weights in
/// the buffer; zero if the weights sum to zero. O(n).
Vec3 mean_arm(const ContactBuffer& contacts, const Vec3& tip) noexcept;

/// Returns f_spring = -K sum c_i d_i u_i and S = sum c_i u_i u_i^T for the weights in the buffer. O(n).
LawForce weighted_force(const ContactBuffer& contacts, double K) noexcept;

}  // namespace hapbench
