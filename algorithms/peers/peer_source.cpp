#include "algorithms/peers/peer_source.hpp"

#include <algorithm>
#include <exception>
#include <utility>

namespace hapbench {
namespace {

Vec3 vector(const std::array<double, 3>& v) {
  return {v[0], v[1], v[2]};
}

void push(const PeerContact& contact, ContactBuffer& contacts) {
  const Vec3 along = vector(contact.gradient);
  const double length = along.norm();
  if (!(length > 0.0 && contact.depth >= 0.0)) return;
  const Vec3 gradient = along / length;
  const std::size_t i = contacts.size();
  contacts.push(contact.number, vector(contact.point), -gradient);
  contacts.depth[i] = contact.depth;
  contacts.set_gradient(i, gradient);
}

}  // namespace

PeerPose peer_pose(const ToolPose& pose, double length) noexcept {
  const Vec3 centre = pose.position - 0.5 * length * pose.axis;
  const Mat3 r = pose.rotation();
  return {{centre.x(), centre.y(), centre.z()},
          {r(0, 0), r(0, 1), r(0, 2), r(1, 0), r(1, 1), r(1, 2), r(2, 0), r(2, 1), r(2, 2)}};
}

PeerSource::PeerSource(std::unique_ptr<Peer> peer, std::string name, double length, std::size_t most_contacts)
    : peer_(std::move(peer)), name_(std::move(name)), length_(length), room_(most_contacts) {}

void PeerSource::reset() noexcept {
  work_ = {};
  fault_ = nullptr;
}

std::size_t PeerSource::ask(const ToolPose& pose) noexcept {
  if (fault() != nullptr) return 0;
  try {
    return peer_->contacts_at(peer_pose(pose, length_), room_);
  } catch (const std::exception& error) {
    fault_text_ = name_ + " fails: " + error.what();
  } catch (...) {
    fault_text_ = name_ + " fails";
  }
  std::replace(fault_text_.begin(), fault_text_.end(), '\n', ' ');  // for messages of one line
  fault_ = fault_text_.c_str();
  return 0;
}

void PeerSource::contacts_at(const ToolPose& pose, ContactBuffer& contacts) noexcept {
  ++work_.queries;
  contacts.clear();
  const std::size_t found = ask(pose);
  for (std::size_t i = 0; i < found; ++i) push(room_[i], contacts);
  contacts.pad();
}

}  // namespace hapbench
