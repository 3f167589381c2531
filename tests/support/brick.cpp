#include "tests/support/brick.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hapbench::test {
namespace {

/// The point in the tool's frame.
Vec3 local(const ToolPose& pose, const Vec3& point) {
  return pose.rotation().transpose() * (point - pose.position);
}

struct Face {
  double depth = std::numeric_limits<double>::infinity();
  Vec3 normal = Vec3::Zero();
};

/// The face nearest to a point inside, with its outward normal.
Face nearest_face(const Vec3& q, const Vec3& low, const Vec3& high) {
  Face nearest;
  for (int k = 0; k < 3; ++k) {
    if (high[k] - q[k] < nearest.depth) nearest = {high[k] - q[k], Vec3::Unit(k)};
    if (q[k] - low[k] < nearest.depth) nearest = {q[k] - low[k], -Vec3::Unit(k)};
  }
  return nearest;
}

template <class Inside>
void mark(const PointArrays& points, std::span<const PackRange> ranges, std::uint8_t* marks, const Inside& inside) {
  for (const PackRange& range : ranges) {
    for (std::size_t pack = range.first; pack < range.last; ++pack) {
      std::uint8_t bits = 0;
      for (std::size_t k = 0; k < 8; ++k) {
        const std::size_t i = 8 * pack + k;
        if (inside(Vec3(points.x[i], points.y[i], points.z[i]))) bits = static_cast<std::uint8_t>(bits | 1u << k);
      }
      *marks++ = range.own(bits, pack);
    }
  }
}

}  // namespace

Brick::Brick(double half_x, double half_y, double length)
    : ToolShape(std::min(half_x, half_y), std::hypot(half_x, half_y, length)),
      low_(-half_x, -half_y, 0.0),
      high_(half_x, half_y, length) {}

std::vector<ProfilePoint> Brick::outline() const {
  const double widest = std::hypot(high_.x(), high_.y());
  return {{-high_.z(), 0.0}, {-high_.z(), widest}, {0.0, widest}, {0.0, 0.0}};
}

double Brick::slack(const ToolPose& pose, const Vec3& point) const {
  return nearest_face(local(pose, point), low_, high_).depth;
}

void Brick::mark_inside(const ToolPose& pose, const PointArrays& points, std::span<const PackRange> ranges,
                        std::uint8_t* marks) const noexcept {
  mark(points, ranges, marks, [&](const Vec3& point) { return slack(pose, point) >= 0.0; });
}

void Brick::push_inside(const ToolPose& pose, const PointColumns& points, std::span<const PackRange> ranges,
                        ContactBuffer& contacts) const noexcept {
  for (const PackRange& range : ranges) {
    for (std::size_t i = 8 * range.first; i < 8 * range.last; ++i) {
      if ((range.own(static_cast<std::uint8_t>(1u << i % 8), i / 8)) == 0) continue;
      const Vec3 point(points.x[i], points.y[i], points.z[i]);
      if (slack(pose, point) >= 0.0) contacts.push(points.index[i], point, {points.nx[i], points.ny[i], points.nz[i]});
    }
  }
}

void Brick::mark_near(const ToolPose& pose, double margin, const PointArrays& points, std::span<const PackRange> ranges,
                      std::uint8_t* marks) const noexcept {
  mark(points, ranges, marks, [&](const Vec3& point) { return slack(pose, point) >= -margin; });
}

Box Brick::box_near(const ToolPose& pose, double margin, const Box&) const noexcept {
  const Mat3 R = pose.rotation();
  const Vec3 centre = pose.position + R * (0.5 * (low_ + high_));
  const Vec3 half = R.cwiseAbs() * (0.5 * (high_ - low_)) + Vec3::Constant(margin);
  return {centre - half, centre + half};
}

double Brick::moved_at_most(const ToolPose& from, const ToolPose& to) const noexcept {
  return (to.position - from.position).norm() + (to.rotation() - from.rotation()).norm() * reach();
}

void Brick::shortest_depths(const ToolPose& pose, ContactBuffer& contacts) const noexcept {
  for (std::size_t i = 0; i < contacts.size(); ++i) contacts.depth[i] = slack(pose, contacts.point(i));
}

void Brick::shortest_gradients(const ToolPose& pose, ContactBuffer& contacts) const noexcept {
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    contacts.set_gradient(i, pose.rotation() * nearest_face(local(pose, contacts.point(i)), low_, high_).normal);
  }
}

void Brick::exit_distances(const ToolPose& pose, const ContactBuffer& contacts, double* exits) const noexcept {
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Vec3 q = local(pose, contacts.point(i)), u = pose.rotation().transpose() * contacts.gradient(i);
    exits[i] = 2.0 * reach();
    for (int k = 0; k < 3; ++k) {
      if (u[k] != 0.0) exits[i] = std::min(exits[i], std::max(0.0, ((u[k] > 0.0 ? high_ : low_)[k] - q[k]) / u[k]));
    }
  }
}

void Brick::surface_constraints(const ToolPose& pose, const Vec3&, double, ContactBuffer& contacts) const noexcept {
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Vec3 q = local(pose, contacts.point(i));
    const Vec3 out = q - q.cwiseMax(low_).cwiseMin(high_);
    const double distance = out.norm();
    const Face face = nearest_face(q, low_, high_);
    contacts.depth[i] = distance > 0.0 ? -distance : face.depth;
    contacts.set_gradient(i, pose.rotation() * (distance > 0.0 ? Vec3(out / distance) : face.normal));
  }
  contacts.pad();
}

void Brick::foremost_places(const ToolPose& pose, const ContactBuffer& contacts,
                            const PlaceArrays& places) const noexcept {
  const Mat3 R = pose.rotation();
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Vec3 n = R.transpose() * contacts.normal(i);
    Vec3 q = local(pose, contacts.point(i)).cwiseMax(low_).cwiseMin(high_);  // abreast of the contact
    for (int k = 0; k < 3; ++k) {
      if (std::abs(n[k]) > 1e-9) q[k] = n[k] > 0.0 ? low_[k] : high_[k];
    }
    const Vec3 place = pose.position + R * q;
    places.x[i] = place.x();
    places.y[i] = place.y();
    places.z[i] = place.z();
  }
}

ToolShape::Grown Brick::grown(double margin) const {
  auto brick = std::make_unique<Brick>(high_.x() + margin, high_.y() + margin, high_.z() + 2.0 * margin);
  return {std::move(brick), margin};
}

}  // namespace hapbench::test
