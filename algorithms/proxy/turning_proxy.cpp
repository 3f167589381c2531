#include "algorithms/proxy/turning_proxy.hpp"

#include <Eigen/Cholesky>
#include <limits>
#include <optional>
#include <stdexcept>

#include "algorithms/proxy/proxy_constraints.hpp"
#include "algorithms/six_dof/tool_equilibrium.hpp"
#include "algorithms/stages/damping_and_limits.hpp"

namespace hapbench {
namespace {

Eigen::Quaterniond orientation_of(const ToolPose& tool) noexcept {
  return Eigen::Quaterniond(tool.rotation()).normalized();
}

class TurningProxy final : public ForceAlgorithm {
 public:
  TurningProxy(const RenderingConfig& config, double stiffness, double force_point)
      : damping_and_limits_(config), force_point_(force_point), skips_(config.skips) {
    springs_.stiffness = config.stiffness;
    springs_.coupling_rotation = stiffness;
    springs_.hand_rotation = std::numeric_limits<double>::infinity();
    outcome_.feasible = true;
  }

  void prepare(const Scene& scene) override {
    if (scene.shell == nullptr) throw std::invalid_argument("a proxy that turns needs a surface");
    equilibrium_.emplace(*scene.shell, *scene.tool, force_point_, skips_);
    equilibrium_->set_recovery(kProxyRecoverySpeed * scene.tool->half_width() * scene.dt);
    damping_and_limits_.prepare(scene);
  }

  void reset() noexcept override {
    equilibrium_->reset();
    damping_and_limits_.release();
    has_proxy_ = false;
    S_.setZero();
    work_ = {};
  }

  void compute(const ToolState& tool, ContactBuffer& contacts, RenderedForce& out) noexcept override {
    out = {};
    out.depth_max = contacts.largest_depth();
    springs_.target = orientation_of(tool.pose);
    springs_.grip_target = tool.pose.position - force_point_ * tool.pose.axis;
    if (springs_.stiffness > 0.0) follow(contacts.empty());
    copy_holding(contacts);
    S_ = tensor();
    out.spring = springs_.stiffness * (proxy_.position - springs_.grip_target);
    out.S = S_;
    spring_ = out.spring;
    // Without contact, S = 0 would make the whole velocity tangential, so no friction is applied.
    if (contacts.empty()) {
      out.rendered = out.spring;
      damping_and_limits_.release();
      return;
    }
    Mat3 loads;  // initialised only if needs_loads()
    if (damping_and_limits_.needs_loads()) loads = load_along(out.spring);
    out.rendered = damping_and_limits_.rendered_force(out.spring, S_, {tool.velocity, Vec3(S_ * tool.velocity)}, loads);
    out.friction = damping_and_limits_.friction_state();
  }

  /// Returns an energy and a moment. The energy is stored in both springs and in friction. The moment about the proxy's
  /// tip centre is the moment of the forces with which the points that hold the proxy push the proxy.
  SpringState spring_state(const ToolState&, const ContactBuffer&) const noexcept override {
    if (springs_.stiffness == 0.0) return {};
    const Vec3 twist = spring_torque(springs_, proxy_);
    SpringState state{spring_.squaredNorm() / (2.0 * springs_.stiffness) +
                          twist.squaredNorm() / (2.0 * springs_.coupling_rotation) +
                          damping_and_limits_.stored_energy(),
                      Vec3::Zero()};
    const Vec3 tip = equilibrium_->tool_pose(proxy_.position, proxy_.orientation).position;
    for (const auto& h : equilibrium_->holding()) state.moment -= (h.point - tip).cross(h.load * h.normal);
    return state;
  }

  ForceJacobian jacobian() const noexcept override {
    if (S_.isZero(0.0)) return {};
    return {springs_.stiffness * S_, damping_and_limits_.damping_matrix(spring_, S_)};
  }
  AlgorithmWork work() const noexcept override {
    AlgorithmWork work = work_;
    work.search = equilibrium_->work();
    return work;
  }

 private:
  /// Moves the proxy for the current pose of the tool. `free`: true if the tool touches no point.
  void follow(bool free) noexcept {
    if (!has_proxy_) proxy_ = relaxed(springs_);
    has_proxy_ = true;
    proxy_.handle = springs_.target;
    outcome_ = equilibrium_->solve(springs_, proxy_, kMaxProxyPasses);
    work_.iterations += static_cast<std::uint64_t>(outcome_.passes);
    // If the tool is in free air and the proxy cannot follow it because it is too far away, move the proxy to the tool.
    if (!outcome_.solved && free) proxy_ = relaxed(springs_);
  }

  /// Replaces the colliding points by the points that hold the proxy.
  void copy_holding(ContactBuffer& contacts) const noexcept {
    contacts.clear();
    for (const auto& h : equilibrium_->holding()) {
      if (contacts.size() == contacts.capacity()) break;
      contacts.push(h.index, h.point, h.surface_normal);
      const std::size_t i = contacts.size() - 1;
      contacts.depth[i] = h.load / springs_.stiffness;
      contacts.set_gradient(i, h.normal);
      contacts.weight[i] = 1.0;
    }
    contacts.pad();
  }

  Mat3 tensor() const noexcept {
    if (!outcome_.feasible) return Mat3::Identity();
    const auto holding = equilibrium_->holding();
    const auto n = static_cast<Eigen::Index>(holding.size());
    if (n == 0) return Mat3::Zero();
    using Rows = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor, 6, 3>;
    using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6, 6>;
    Rows u(n, 3), v(n, 3);
    for (Eigen::Index i = 0; i < n; ++i) {
      u.row(i) = holding[static_cast<std::size_t>(i)].row.head<3>();
      v.row(i) = holding[static_cast<std::size_t>(i)].row.tail<3>();
    }
    const Square G = u * u.transpose() + springs_.stiffness / springs_.coupling_rotation * (v * v.transpose());
    return u.transpose() * Eigen::LDLT<Square>(G).solve(u);
  }

  DampingAndLimits damping_and_limits_;
  six_dof::PoseSprings springs_;
  double force_point_;
  Skips skips_;
  std::optional<six_dof::ToolEquilibrium> equilibrium_;
  six_dof::ToolEquilibrium::Outcome outcome_;
  bool has_proxy_ = false;
  six_dof::CoupledPose proxy_;
  Mat3 S_ = Mat3::Zero();
  Vec3 spring_ = Vec3::Zero();
  AlgorithmWork work_;
};

double rotational_stiffness(const RenderingConfig& config) {
  const auto values = config.parameters.find("proxy");
  if (values == config.parameters.end()) return std::numeric_limits<double>::infinity();
  const auto value = values->second.find(kRotationalStiffness);
  return value == values->second.end() ? std::numeric_limits<double>::infinity() : value->second;
}

}  // namespace

bool turns(const RenderingConfig& config) {
  return config.algorithm == "proxy" && rotational_stiffness(config) < std::numeric_limits<double>::infinity();
}

std::unique_ptr<ForceAlgorithm> make_turning_proxy(const RenderingConfig& config, double force_point) {
  return std::make_unique<TurningProxy>(config, rotational_stiffness(config), force_point);
}

}  // namespace hapbench
