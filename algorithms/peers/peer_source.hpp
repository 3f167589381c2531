#pragma once

#include <memory>
#include <string>
#include <vector>

#include "algorithms/peers/hapbench_contacts.h"
#include "algorithms/plugin/plugin_call.hpp"
#include "sim/contact/contact_source.hpp"

namespace hapbench {

/// Room for the contacts of a library, which need not come from triangles.
inline constexpr std::size_t kMostPluginContacts = 10'000;

/// An environment as triangles, as HapbenchSurface.
struct PeerSurface {
  std::vector<double> vertices;
  std::vector<std::uint32_t> triangles;
};

/// The pose of a tool of HapbenchTool::length [m] for a contact source behind the C interface.
HapbenchPose peer_pose(const ToolPose& pose, double length) noexcept;

/// A contact source behind the C interface, as the owner of its state.
class Peer {
 public:
  /// `library` must outlive the peer. Throws std::runtime_error with the library's fault.
  Peer(const HapbenchContactSource& library, const std::string& config, const PeerSurface& surface,
       const HapbenchTool& tool);
  ~Peer() { library_->destroy(source_); }
  Peer(const Peer&) = delete;
  Peer& operator=(const Peer&) = delete;

  /// Fills `room` with the contacts at the pose and returns their number. After a fault, which contacts that cannot be
  /// used are, too, returns 0 until clear_fault.
  std::size_t contacts_at(const HapbenchPose& pose, std::span<HapbenchContact> room) noexcept;
  /// The fault of a query, in one line; null for none.
  const char* fault() const noexcept { return fault_.text(); }
  void clear_fault() noexcept { fault_.clear(); }

 private:
  std::size_t check(std::span<const HapbenchContact> contacts) noexcept;

  const HapbenchContactSource* library_;
  void* source_ = nullptr;
  FaultText fault_;
};

/// The contacts of another library for our laws. The library decides which contacts there are, where, how deep and in
/// which direction; no depth model takes part. `index` is the library's; the normal is the reversed gradient.
///
/// Unlike other sources, it allocates in a step if the library does.
class PeerSource final : public ContactSource {
 public:
  /// Throws std::runtime_error if the library cannot make its source.
  PeerSource(const HapbenchContactSource& library, const std::string& config, const PeerSurface& surface,
             const HapbenchTool& tool, std::size_t capacity);

  /// After a fault of the library: no contacts until the next reset.
  void contacts_at(const ToolPose& pose, ContactBuffer& contacts) noexcept override;
  std::size_t capacity() const noexcept override { return room_.size(); }
  void reset() noexcept override;
  const SearchWork& work() const noexcept override { return work_; }

 private:
  Peer peer_;
  double length_;
  std::vector<HapbenchContact> room_;
  SearchWork work_;
};

}  // namespace hapbench
