#include <btBulletCollisionCommon.h>

#include <algorithm>

#include "tests/bench/peers/peer.hpp"

/// Bullet, in double precision: a quantised tree of boxes over static triangles against its cylinder. In millimetres,
/// because its margins and thresholds are made for lengths about 1.
namespace hapbench::bench {
namespace {

constexpr double kMillimetres = 1e3;

/// Counts the contacts of one pair.
struct Counter final : btCollisionWorld::ContactResultCallback {
  PeerAnswer answer;

  btScalar addSingleResult(btManifoldPoint& point, const btCollisionObjectWrapper*, int, int,
                           const btCollisionObjectWrapper*, int, int) override {
    if (point.getDistance() > 0.0) return 0.0;
    ++answer.contacts;
    answer.depth = std::max(answer.depth, -point.getDistance() / kMillimetres);
    return 0.0;
  }
};

class Bullet final : public Peer {
 public:
  Bullet(const PeerSurface& surface, const PeerDrill& drill)
      : vertices_(surface.vertices),
        triangles_(surface.triangles.begin(), surface.triangles.end()),
        drill_(btVector3(drill.radius, drill.radius, drill.length / 2.0) * kMillimetres) {
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

  PeerAnswer ask(const PeerPose& pose) override {
    const auto& r = pose.rotation;
    const btMatrix3x3 rotation(r[0], r[1], r[2], r[3], r[4], r[5], r[6], r[7], r[8]);
    const btVector3 centre(pose.centre[0], pose.centre[1], pose.centre[2]);
    tool_.setWorldTransform(btTransform(rotation, centre * kMillimetres));
    Counter counter;
    world_.contactPairTest(&surface_, &tool_, counter);
    return counter.answer;
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

std::unique_ptr<Peer> make_bullet(const PeerSurface& surface, const PeerDrill& drill) {
  return std::make_unique<Bullet>(surface, drill);
}

}  // namespace hapbench::bench
