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

#include "tests/bench/peers/linked_peers.hpp"

/// CGAL: a k-d tree over the points of the shell, asked for those in the box around the drill, each of which is then
/// compared with the drill. The only library here that answers our own question, to the point.
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
  KdTree(const PeerSurface& surface, const PeerDrill& drill) : drill_(drill) {
    for (std::uint32_t i = 0; 3 * i < surface.vertices.size(); ++i) {
      const double* p = &surface.vertices[3 * i];
      tree_.insert({{p[0], p[1], p[2]}, i});
    }
    tree_.build();
  }

  /// Their numbers, ascending.
  std::size_t contacts_at(const PeerPose& pose, std::span<PeerContact> room) override {
    near_.clear();
    points_.clear();
    const auto& r = pose.rotation;
    const Kernel::Vector_3 axis(r[2], r[5], r[8]);
    const Kernel::Point_3 centre(pose.centre[0], pose.centre[1], pose.centre[2]);
    const auto half = [this](double a) {
      return drill_.length / 2.0 * std::abs(a) + drill_.radius * std::sqrt(std::max(0.0, 1.0 - a * a));
    };
    const Kernel::Vector_3 reach(half(axis.x()), half(axis.y()), half(axis.z()));
    tree_.search(std::back_inserter(near_), Box(centre - reach, centre + reach));
    for (const auto& [point, number] : near_) {
      const Kernel::Vector_3 v = point - centre;
      const double s = v * axis;
      if (std::abs(s) <= drill_.length / 2.0 && v.squared_length() - s * s <= drill_.radius * drill_.radius)
        points_.push_back(number);
    }
    std::sort(points_.begin(), points_.end());
    const std::size_t found = std::min(points_.size(), room.size());
    for (std::size_t i = 0; i < found; ++i) room[i].number = points_[i];
    return found;
  }

 private:
  PeerDrill drill_;
  Tree tree_;
  std::vector<Numbered> near_;
  std::vector<std::uint32_t> points_;
};

}  // namespace

std::unique_ptr<Peer> make_kd_tree(const PeerSurface& surface, const PeerDrill& drill) {
  return std::make_unique<KdTree>(surface, drill);
}

}  // namespace hapbench::bench
