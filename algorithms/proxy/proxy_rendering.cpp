#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <array>
#include <bit>
#include <span>

#include "algorithms/proxy/proxy_constraints.hpp"
#include "algorithms/proxy/turning_proxy.hpp"
#include "algorithms/registry.hpp"
#include "algorithms/stages/damping_and_limits.hpp"
#include "sim/core/simd.hpp"

namespace hapbench {
namespace {

/// An eigenvector of sum u u^T whose eigenvalue is at most this value counts as outside the span of the gradients u.
constexpr double kNoSpan = 1e-6;
/// A pass that moves the proxy by at most this fraction of the margin is the last pass. The linear constraints are
/// exact at the start of the move. At the end of the move, their error is the squared length of the move divided by the
/// width of the tool: at most 9 nm for a drill with a diameter of 1 mm.
constexpr double kConverged = 0.03;
/// Longest cycle of proxy positions that is recognised, in passes.
constexpr std::size_t kLongestCycle = 4;
/// Two positions of the proxy count as equal if their distance is at most this fraction of the margin.
constexpr double kEqualPositions = 1e-3;
/// Maximum number of times that next_move() shortens the move of a proxy with points inside. After these shortenings,
/// the length of the move exceeds the allowed length by at most a few per cent, unless the tool itself pulls the proxy
/// farther away from the points.
constexpr int kMaxShortenings = 3;

constexpr AlgorithmParameter kOwnParameters[] = {
    {"damping_time_s",
     {0.0, 10.0, "s"},
     0.0,
     "time constant of the low-pass filter for the directions of damping and friction, which change suddenly when a "
     "contact begins or ends; 0: no filter"},
    {kRotationalStiffness,
     {0.0, 1e12, "N m/rad", true},
     std::numeric_limits<double>::infinity(),
     "rotational stiffness of the spring that aligns the proxy with the tool; null (default): infinite, so that the "
     "proxy has the tool's orientation"}};

/// Calls `use(i)` for each contact i that holds the proxy back (its weight is positive), in ascending i. Tests eight
/// contacts at a time, because only about three of some hundred contacts near the proxy hold the proxy back.
/// Precondition: the contacts are padded.
template <class Use>
void for_each_holding(const ContactBuffer& contacts, const Use& use) {
  for (std::size_t i = 0; i < contacts.padded_size(); i += simd::lanes) {
    unsigned holding = simd::bits(simd::load(&contacts.weight[i]) > simd::Pack(0.0));
    for (; holding != 0; holding &= holding - 1) use(i + static_cast<std::size_t>(std::countr_zero(holding)));
  }
}

/// Constraint-based rendering with a proxy (Zilles and Salisbury, 1995, who describe it for a point instead of a tool).
/// The proxy is a copy of the tool that never enters the environment. The proxy follows the tool, and a spring pulls
/// the tool to the proxy. The proxy always has the orientation of the tool, so only the translation x of the proxy is
/// free: three unknowns.
///
/// Each pass computes the constraints on the proxy (ProxyConstraints) and moves it to the allowed position
/// nearest to the tool (nearest_allowed). A move is at most as long as the margin, so that the proxy cannot
/// reach points beyond the margin, for which it has no constraints.
///
/// Guarantee: after a pass, no shell point is inside the proxy by more than kViolationTolerance times the margin, if
/// the contacts of this pass do not contradict each other and the pass did not scale the depths (see below). Reason:
/// the linear constraints are conservative, because the tool is convex. If no point is inside the proxy, they also hold
/// for a move that is shortened to the margin. If contacts contradict each other, for example in a slot narrower than
/// the tool, the proxy takes the least-squares compromise, and each wall that the proxy enters counts as one more
/// spring of stiffness K.
///
/// Points may be inside the proxy if the proxy was placed on them, or if walls leave no room for it. Moving the proxy
/// out in one step would throw the tool out. The depths are therefore scaled so that the deepest point leaves at
/// kProxyRecoverySpeed. A proxy without points inside keeps the guarantee, however fast the tool rotates. With a
/// SpringSet there are no points, and depths are not scaled.
///
/// With multi-rate contacts (ContactSchedule), the proxy follows the tool and searches points only in steps in
/// which a query returns, for the tool's pose in the query. If MultiRateSchedule::linear is false, the spring force
/// stays constant until the next query returns. If it is true, each constraint of the last pass becomes a plane that is
/// fixed in space. The material point of the proxy at the contact must not cross the plane; this material point rotates
/// with the tool. In every step the proxy moves to the allowed position nearest to the tool, without passes. Points
/// beyond the margin are not found before the next query.
///
/// f_spring = K (x - p) with the tool's position p. S is the projector onto the span of the gradients that hold the
/// proxy back. With angular damping, v_n is S v plus the shortest velocity in this span whose components along the u_i
/// are the rotating tool's components <omega x r_i, u_i>. Normal damping and friction may follow S with a time constant
/// (`damping_time_s`), because S, and with it -B S v, changes abruptly when points come into contact or leave. A mean
/// of projectors lies between 0 and I, so damping and friction stay passive. The rendered contacts are the contacts
/// that hold the proxy back, with depth lambda_i [m] and weight 1: f_spring = -K sum lambda_i u_i.
class ProxyRendering final : public ForceAlgorithm {
 public:
  explicit ProxyRendering(const RenderingConfig& config)
      : K_(config.stiffness),
        damping_time_(parameter_value(config, "proxy", kOwnParameters[0])),
        damping_and_limits_(config),
        skips_(config.skips) {}

  void prepare(const Scene& scene) override {
    dt_ = scene.dt;
    row_ = scene.row;
    if (scene.springs != nullptr) {
      constraints_ = std::make_unique<SpringConstraints>(*scene.springs);
      recovery_ = std::numeric_limits<double>::infinity();
    } else {
      constraints_ = std::make_unique<ShellConstraints>(*scene.shell, *scene.tool, skips_);
      recovery_ = kProxyRecoverySpeed * scene.tool->half_width() * scene.dt;
    }
    near_contacts_ = std::make_unique<ContactBuffer>(constraints_->capacity());
    schedule_ = scene.schedule;
    if (schedule_ != nullptr && schedule_->timing.linear) constraint_depth_ = near_contacts_->depth;
    damping_and_limits_.prepare(scene);
  }

  void reset() noexcept override {
    constraints_->reset();
    damping_and_limits_.release();
    has_proxy_ = false;
    last_query_row_.reset();
    damping_S_row_.setZero();
    last_row_.reset();
    work_ = {};
  }

  void compute(const ToolState& tool, ContactBuffer& contacts, RenderedForce& out) noexcept override {
    out = {};
    out.depth_max = contacts.largest_depth();
    if (schedule_ == nullptr)
      update_proxy(tool.pose, contacts.empty());
    else
      update_with_schedule(tool.pose, contacts.empty());
    copy_holding_contacts(contacts);
    out.spring = spring_;
    out.S = allowed_.held;
    filter_directions();
    // Without contact, S = 0 would make the whole velocity tangential, so no friction is applied.
    if (contacts.empty()) {
      out.rendered = spring_;
      damping_and_limits_.release();
      return;
    }
    Mat3 loads;  // initialised only if needs_loads()
    if (damping_and_limits_.needs_loads()) loads = load_along(spring_);
    out.rendered = damping_and_limits_.rendered_force(spring_, damping_S_, velocity_at(tool), loads);
    out.friction = damping_and_limits_.friction_state();
  }

  /// Returns an energy and a moment. The energy is stored in the spring between tool and proxy, in friction and in
  /// violated contacts. The moment about the proxy's tip centre is the moment of the forces K lambda_i with which the
  /// points that hold the proxy back push the proxy.
  SpringState spring_state(const ToolState&, const ContactBuffer&) const noexcept override {
    if (K_ == 0.0) return {};
    SpringState state{spring_.squaredNorm() / (2.0 * K_) + damping_and_limits_.stored_energy(), Vec3::Zero()};
    for_each_holding(*near_contacts_, [&](std::size_t i) {
      const double weight = near_contacts_->weight[i];
      // In the compromise, violated contacts store energy as well.
      if (!allowed_.feasible) state.energy += 0.5 * K_ * weight * weight;
      if (!constraints_->act_at_points()) return;
      // The stored energy depends on the scaled depth, so the moment of the point is scaled, too.
      const double scale = near_contacts_->depth[i] > 0.0 ? depth_scale_ : 1.0;
      state.moment -=
          (near_contacts_->point(i) - proxy_).cross(scale * K_ * multiplier(i) * near_contacts_->gradient(i));
    });
    return state;
  }

  ForceJacobian jacobian() const noexcept override {
    if (allowed_.held.isZero(0.0)) return {};
    return {K_ * allowed_.held, damping_and_limits_.damping_matrix(spring_, damping_S_)};
  }

  std::optional<double> angular_velocity_cutoff() const noexcept override {
    return damping_and_limits_.angular_velocity_cutoff();
  }
  AlgorithmWork work() const noexcept override {
    AlgorithmWork work = work_;
    work.search = constraints_->work();
    return work;
  }

 private:
  /// Moves the proxy towards the tool at the pose `tool` and updates the spring force. `free`: true if the tool touches
  /// no point.
  void update_proxy(const ToolPose& tool, bool free) noexcept {
    if (!has_proxy_) set_proxy(tool.position);
    // If the tool is in free air and too far away for the proxy to follow, place the proxy at the tool.
    if (!follow(tool) && free) set_proxy(tool.position);
    spring_ = K_ * (proxy_ - tool.position);
  }

  /// Does the work of update_proxy() for multi-rate contacts.
  void update_with_schedule(const ToolPose& tool, bool free) noexcept {
    const ContactSchedule::Query* query = schedule_->used();
    if (query == nullptr) {
      set_proxy(tool.position);
      spring_.setZero();
      return;
    }
    const bool linear = schedule_->timing.linear;
    if (last_query_row_ != query->row) {
      last_query_row_ = query->row;
      update_proxy(query->pose, free);
      if (linear) constraint_depth_ = near_contacts_->depth;
    }
    if (!linear) return;
    move_planes(query->pose, tool);
    allowed_ = nearest_allowed(tool.position - constraint_position_, *near_contacts_);
    work_.iterations += static_cast<std::uint64_t>(allowed_.iterations);
    proxy_ = allowed_.iterations == 0 ? tool.position : Vec3(constraint_position_ + allowed_.move);
    spring_ = K_ * (proxy_ - tool.position);
  }

  /// Adapts the depths of the constraints to the rotation of the tool since the query: the rotation about
  /// constraint_position_ displaces the proxy's material at each contact. The gradients stay fixed.
  void move_planes(const ToolPose& from, const ToolPose& to) noexcept {
    const Mat3 turned = turn_matrix(from, to) - Mat3::Identity();
    ContactBuffer& planes = *near_contacts_;
    for (std::size_t i = 0; i < planes.size(); ++i)
      planes.depth[i] =
          constraint_depth_[i] + planes.gradient(i).dot(turned * (planes.point(i) - constraint_position_));
  }

  /// Low-pass filters S for damping and friction. If an integrator evaluates several states within a step, the filter
  /// starts each evaluation from the filtered S of the previous step. In the first step with contact, the filtered S
  /// equals S.
  void filter_directions() noexcept {
    damping_S_ = allowed_.held;
    if (damping_time_ == 0.0) return;
    const bool first_of_row = row_ == nullptr || last_row_ != *row_;
    if (first_of_row) {
      previous_S_ = damping_S_row_;
      if (row_ != nullptr) last_row_ = *row_;
    }
    if (!allowed_.held.isZero(0.0) && !previous_S_.isZero(0.0))
      damping_S_ = previous_S_ + dt_ / (damping_time_ + dt_) * (allowed_.held - previous_S_);
    if (first_of_row) damping_S_row_ = damping_S_;
  }

  /// Returns the velocity of the tool at the contacts that hold the proxy.
  ContactVelocity velocity_at(const ToolState& tool) const noexcept {
    ContactVelocity velocity{tool.velocity, damping_S_ * tool.velocity};
    if (!angular_velocity_cutoff() || !constraints_->act_at_points() || tool.angular_velocity == Vec3::Zero()) {
      return velocity;
    }
    Mat3 span = Mat3::Zero();
    Vec3 turning = Vec3::Zero();
    for_each_holding(*near_contacts_, [&](std::size_t i) {
      const Vec3 u = near_contacts_->gradient(i);
      span += u * u.transpose();
      turning += tool.angular_velocity.cross(near_contacts_->point(i) - proxy_).dot(u) * u;
    });
    const Eigen::SelfAdjointEigenSolver<Mat3> axes(span);
    for (int k = 0; k < 3; ++k) {
      const double length = axes.eigenvalues()[k];
      if (length <= kNoSpan) continue;
      const Vec3 axis = axes.eigenvectors().col(k);
      velocity.normal += axis.dot(turning) / length * axis;
    }
    velocity.mean += tool.angular_velocity.cross(mean_arm(*near_contacts_, proxy_));
    return velocity;
  }

  /// Places the proxy at a position and discards its constraints.
  void set_proxy(const Vec3& position) noexcept {
    has_proxy_ = true;
    proxy_ = constraint_position_ = position;
    allowed_ = {};
    clear_ = false;
    depth_scale_ = 1.0;
    near_contacts_->clear();
  }

  /// Returns the allowed move nearest to the wanted move. If points are deep inside the proxy, returns a slow move with
  /// which the points leave the proxy (kProxyRecoverySpeed).
  AllowedMove next_move(const Vec3& wanted) noexcept {
    depth_scale_ = 1.0;
    const double deepest = clear_ ? 0.0 : near_contacts_->largest_depth();
    if (!(deepest > recovery_)) return nearest_allowed(wanted, *near_contacts_);
    scale_depths(recovery_ / deepest);
    AllowedMove allowed = nearest_allowed(wanted, *near_contacts_);
    // If points of nearly opposite walls are inside the proxy, the move is much longer than the depths. It is nearly
    // proportional to the depths, so smaller depths shorten the move.
    for (int k = 0; k < kMaxShortenings && allowed.move.norm() > recovery_; ++k) {
      scale_depths(recovery_ / allowed.move.norm());
      allowed = nearest_allowed(wanted, *near_contacts_);
    }
    return allowed;
  }

  /// Multiplies all positive depths (points inside the proxy) by `factor`.
  void scale_depths(double factor) noexcept {
    depth_scale_ *= factor;
    for (double& depth : std::span(near_contacts_->depth.data(), near_contacts_->size())) {
      if (depth > 0.0) depth *= factor;
    }
  }

  /// Moves the proxy towards the tool in passes. A proxy with points inside makes only one pass. Returns false if this
  /// pass was shortened to the margin, or if kMaxProxyPasses passes were not enough.
  // NOLINTNEXTLINE(readability-function-cognitive-complexity): the passes share one state.
  bool follow(const ToolPose& tool) noexcept {
    const double margin = constraints_->margin();
    const double converged = kConverged * margin, same = kEqualPositions * margin;
    std::array<Vec3, kLongestCycle> recent;  // proxy positions after the last passes
    recent.fill(Vec3::Constant(std::numeric_limits<double>::infinity()));
    for (int pass = 0; pass < kMaxProxyPasses; ++pass) {
      const ToolPose proxy{proxy_, tool.axis, tool.roll};
      const Vec3 wanted = tool.position - proxy_;
      constraints_->constraints_at(proxy, wanted, *near_contacts_);
      const AllowedMove& allowed = allowed_ = next_move(wanted);
      work_.iterations += static_cast<std::uint64_t>(allowed.iterations);
      const double length = allowed.move.norm();
      const bool arrives = length <= margin;
      constraint_position_ = proxy_;
      proxy_ += arrives ? allowed.move : Vec3(margin / length * allowed.move);
      if (!allowed.feasible || depth_scale_ < 1.0) {
        // The proxy takes many steps to leave the points inside it, so one pass in each step is enough.
        clear_ = false;
        return arrives;
      }
      if (arrives) {
        clear_ = true;
        if (allowed.iterations == 0) proxy_ = tool.position;
        if (allowed.iterations == 0 || length <= converged) return true;
        // Patches of the surface become active and inactive as the proxy moves. Passes may therefore cycle
        // through two or four positions, all of which are allowed. Accept the position nearest to the tool when
        // it recurs.
        const double distance = (tool.position - proxy_).norm();
        bool recurs = false, nearest = true;
        for (const Vec3& position : recent) {
          recurs |= (proxy_ - position).norm() <= same;
          nearest &= distance <= (tool.position - position).norm() + same;
        }
        if (recurs && nearest) return true;
        recent[static_cast<std::size_t>(pass) % recent.size()] = proxy_;
      }
    }
    return false;
  }

  /// Returns the multiplier lambda_i [m] of a contact that holds the proxy back.
  double multiplier(std::size_t i) const noexcept {
    return near_contacts_->weight[i] + allowed_.share.dot(near_contacts_->gradient(i));
  }

  /// Replaces the colliding points by the contacts that hold the proxy back, up to the buffer's capacity. In a
  /// compromise, more points and patches than this capacity may hold the proxy; force and energy still include all of
  /// them.
  void copy_holding_contacts(ContactBuffer& contacts) const noexcept {
    contacts.clear();
    for_each_holding(*near_contacts_, [&](std::size_t i) {
      if (contacts.size() == contacts.capacity()) return;
      contacts.push_copy_of(*near_contacts_, i);
      contacts.depth[contacts.size() - 1] = multiplier(i);
      contacts.weight[contacts.size() - 1] = 1.0;
    });
    contacts.pad();
  }

  double K_;
  double damping_time_;  ///< time constant of the low-pass filter of S for damping and friction [s]
  DampingAndLimits damping_and_limits_;
  Skips skips_;
  std::unique_ptr<ProxyConstraints> constraints_;
  /// Constraints of the last pass, with multipliers or violations as weights [m].
  std::unique_ptr<ContactBuffer> near_contacts_;

  const ContactSchedule* schedule_ = nullptr;    ///< null: the proxy searches points in every step
  std::optional<std::uint64_t> last_query_row_;  ///< step of the last query whose points were searched
  /// Proxy position for which the constraints of the last pass were computed [m].
  Vec3 constraint_position_ = Vec3::Zero();
  /// Depths [m] of the constraints at constraint_position_. Used only if MultiRateSchedule::linear is true.
  AlignedDoubles constraint_depth_;

  bool has_proxy_ = false;  ///< false before the first step
  Vec3 proxy_ = Vec3::Zero();
  AllowedMove allowed_;            ///< result of the last pass
  Mat3 damping_S_ = Mat3::Zero();  ///< S for normal damping and friction
  /// Filtered S of the first evaluation in this step, and of the first evaluation in the previous step.
  Mat3 damping_S_row_ = Mat3::Zero(), previous_S_ = Mat3::Zero();
  std::optional<std::uint64_t> last_row_;
  const std::uint64_t* row_ = nullptr;  ///< null if no Simulation steps the algorithm; then each call counts as a step
  double dt_ = 0.0;
  bool clear_ = false;        ///< true if no points are inside the proxy after the last pass
  double recovery_ = 0.0;     ///< largest distance by which points leave the proxy in a step [m]
  double depth_scale_ = 1.0;  ///< factor on the depths of points inside the proxy in the last pass
  Vec3 spring_ = Vec3::Zero();
  AlgorithmWork work_;
};

/// Bound of |f_spring| / K in the first step after a reset. The proxy starts at the tool and moves by at most one
/// margin in each pass, however deep the contacts are. In later steps, the proxy may be farther away from the tool.
double proxy_bound(const RenderingConfig&, const ToolShape& tool, std::size_t, double) {
  return kMaxProxyPasses * kProxyMargin * tool.half_width();
}

}  // namespace

AlgorithmEntry proxy_entry() {
  static constexpr ModelInfo kInfo = {
      .name = "proxy",
      .summary = "a proxy of the tool never enters the environment, and a spring pulls the tool to the proxy",
      .formula =
          "x = argmin |x - p|^2 with <m_i, x - x_proxy> <= g_i for all points within the margin (g_i signed distance "
          "of the point to the tool, m_i the tool's normal there), and with the tool's foremost edge above the "
          "surface's flat patch about each point; f_spring = K (x - p), S = projector onto the span of the active "
          "gradients. With a finite rotational_stiffness k, the proxy also rotates: (x, theta) = argmin K/2 |x - p|^2 "
          "+ k/2 |Log(phi^T theta)|^2 with no point inside the proxy, where (p, phi) is the pose of the tool",
      .source =
          "not in the thesis; after Zilles and Salisbury 1995 (god-object) and Ruspini et al. 1997, which thesis 1.2 "
          "rejects",
      .known_failure =
          "after a start in deep penetration, or in a hole that is too narrow for the rotated tool, points remain "
          "inside the proxy; the proxy then moves out at 40 half widths of the tool per second; a flat face of the "
          "tool moves unevenly on a surface whose normals are wrong by more than 6 degrees; no depth model or "
          "reduction applies",
      .parameters = kStiffnessAlone,
  };
  return {.info = &kInfo,
          .make = [](const RenderingConfig& config) -> std::unique_ptr<ForceAlgorithm> {
            if (turns(config)) return make_turning_proxy(config, 0.0);
            return std::make_unique<ProxyRendering>(config);
          },
          .force_bound = proxy_bound,
          .may_reduce = false,
          .reported_depth_model = "surface_normal",
          .algorithm_parameters = kOwnParameters};
}

}  // namespace hapbench
