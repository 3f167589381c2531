#pragma once

#include <cstdint>

#include "algorithms/rendering_config.hpp"
#include "sim/contact/contact_buffer.hpp"
#include "sim/core/types.hpp"
#include "sim/loop/force_algorithm.hpp"

namespace hapbench {

/// The parameter that all laws share, and the parameter block of laws that have no other.
inline constexpr ParameterInfo kStiffnessParameter = {parameter::kStiffness, "K of one penalty spring"};
inline constexpr ParameterInfo kStiffnessAlone[] = {kStiffnessParameter};

/// The answer of a force law.
struct LawForce {
  Vec3 spring = Vec3::Zero();  ///< f_spring on the tool [N]
  Mat3 S = Mat3::Zero();       ///< stiffness tensor in units of K
};

/// A force law: merges the penalty springs of all contacts into one force (thesis C.4). Most are f_spring = -K sum c_i
/// d_i u_i and S = sum c_i u_i u_i^T and differ in the weights c_i only (see gives_weights). An object is the state of
/// one run. One virtual call per step.
class ForceLaw {
 public:
  explicit ForceLaw(double stiffness) : K_(stiffness) {}
  explicit ForceLaw(const RenderingConfig& config) : K_(config.stiffness) {}
  virtual ~ForceLaw() = default;
  /// Before the first step; may allocate for up to `capacity` contacts.
  virtual void prepare(std::size_t capacity) { static_cast<void>(capacity); }
  virtual void reset() noexcept { iterations_ = 0; }
  /// Returns force and stiffness, zero for no contacts, and leaves the weights in the buffer. Precondition: the
  /// contacts are padded.
  virtual LawForce evaluate(ContactBuffer& contacts) noexcept = 0;
  /// Elastic energy of the springs behind the last `evaluate` and their moment about the tip centre `tip`. The
  /// arguments are the contacts and the spring force [N] of that call. By default the springs are weighted: 1/2 K sum
  /// c_i d_i^2, each force at its colliding point.
  virtual SpringState spring_state(const ContactBuffer& contacts, const Vec3& spring, const Vec3& tip) const noexcept;
  /// The part that a turning tool adds to the normal velocity S v [m/s] of the last `evaluate`, whose contacts and S
  /// are the arguments. By default that of weighted springs: sum c_i <omega x r_i, u_i> u_i, with r_i from the tip
  /// centre to the colliding point. O(n).
  virtual Vec3 turning_velocity(const ContactBuffer& contacts, const Mat3& S, const ToolState& tool) const noexcept;
  /// False for laws that are not weighted springs, whose contacts have no loads of their own.
  virtual bool gives_weights() const noexcept { return true; }
  /// Describes the fault of external code since the last reset, or null. After a fault the force is NaN.
  virtual const char* fault() const noexcept { return nullptr; }
  /// Inner iterations since the last reset.
  std::uint64_t iterations() const noexcept { return iterations_; }

 protected:
  double K_;  ///< of one penalty spring [N/m]
  std::uint64_t iterations_ = 0;
};

/// A law that defines force and S but no springs. As its springs counts one of stiffness K along the force, which acts
/// at the weighted mean of the contacts.
class SingleSpringLaw : public ForceLaw {
 public:
  using ForceLaw::ForceLaw;

  SpringState spring_state(const ContactBuffer& contacts, const Vec3& spring, const Vec3& tip) const noexcept override;
  Vec3 turning_velocity(const ContactBuffer& contacts, const Mat3& S, const ToolState& tool) const noexcept override;
  bool gives_weights() const noexcept override { return gives_weights_; }

 protected:
  bool gives_weights_ = false;  ///< the last `evaluate` gave weighted springs after all, for laws that may do either
};

/// Gives every contact the weight c and keeps the padding at zero. O(n).
void set_weights(ContactBuffer& contacts, double c) noexcept;

/// Sum of the gradients u_i. O(n).
Vec3 gradient_sum(const ContactBuffer& contacts) noexcept;

/// Mean of the vectors from the tip centre `tip` to the colliding points [m], weighted by the weights in the buffer;
/// zero if their sum is. O(n).
Vec3 mean_arm(const ContactBuffer& contacts, const Vec3& tip) noexcept;

/// f_spring and S of the weights in the buffer. O(n).
LawForce weighted_force(const ContactBuffer& contacts, double K) noexcept;

}  // namespace hapbench
