#pragma once

#include <memory>
#include <string>
#include <vector>

#include "algorithms/peers/peer.hpp"
#include "sim/contact/contact_source.hpp"

namespace hapbench {

/// The contacts of another collision library for our laws: which there are, where, how deep and in which direction is
/// as it says, one for each triangle that the drill meets. No depth model has a part in them.
///
/// What they mean. Our contact is a point of the shell in the tool, with the way along its gradient out of the tool. A
/// peer's is a triangle that the tool's surface or inside meets, with the shortest translation that parts the pair: of
/// a thin triangle deep in the tool, that may be to either side. `index` is the triangle; the normal is the gradient
/// turned round. Contacts without a direction, or with a depth below zero, are left out.
///
/// Unlike other sources it allocates in a step, as the library does.
class PeerSource final : public ContactSource {
 public:
  /// `most_contacts` is that of triangles; `length` is the drill's [m].
  PeerSource(std::unique_ptr<Peer> peer, std::string name, double length, std::size_t most_contacts);

  /// Once the library has thrown, nothing until the next reset.
  void contacts_at(const ToolPose& pose, ContactBuffer& contacts) noexcept override;
  std::size_t capacity() const noexcept override { return room_.size(); }
  void reset() noexcept override;
  const SearchWork& work() const noexcept override { return work_; }

 private:
  std::size_t ask(const ToolPose& pose) noexcept;

  std::unique_ptr<Peer> peer_;
  std::string name_;
  double length_;
  std::vector<PeerContact> room_;
  SearchWork work_;
  std::string fault_text_;
};

/// The drill's pose as peers take it; its length [m].
PeerPose peer_pose(const ToolPose& pose, double length) noexcept;

}  // namespace hapbench
