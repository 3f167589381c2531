#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "sim/contact/contact_query.hpp"
#include "sim/core/random.hpp"
#include "sim/tool/cylinder.hpp"
#include "tests/support/scale.hpp"

/// Shells, walks of the tool and brute force for tests of contact searches.
namespace hapbench::test {

/// Whether both buffers hold the same contacts in the same order, bit for bit.
bool same_contacts(const ContactBuffer& a, const ContactBuffer& b);

/// Points on a rough sheet, in a ball, on a lattice (cell borders) or along a line, `size` metres wide.
std::vector<SurfacePoint> random_shell(Random& random, double size);

/// The next pose of a walk: mostly small steps, sometimes none, a jump, a turn on the spot, or far away.
ToolPose next_pose(const ToolPose& pose, Random& random, double size, double step);

/// The search of runs and brute force side by side over one shell.
class SearchPair {
 public:
  SearchPair(const std::vector<SurfacePoint>& points, double cell_size, const Cylinder& tool)
      : SearchPair(points, cell_size, std::make_shared<Cylinder>(tool)) {}
  SearchPair(const std::vector<SurfacePoint>& points, double cell_size, std::shared_ptr<const ToolShape> tool)
      : tool_(std::move(tool)),
        shell_(points, cell_size),
        search_(make_contact_query(shell_, *tool_, Skips::on)),
        brute_(make_contact_query(shell_, *tool_, Skips::off)),
        found_(search_->capacity()),
        all_(points.size()) {}

  bool agree_at(const ToolPose& pose) {
    search_->contacts_at(pose, found_);
    brute_->contacts_at(pose, all_);
    contacts_ += all_.size();
    return all_.size() <= search_->capacity() && same_contacts(found_, all_);
  }
  std::uint64_t contacts() const { return contacts_; }
  const SearchWork& work() const { return search_->work(); }

 private:
  std::shared_ptr<const ToolShape> tool_;
  PointShell shell_;
  std::unique_ptr<ContactQuery> search_, brute_;
  ContactBuffer found_, all_;
  std::uint64_t contacts_ = 0;
};

/// Totals over the poses of a walk.
struct WalkTotals {
  std::uint64_t poses = 0, contacts = 0, lists_rebuilt = 0;
};

/// Walks tools, make_tool(random, size of the shell), over random shells, cases(1'000'000) poses in all, and expects
/// the search of runs to find at each what brute force finds.
template <class MakeTool>
void expect_agreement_with_brute_force(Random random, const MakeTool& make_tool, WalkTotals& totals) {
  const std::size_t shells = cases(2000);
  for (std::size_t s = 0; s < shells; ++s) {
    const double size = std::pow(10.0, random.uniform(-4.0, 0.0));
    const std::shared_ptr<const ToolShape> tool = make_tool(random, size);
    SearchPair pair(random_shell(random, size), random.below(2) == 0 ? 0.0 : size * random.uniform(0.01, 1.0), tool);
    ToolPose pose{Vec3::Zero(), random.direction()};
    for (int k = 0; k < 500; ++k, ++totals.poses) {
      pose = next_pose(pose, random, size, 0.2 * tool->half_width());
      ASSERT_TRUE(pair.agree_at(pose)) << "shell " << s << ", pose " << k;
    }
    totals.contacts += pair.contacts();
    totals.lists_rebuilt += pair.work().lists_rebuilt;
  }
  EXPECT_GE(totals.poses, cases(2000) * 500);
}

}  // namespace hapbench::test
