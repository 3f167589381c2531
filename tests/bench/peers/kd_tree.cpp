#include <CGAL/Fuzzy_iso_box.h>
#include <CGAL/Kd_tree.h>
#include <CGAL/Search_traits_3.h>
#include <CGAL/Search_traits_adapter.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/property_map.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "tests/bench/peers/contact_library.hpp"

/// CGAL: a k-d tree over the points of the shell. A query takes the points in the box around the drill and compares
/// each point with the drill. Its result equals the result of hapbench's search.
namespace hapbench::bench {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Numbered = std::pair<Kernel::Point_3, std::uint32_t>;
using Traits =
    CGAL::Search_traits_adapter<Numbered, CGAL::First_of_pair_property_map<Numbered>, CGAL::Search_traits_3<Kernel>>;
using Tree = CGAL::Kd_tree<Traits>;
using Box = CGAL::Fuzzy_iso_box<Traits>;

class KdTree final : public Peer {
 public:
  explicit KdTree(const HapbenchRun& run) : length_(run.tool_length), radius_(run.tool_radius) {
    for (std::uint32_t i = 0; i < run.vertex_count; ++i) {
      const double* p = &run.vertices[3 * i];
      tree_.insert({{p[0], p[1], p[2]}, i});
    }
    tree_.build();
  }

  /// Writes the indices of the points in the drill, ascending. Returns their number.
  std::size_t contacts_at(const HapbenchPose& pose, std::span<PeerContact> room) override {
    near_.clear();
    points_.clear();
    const auto& r = pose.rotation;
    const Kernel::Vector_3 axis(r[2], r[5], r[8]);
    const Kernel::Point_3 centre(pose.centre[0], pose.centre[1], pose.centre[2]);
    const auto half = [this](double a) {
      return length_ / 2.0 * std::abs(a) + radius_ * std::sqrt(std::max(0.0, 1.0 - a * a));
    };
    const Kernel::Vector_3 reach(half(axis.x()), half(axis.y()), half(axis.z()));
    tree_.search(std::back_inserter(near_), Box(centre - reach, centre + reach));
    for (const auto& [point, number] : near_) {
      const Kernel::Vector_3 v = point - centre;
      const double s = v * axis;
      if (std::abs(s) <= length_ / 2.0 && v.squared_length() - s * s <= radius_ * radius_) points_.push_back(number);
    }
    std::sort(points_.begin(), points_.end());
    const std::size_t found = std::min(points_.size(), room.size());
    for (std::size_t i = 0; i < found; ++i) room[i].index = points_[i];
    return found;
  }

 private:
  double length_, radius_;  ///< length and radius of the drill [m]
  Tree tree_;
  std::vector<Numbered> near_;
  std::vector<std::uint32_t> points_;
};

}  // namespace

std::unique_ptr<Peer> kd_tree(const HapbenchRun& run) {
  return std::make_unique<KdTree>(run);
}

}  // namespace hapbench::bench
