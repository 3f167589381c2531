#include <btBulletCollisionCommon.h>

#include <memory>
#include <vector>

#include "tests/bench/peers/contact_library.hpp"

/// Bullet in double precision. Its cylinder is tested against static triangles in a quantised tree of boxes. Lengths
/// are in millimetres, because Bullet's margins and thresholds assume lengths of about 1. Each triangle that the
/// cylinder meets is a contact, with the depth that GJK and EPA find for cylinder and triangle.
namespace hapbench::bench {
namespace {

constexpr double kMillimetres = 1e3;

/// Collects the depths of the contacts between the surface and the drill.
class Taker final : public btCollisionWorld::ContactResultCallback {
 public:
  explicit Taker(std::span<PeerContact> room) : room_(room) {}

  btScalar addSingleResult(btManifoldPoint& point, const btCollisionObjectWrapper*, int, int,
                           const btCollisionObjectWrapper*, int, int) override {
    if (point.getDistance() <= 0.0 && found < room_.size()) room_[found++].depth = -point.getDistance() / kMillimetres;
    return 0.0;
  }

  std::size_t found = 0;

 private:
  std::span<PeerContact> room_;
};

class Bullet final : public Peer {
 public:
  explicit Bullet(const HapbenchRun& run)
      : vertices_(run.vertices, run.vertices + 3 * run.vertex_count),
        triangles_(run.triangles, run.triangles + 3 * run.triangle_count),
        drill_(btVector3(run.tool_radius, run.tool_radius, run.tool_length / 2.0) * kMillimetres) {
    for (double& x : vertices_) x *= kMillimetres;
    indices_ = std::make_unique<btTriangleIndexVertexArray>(
        static_cast<int>(triangles_.size() / 3), triangles_.data(), static_cast<int>(3 * sizeof(int)),
        static_cast<int>(vertices_.size() / 3), vertices_.data(), static_cast<int>(3 * sizeof(double)));
    mesh_ = std::make_unique<btBvhTriangleMeshShape>(indices_.get(), true);
    mesh_->setMargin(0.0);
    drill_.setMargin(1e-3);
    surface_.setCollisionShape(mesh_.get());
    tool_.setCollisionShape(&drill_);
  }

  std::size_t contacts_at(const HapbenchPose& pose, std::span<PeerContact> room) override {
    const auto& r = pose.rotation;
    const btMatrix3x3 rotation(r[0], r[1], r[2], r[3], r[4], r[5], r[6], r[7], r[8]);
    const btVector3 centre(pose.centre[0], pose.centre[1], pose.centre[2]);
    tool_.setWorldTransform(btTransform(rotation, centre * kMillimetres));
    Taker taker(room);
    world_.contactPairTest(&surface_, &tool_, taker);
    return taker.found;
  }

 private:
  std::vector<double> vertices_;
  std::vector<int> triangles_;
  btCylinderShapeZ drill_;
  std::unique_ptr<btTriangleIndexVertexArray> indices_;
  std::unique_ptr<btBvhTriangleMeshShape> mesh_;
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broadphase_;
  btCollisionWorld world_{&dispatcher_, &broadphase_, &configuration_};
  btCollisionObject surface_, tool_;
};

}  // namespace

std::unique_ptr<Peer> bullet(const HapbenchRun& run) {
  return std::make_unique<Bullet>(run);
}

}  // namespace hapbench::bench
