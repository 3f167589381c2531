#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "sim/contact/contact_query.hpp"
#include "sim/core/random.hpp"
#include "sim/tool/cylinder.hpp"
#include "tests/support/scale.hpp"

/// Random shells, random walks of the tool and brute-force search, for tests of contact searches.
namespace hapbench::test {

/// Returns true if both buffers contain the same contacts in the same order, bit for bit.
bool same_contacts(const ContactBuffer& a, const ContactBuffer& b);

/// Returns points on a rough sheet, in a ball, on a lattice (at the borders of cells) or along a line, `size`
/// metres wide.
std::vector<SurfacePoint> random_shell(Random& random, double size);

/// Returns the next pose of a random walk. Most steps are small; some are zero, a jump, a rotation on the spot,
/// or a move far away.
ToolPose next_pose(const ToolPose& pose, Random& random, double size, double step);

/// Two contact searches over the same shell: the search of a simulation run, and a search by brute force.
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

/// Totals over the poses of all walks of a test: poses, contacts found and neighbour lists built.
struct WalkTotals {
  std::uint64_t poses = 0, contacts = 0, lists_rebuilt = 0;
};

/// Moves random tools over random shells, with cases(1'000'000) poses in total. The tools are created by
/// make_tool(random, size of the shell). At each pose, expects the search of a simulation run to find the same
/// contacts as a search by brute force.
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
