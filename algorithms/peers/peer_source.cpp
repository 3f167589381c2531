#include "algorithms/peers/peer_source.hpp"

#include <algorithm>
#include <cstdio>
#include <stdexcept>

namespace hapbench {
namespace {

void push(const HapbenchContact& contact, ContactBuffer& contacts) {
  const Vec3 along = Vec3::Map(contact.gradient);
  const double length = along.norm();
  if (!(length > 0.0 && contact.depth >= 0.0)) return;
  const Vec3 gradient = along / length;
  const std::size_t i = contacts.size();
  contacts.push(contact.index, Vec3::Map(contact.point), -gradient);
  contacts.depth[i] = contact.depth;
  contacts.set_gradient(i, gradient);
}

}  // namespace

HapbenchPose peer_pose(const ToolPose& pose, double length) noexcept {
  const Vec3 centre = pose.position - 0.5 * length * pose.axis;
  const Mat3 r = pose.rotation();
  return {.centre = {centre.x(), centre.y(), centre.z()},
          .rotation = {r(0, 0), r(0, 1), r(0, 2), r(1, 0), r(1, 1), r(1, 2), r(2, 0), r(2, 1), r(2, 2)}};
}

Peer::Peer(const HapbenchContactSource& library, const PeerSurface& surface, const HapbenchCylinder& tool)
    : library_(&library) {
  const HapbenchSurface view = {.vertices = surface.vertices.data(),
                                .vertex_count = surface.vertices.size() / 3,
                                .triangles = surface.triangles.data(),
                                .triangle_count = surface.triangles.size() / 3};
  std::array<char, 200> text{};
  source_ = library.create(&view, &tool, text.data(), text.size());
  if (source_ != nullptr) return;
  set_fault(text.data());
  throw std::runtime_error(fault_.data());
}

void Peer::set_fault(const char* text) noexcept {
  std::snprintf(fault_.data(), fault_.size(), "%s fails: %s", library_->name, text);
  std::replace(fault_.begin(), fault_.end(), '\n', ' ');
}

std::size_t Peer::contacts_at(const HapbenchPose& pose, std::span<HapbenchContact> room) noexcept {
  if (fault() != nullptr) return 0;
  std::array<char, 200> text{};
  const std::int64_t found = library_->contacts_at(source_, &pose, room.data(), room.size(), text.data(), text.size());
  if (found >= 0) return std::min(static_cast<std::size_t>(found), room.size());
  set_fault(text.data());
  return 0;
}

PeerSource::PeerSource(const HapbenchContactSource& library, const PeerSurface& surface, const HapbenchCylinder& tool)
    : peer_(library, surface, tool), length_(tool.length), room_(surface.triangles.size() / 3) {}

void PeerSource::reset() noexcept {
  work_ = {};
  peer_.clear_fault();
  fault_ = nullptr;
}

void PeerSource::contacts_at(const ToolPose& pose, ContactBuffer& contacts) noexcept {
  ++work_.queries;
  contacts.clear();
  const std::size_t found = peer_.contacts_at(peer_pose(pose, length_), room_);
  fault_ = peer_.fault();
  for (std::size_t i = 0; i < found; ++i) push(room_[i], contacts);
  contacts.pad();
}

}  // namespace hapbench
