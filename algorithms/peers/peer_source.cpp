#include "algorithms/peers/peer_source.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <stdexcept>

#include "algorithms/plugin/plugin_call.hpp"

namespace hapbench {
namespace {

constexpr double kLargestLengthError = 1e-3;  ///< of a gradient

/// The reason for which a contact cannot be used; null for none.
const char* problem_of(const HapbenchContact& contact) {
  if (!Vec3::Map(contact.point).allFinite() || !Vec3::Map(contact.gradient).allFinite() ||
      !std::isfinite(contact.depth))
    return "a contact that is not finite";
  if (std::abs(Vec3::Map(contact.gradient).norm() - 1.0) > kLargestLengthError)
    return "a contact whose gradient is no unit vector";
  return contact.depth < 0.0 ? "a contact with a negative depth" : nullptr;
}

void push(const HapbenchContact& contact, ContactBuffer& contacts) {
  const Vec3 along = Vec3::Map(contact.gradient);
  const Vec3 gradient = along / along.norm();
  const std::size_t i = contacts.size();
  contacts.push(contact.index, Vec3::Map(contact.point), -gradient);
  contacts.depth[i] = contact.depth;
  contacts.set_gradient(i, gradient);
}

}  // namespace

HapbenchPose peer_pose(const ToolPose& pose, double length) noexcept {
  const Vec3 centre = pose.position - 0.5 * length * pose.axis;
  const Mat3 r = pose.rotation();
  const Vec3& tip = pose.position;
  return {.tip = {tip.x(), tip.y(), tip.z()},
          .centre = {centre.x(), centre.y(), centre.z()},
          .rotation = {r(0, 0), r(0, 1), r(0, 2), r(1, 0), r(1, 1), r(1, 2), r(2, 0), r(2, 1), r(2, 2)}};
}

Peer::Peer(const HapbenchContactSource& library, const std::string& config, const PeerSurface& surface,
           const HapbenchTool& tool)
    : library_(&library) {
  const HapbenchSurface view = {.vertices = surface.vertices.data(),
                                .vertex_count = surface.vertices.size() / 3,
                                .triangles = surface.triangles.data(),
                                .triangle_count = surface.triangles.size() / 3};
  std::array<char, 200> text{};
  const PluginCall running(library.name, "create");
  source_ = library.create(config.c_str(), &view, &tool, text.data(), text.size());
  if (source_ != nullptr) return;
  fault_.set(library_->name, text.data());
  throw std::runtime_error(fault());
}

std::size_t Peer::contacts_at(const HapbenchPose& pose, std::span<HapbenchContact> room) noexcept {
  if (fault() != nullptr) return 0;
  std::array<char, 200> text{};
  const auto found = [&] {
    const PluginCall running(library_->name, "contacts_at");
    return library_->contacts_at(source_, &pose, room.data(), room.size(), text.data(), text.size());
  }();
  text.back() = '\0';
  if (found > static_cast<std::int64_t>(room.size()))
    std::snprintf(text.data(), text.size(), "gives %lld contacts; allowed: at most %zu", static_cast<long long>(found),
                  room.size());
  else if (found >= 0)
    return check(room.first(static_cast<std::size_t>(found)));
  fault_.set(library_->name, text.data());
  return 0;
}

std::size_t Peer::check(std::span<const HapbenchContact> contacts) noexcept {
  for (const HapbenchContact& contact : contacts) {
    const char* problem = problem_of(contact);
    if (problem == nullptr) continue;
    fault_.set(library_->name, problem);
    return 0;
  }
  return contacts.size();
}

PeerSource::PeerSource(const HapbenchContactSource& library, const std::string& config, const PeerSurface& surface,
                       const HapbenchTool& tool, std::size_t capacity)
    : peer_(library, config, surface, tool), length_(tool.length), room_(capacity) {}

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
