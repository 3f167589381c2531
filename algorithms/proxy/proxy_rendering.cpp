#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <array>
#include <bit>
#include <span>

#include "algorithms/proxy/proxy_constraints.hpp"
#include "algorithms/registry.hpp"
#include "algorithms/stages/damping_and_limits.hpp"
#include "sim/core/simd.hpp"

namespace hapbench {
namespace {

/// Eigenvalue of sum u u^T below which the gradients do not span its eigenvector.
constexpr double kNoSpan = 1e-6;
/// A pass that moves the proxy by less than this share of the margin is the last one. Its constraints were exact at its
/// start, so the error at its end is its length squared over the width of the tool: 9 nm for a drill of 1 mm.
constexpr double kSettled = 0.03;
/// Longest cycle of places, in passes, that is recognised.
constexpr std::size_t kLongestCycle = 4;
/// Places nearer to each other than this share of the margin are the same.
constexpr double kSame = 1e-3;
/// Most times that a move of a proxy with points inside is shortened. Its length is then right to a few per cent,
/// unless the tool itself draws the proxy away.
constexpr int kSlowed = 3;

constexpr OwnParameter kDampingTime[] = {
    {"damping_time_s",
     {0.0, 10.0, "s"},
     0.0,
     "time constant with which the directions used by damping and friction follow the contacts"}};

/// Calls `use(i)` for each contact that holds the proxy back, in order. Tests eight at a time, because only about three
/// of some hundred contacts near the proxy hold it. Precondition: padded.
template <class Use>
void for_each_holding(const ContactBuffer& contacts, const Use& use) {
  for (std::size_t i = 0; i < contacts.padded_size(); i += simd::lanes) {
    unsigned holding = simd::bits(simd::load(&contacts.weight[i]) > simd::Pack(0.0));
    for (; holding != 0; holding &= holding - 1) use(i + static_cast<std::size_t>(std::countr_zero(holding)));
  }
}

/// Most passes of a step; most steps take two. Passes bring the proxy near and make the constraints exact where it
/// ends.
constexpr int kProxyPasses = 64;
/// Speed at which a proxy leaves points that are inside it, in half widths of the tool per second. For a drill of 1 mm
/// that is 0.02 m/s, the highest speed at which the simulated subjects lead it.
constexpr double kRecoverySpeed = 40.0;

/// Constraint-based rendering for a tool that cannot be turned back: a proxy of the tool that has its orientation and
/// never enters the environment follows it, and a spring pulls the tool to the proxy (Zilles and Salisbury, 1995, for a
/// point). Orientation is scripted, so only the translation x of the proxy is free: three unknowns.
///
/// Each pass computes the constraints on the proxy (ProxyConstraints) and moves it to the allowed place nearest to the
/// tool (nearest_allowed), at most by the margin, so that it cannot reach points further away.
///
/// Guarantee: after a pass whose contacts do not contradict each other, and which was not shortened because points were
/// inside the proxy, no shell point is inside the proxy by more than kViolationTolerance of the margin, because the
/// constraints are conservative (the tool is convex), and those of a proxy without penetration still hold for a part of
/// the move. If they contradict (a slot narrower than the tool), the proxy takes the least-squares compromise, and each
/// wall that it enters counts as one more spring of stiffness K.
///
/// A proxy may have points inside if it was placed on them or if walls leave no room. Moving it out at once would throw
/// the tool out, so the depths are scaled until the deepest point leaves at kRecoverySpeed. A proxy without points
/// inside keeps the guarantee, however fast the tool turns. Planes of springs have no inside.
///
/// With late contacts (ContactSchedule) the proxy follows the tool and looks for points in the rows of answers only, as
/// of the tool's pose in the query. Held, its spring stays as it was then. Linear, the constraints of its last pass are
/// planes in space that turn with the tool's material, and it goes to the allowed place nearest to the tool in every
/// row, without passes: points beyond the margin are not seen before the next query.
///
/// f_spring = K (x - p). S is the projector onto the span of the gradients that hold the proxy back. With angular
/// damping v_n is S v plus the shortest velocity in that span whose components along the u_i are those of the turning
/// tool, <omega x r_i, u_i>. Normal damping and friction may follow S with a time constant (`damping_time_s`), because
/// S, and with it -B S v, steps as points come and go; a mean of projectors lies between 0 and I, so both stay passive.
/// The rendered contacts are those that hold the proxy, with depth lambda_i [m] and weight 1: f_spring = -K sum
/// lambda_i u_i.
class ProxyRendering final : public ForceAlgorithm {
 public:
  explicit ProxyRendering(const RenderingConfig& config)
      : K_(config.stiffness),
        damping_time_(own_value(config, "proxy", kDampingTime[0])),
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
      recovery_ = kRecoverySpeed * scene.tool->half_width() * scene.dt;
    }
    near_contacts_ = std::make_unique<ContactBuffer>(constraints_->capacity());
    schedule_ = scene.schedule;
    if (schedule_ != nullptr && schedule_->lateness.linear) base_depth_ = near_contacts_->depth;
    damping_and_limits_.prepare(scene);
  }

  void reset() noexcept override {
    constraints_->reset();
    damping_and_limits_.release();
    placed_ = false;
    found_.reset();
    damped_row_.setZero();
    last_row_.reset();
    work_ = {};
  }

  void compute(const ToolState& tool, ContactBuffer& contacts, RenderedForce& out) noexcept override {
    out = {};
    out.depth_max = contacts.largest_depth();
    if (schedule_ == nullptr)
      find(tool.pose, contacts.empty());
    else
      find_late(tool.pose, contacts.empty());
    hand_over_holding(contacts);
    out.spring = spring_;
    out.S = allowed_.held;
    follow_directions();
    // Without contact, S = 0 would make the whole velocity tangential, so friction must not be applied.
    if (contacts.empty()) {
      out.rendered = spring_;
      damping_and_limits_.release();
      return;
    }
    Mat3 loads;  // not set where nothing reads it
    if (damping_and_limits_.needs_loads()) loads = load_along(spring_);
    out.rendered = damping_and_limits_.rendered_force(spring_, damped_, velocity_at(tool), loads);
    out.friction = damping_and_limits_.friction_state();
  }

  /// One spring from tool to proxy. Each holding point pushes with its share on the proxy; moments are about the
  /// proxy's tip centre.
  SpringState spring_state(const ToolState&, const ContactBuffer&) const noexcept override {
    if (K_ == 0.0) return {};
    SpringState state{spring_.squaredNorm() / (2.0 * K_) + damping_and_limits_.stored_energy(), Vec3::Zero()};
    for_each_holding(*near_contacts_, [&](std::size_t i) {
      const double weight = near_contacts_->weight[i];
      // In the compromise, the violations also store energy.
      if (!allowed_.feasible) state.energy += 0.5 * K_ * weight * weight;
      if (!constraints_->act_at_points()) return;
      // The stored energy depends on the scaled depth, so the moment of the point is scaled as well.
      const double scale = near_contacts_->depth[i] > 0.0 ? slowed_ : 1.0;
      state.moment -=
          (near_contacts_->point(i) - proxy_).cross(scale * K_ * multiplier(i) * near_contacts_->gradient(i));
    });
    return state;
  }

  ForceJacobian jacobian() const noexcept override {
    if (allowed_.held.isZero(0.0)) return {};
    return {K_ * allowed_.held, damping_and_limits_.damping_matrix(spring_, damped_)};
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
  void find(const ToolPose& tool, bool free) noexcept {
    if (!placed_) place(tool.position);
    // A tool in free air that is too far away for the proxy to follow has been placed there.
    if (!follow(tool) && free) place(tool.position);
    spring_ = K_ * (proxy_ - tool.position);
  }

  void find_late(const ToolPose& tool, bool free) noexcept {
    const ContactSchedule::Query* query = schedule_->used();
    if (query == nullptr) {
      place(tool.position);
      spring_.setZero();
      return;
    }
    const bool linear = schedule_->lateness.linear;
    if (found_ != query->row) {
      found_ = query->row;
      find(query->pose, free);
      if (linear) base_depth_ = near_contacts_->depth;
    }
    if (!linear) return;
    move_planes(query->pose, tool);
    allowed_ = nearest_allowed(tool.position - base_, *near_contacts_);
    work_.iterations += static_cast<std::uint64_t>(allowed_.iterations);
    proxy_ = allowed_.iterations == 0 ? tool.position : Vec3(base_ + allowed_.move);
    spring_ = K_ * (proxy_ - tool.position);
  }

  /// Turns the constraints about the place that they are of, as the tool has turned since.
  void move_planes(const ToolPose& from, const ToolPose& to) noexcept {
    const Mat3 turned = turn_matrix(from, to) - Mat3::Identity();
    ContactBuffer& planes = *near_contacts_;
    for (std::size_t i = 0; i < planes.size(); ++i)
      planes.depth[i] = base_depth_[i] + planes.gradient(i).dot(turned * (planes.point(i) - base_));
  }

  /// Further states of an integrator within a row start from the row before, as the first did. A first contact counts
  /// at once.
  void follow_directions() noexcept {
    damped_ = allowed_.held;
    if (damping_time_ == 0.0) return;
    const bool first_of_row = row_ == nullptr || last_row_ != *row_;
    if (first_of_row) {
      before_ = damped_row_;
      if (row_ != nullptr) last_row_ = *row_;
    }
    if (!allowed_.held.isZero(0.0) && !before_.isZero(0.0))
      damped_ = before_ + dt_ / (damping_time_ + dt_) * (allowed_.held - before_);
    if (first_of_row) damped_row_ = damped_;
  }

  ContactVelocity velocity_at(const ToolState& tool) const noexcept {
    ContactVelocity velocity{tool.velocity, damped_ * tool.velocity};
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

  void place(const Vec3& position) noexcept {
    placed_ = true;
    proxy_ = base_ = position;
    allowed_ = {};
    clear_ = false;
    slowed_ = 1.0;
    near_contacts_->clear();
  }

  /// The allowed move that is nearest to the wanted one, or a slow move out if points are inside the proxy.
  AllowedMove next_move(const Vec3& wanted) noexcept {
    slowed_ = 1.0;
    const double deepest = clear_ ? 0.0 : near_contacts_->largest_depth();
    if (!(deepest > recovery_)) return nearest_allowed(wanted, *near_contacts_);
    slow_down(recovery_ / deepest);
    AllowedMove allowed = nearest_allowed(wanted, *near_contacts_);
    // Points between nearly opposite walls leave by a long way. The move is nearly proportional to the depths.
    for (int k = 0; k < kSlowed && allowed.move.norm() > recovery_; ++k) {
      slow_down(recovery_ / allowed.move.norm());
      allowed = nearest_allowed(wanted, *near_contacts_);
    }
    return allowed;
  }

  /// Scales the depths of points inside the proxy.
  void slow_down(double factor) noexcept {
    slowed_ *= factor;
    for (double& depth : std::span(near_contacts_->depth.data(), near_contacts_->size())) {
      if (depth > 0.0) depth *= factor;
    }
  }

  /// Returns false if the passes did not suffice.
  bool follow(const ToolPose& tool) noexcept {
    const double margin = constraints_->margin();
    const double settled = kSettled * margin, same = kSame * margin;
    std::array<Vec3, kLongestCycle> last;  // places of the last passes
    last.fill(Vec3::Constant(std::numeric_limits<double>::infinity()));
    for (int pass = 0; pass < kProxyPasses; ++pass) {
      const ToolPose proxy{proxy_, tool.axis, tool.roll};
      const Vec3 wanted = tool.position - proxy_;
      constraints_->constraints_at(proxy, wanted, *near_contacts_);
      const AllowedMove& allowed = allowed_ = next_move(wanted);
      work_.iterations += static_cast<std::uint64_t>(allowed.iterations);
      const double length = allowed.move.norm();
      const bool arrives = length <= margin;
      base_ = proxy_;
      proxy_ += arrives ? allowed.move : Vec3(margin / length * allowed.move);
      if (!allowed.feasible || slowed_ < 1.0) {
        // Leaving takes many steps, so one pass in each step is enough.
        clear_ = false;
        return arrives;
      }
      if (arrives) {
        clear_ = true;
        if (allowed.iterations == 0) proxy_ = tool.position;
        if (allowed.iterations == 0 || length <= settled) return true;
        // Patches of the surface become active and inactive as the proxy moves, so passes may cycle through two or four
        // places, all of them allowed. The place nearest to the tool is taken when it recurs.
        const double distance = (tool.position - proxy_).norm();
        bool again = false, nearest = true;
        for (const Vec3& place : last) {
          again |= (proxy_ - place).norm() <= same;
          nearest &= distance <= (tool.position - place).norm() + same;
        }
        if (again && nearest) return true;
        last[static_cast<std::size_t>(pass) % last.size()] = proxy_;
      }
    }
    return false;
  }

  /// lambda_i of a contact that holds the proxy back.
  double multiplier(std::size_t i) const noexcept {
    return near_contacts_->weight[i] + allowed_.share.dot(near_contacts_->gradient(i));
  }

  /// Replaces the colliding points by those that hold the proxy back, as far as there is room; in a compromise, points
  /// and patches may outnumber the points of the shell. Force and energy are those of all of them.
  void hand_over_holding(ContactBuffer& contacts) const noexcept {
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
  double damping_time_;  ///< [s]
  DampingAndLimits damping_and_limits_;
  Skips skips_;
  std::unique_ptr<ProxyConstraints> constraints_;
  std::unique_ptr<ContactBuffer> near_contacts_;  ///< constraints of the last pass, with weights [m]

  const ContactSchedule* schedule_ = nullptr;  ///< null: the proxy looks for points in every row
  std::optional<std::uint64_t> found_;         ///< row of the query that the proxy has looked for points of
  Vec3 base_ = Vec3::Zero();                   ///< place of the proxy that the constraints of the last pass are of
  AlignedDoubles base_depth_;                  ///< their depths, where planes move

  bool placed_ = false;  ///< false before the first step
  Vec3 proxy_ = Vec3::Zero();
  AllowedMove allowed_;                                     ///< of the last pass
  Mat3 damped_ = Mat3::Zero();                              ///< S as normal damping and friction see it
  Mat3 damped_row_ = Mat3::Zero(), before_ = Mat3::Zero();  ///< the same, of this row and of the row before
  std::optional<std::uint64_t> last_row_;
  const std::uint64_t* row_ = nullptr;  ///< null without a simulation; then each force is a row's
  double dt_ = 0.0;
  bool clear_ = false;     ///< no points are inside the proxy after the last pass
  double recovery_ = 0.0;  ///< distance by which the deepest point may leave in a step [m]
  double slowed_ = 1.0;    ///< factor of the depths of points inside in the last pass
  Vec3 spring_ = Vec3::Zero();
  AlgorithmWork work_;
};

/// A proxy placed on the tool moves by at most one margin per pass, however deep the contacts are.
double proxy_bound(const RenderingConfig&, const ToolShape& tool, std::size_t, double) {
  return kProxyPasses * kProxyMargin * tool.half_width();
}

}  // namespace

AlgorithmEntry proxy_entry() {
  static constexpr ModelInfo kInfo = {
      .name = "proxy",
      .summary = "a proxy of the tool never enters the environment, and a spring pulls the tool to the proxy",
      .formula =
          "x = argmin |x - p|^2 with <m_i, x - x_proxy> <= g_i for all points within the margin (g_i signed "
          "distance of the point to the tool, m_i the tool's normal there), and with the tool's foremost edge above "
          "the surface's flat patch about each point; f_spring = K (x - p), S = projector onto the span of the "
          "active gradients",
      .source =
          "not in the thesis; after Zilles and Salisbury 1995 (god-object) and Ruspini et al. 1997, which thesis 1.2 "
          "rejects",
      .known_failure =
          "after a start in deep penetration, or in a hole that the turned tool does not fit into, points remain "
          "inside the proxy, which leaves them at 40 half widths of the tool per second; a flat face of the tool "
          "bumps on a surface whose normals are wrong by more than 6 degrees; no depth model or reduction applies",
      .parameters = kStiffnessAlone,
  };
  return {.info = &kInfo,
          .make = [](const RenderingConfig& config) { return std::make_unique<ProxyRendering>(config); },
          .force_bound = proxy_bound,
          .may_reduce = false,
          .reported_depth_model = "surface_normal",
          .own_parameters = kDampingTime};
}

}  // namespace hapbench
