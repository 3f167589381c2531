#include "scenarios/run/open_edges.hpp"

#include <gtest/gtest.h>

#include "tests/results/rows.hpp"

namespace hapbench::open_edges_test {
namespace {

/// A row of points along x, a millimetre apart, the mesh being open at x = 0.
class OpenEdges : public testing::Test {
 protected:
  OpenEdges() : shell_(points(), 0.0), observer_(shell_, {Vec3::Zero()}, 0.002) {}

  static std::vector<SurfacePoint> points() {
    std::vector<SurfacePoint> points;
    for (int i = 0; i < 20; ++i) points.push_back({{0.001 * i, 0, 0}, Vec3::UnitZ()});
    return points;
  }
  void touch(std::uint32_t point) {
    ContactBuffer contacts(1);
    contacts.push(point, shell_.point(point).position, Vec3::UnitZ());
    observer_.on_step(test::row(row_, 0.5 * static_cast<double>(row_), contacts));
    ++row_;
  }

  PointShell shell_;
  OpenEdgeObserver observer_;
  std::uint64_t row_ = 0;
};

TEST_F(OpenEdges, FarFromThemNothingIsSaid) {
  for (std::uint32_t i = 3; i < 20; ++i) touch(i);
  EXPECT_EQ(observer_.warning(), std::nullopt);
}

TEST_F(OpenEdges, NearThemTheFirstTouchIsTold) {
  touch(9);
  touch(2);
  touch(0);
  EXPECT_EQ(observer_.warning(),
            "touched the mesh within 2 mm of where it is open in 2 rows, first at 0.5 s near (2, 0, 0) mm: beyond the "
            "edge there is no surface");
}

}  // namespace
}  // namespace hapbench::open_edges_test
