#pragma once

#include <memory>

#include "sim/contact/shell_query.hpp"
#include "sim/core/random.hpp"
#include "sim/tool/cylinder.hpp"

/// What the tests of contact searches share: shells, walks of the tool, and brute force to compare with.
namespace hapbench::test {

/// Whether both buffers hold the same contacts in the same order, bit for bit.
bool same_contacts(const ContactBuffer& a, const ContactBuffer& b);

/// Points on a rough sheet, in a ball, on a lattice (cell borders) or along a line, `size` metres wide.
std::vector<SurfacePoint> random_shell(Random& random, double size);

/// The next pose of a walk: mostly small steps, sometimes none, a jump, a turn on the spot, or far away.
ToolPose next_pose(const ToolPose& pose, Random& random, double size, double step);

/// A search and brute force side by side over one shell.
template <class Query>
class SearchPair {
 public:
  SearchPair(const std::vector<SurfacePoint>& points, double cell_size, const Cylinder& tool)
      : SearchPair(points, cell_size, std::make_shared<Cylinder>(tool)) {}
  SearchPair(const std::vector<SurfacePoint>& points, double cell_size, std::shared_ptr<const ToolShape> tool)
      : tool_(std::move(tool)),
        shell_(points, cell_size),
        search_(shell_, *tool_),
        brute_(shell_, *tool_),
        found_(search_.capacity()),
        all_(points.size()) {}

  bool agree_at(const ToolPose& pose) {
    search_.contacts_at(pose, found_);
    brute_.contacts_at(pose, all_);
    contacts_ += all_.size();
    return all_.size() <= search_.capacity() && same_contacts(found_, all_);
  }
  void reset() { search_.reset(); }
  std::uint64_t contacts() const { return contacts_; }
  const SearchWork& work() const { return search_.work(); }

 private:
  std::shared_ptr<const ToolShape> tool_;
  PointShell shell_;
  Query search_;
  ShellQuery brute_;
  ContactBuffer found_, all_;
  std::uint64_t contacts_ = 0;
};

}  // namespace hapbench::test
