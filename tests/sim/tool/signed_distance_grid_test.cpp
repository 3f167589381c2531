#include "sim/tool/signed_distance_grid.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <string>

#include "sim/core/random.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/scale.hpp"
#include "tests/support/tool_meshes.hpp"

namespace hapbench::signed_distance_grid_test {
namespace {

using test::cases;
using test::exact_distance;
using test::grid_of;

struct NamedMesh {
  const char* name;
  TriangleSoup (*make)();
  double spacing;
  bool convex;
};
std::ostream& operator<<(std::ostream& out, const NamedMesh& mesh) {
  return out << mesh.name;
}

const NamedMesh kMeshes[] = {{"cube",
                              [] {
                                return test::cube(0.7, {0.1, 0.0, 0.4});
                              },
                              0.1, true},
                             {"sphere", [] { return test::sphere(1.0, 3); }, 0.15, true},
                             {"torus", [] { return test::torus(24, 12); }, 0.2, false},
                             {"cup", [] { return test::cup(20); }, 0.1, false},
                             {"two_cubes",
                              [] {
                                return test::together(test::cube(0.5), test::cube(0.3, {1.1, 0.2, 0.0}));
                              },
                              0.1, false},
                             {"cylinder", [] { return test::cylinder_mesh(0.5, 3.0, 32); }, 0.08, true}};

class GridOfMesh : public testing::TestWithParam<NamedMesh> {
 protected:
  const TriangleSoup soup_ = GetParam().make();
  const std::shared_ptr<const SignedDistanceGrid> grid_ = grid_of(soup_, GetParam().spacing);
};
INSTANTIATE_TEST_SUITE_P(OfAllKinds, GridOfMesh, testing::ValuesIn(kMeshes),
                         [](const auto& mesh) { return std::string(mesh.param.name); });

TEST_P(GridOfMesh, HasExactSignedDistancesAtItsNodes) {
  const GridNodes& nodes = grid_->nodes();
  Random random(1);
  for (std::size_t n = 0; n < cases(3000); ++n) {
    const std::size_t i = random.below(nodes.count[0]), j = random.below(nodes.count[1]),
                      k = random.below(nodes.count[2]);
    ASSERT_NEAR(grid_->values()[nodes.index(i, j, k)], exact_distance(soup_, nodes.place(i, j, k)), 1e-8)
        << nodes.place(i, j, k).transpose();
  }
}

TEST_P(GridOfMesh, KnowsWhetherItIsConvex) {
  EXPECT_EQ(grid_->convex(), GetParam().convex);
}

TEST_P(GridOfMesh, MarksNodesAsAllInsideOrOutsideOnlyIfTheirNeighboursAre) {
  const GridNodes& nodes = grid_->nodes();
  std::size_t kinds[3] = {};
  for (std::size_t i = 1; i + 1 < nodes.count[0]; ++i) {
    for (std::size_t j = 1; j + 1 < nodes.count[1]; ++j) {
      for (std::size_t k = 1; k + 1 < nodes.count[2]; ++k) {
        const std::uint8_t kind = grid_->kinds()[nodes.index(i, j, k)];
        ++kinds[kind];
        for (std::size_t n = 0; n < 27; ++n) {
          const double value = grid_->values()[nodes.index(i + n / 9 - 1, j + n / 3 % 3 - 1, k + n % 3 - 1)];
          ASSERT_TRUE(kind == SignedDistanceGrid::mixed || (kind == SignedDistanceGrid::inside) == (value <= 0.0));
        }
      }
    }
  }
  for (const std::size_t count : kinds) EXPECT_GT(count, 0u);
}

TEST_P(GridOfMesh, IsTheSameBytesForAnyNumberOfThreads) {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const auto again = grid_of(soup_, GetParam().spacing);
  const std::size_t n = grid_->nodes().size();
  EXPECT_TRUE(std::equal(grid_->values(), grid_->values() + n, again->values()));
  EXPECT_TRUE(std::equal(grid_->kinds(), grid_->kinds() + n, again->kinds()));
  EXPECT_EQ(grid_->thin_share(), again->thin_share());
}

TEST_P(GridOfMesh, KnowsTheForemostPlaceInEveryDirection) {
  Random random(2);
  for (std::size_t n = 0; n < cases(3000); ++n) {
    const Vec3 u = n % 4 == 0 ? Vec3(Vec3::Unit(static_cast<int>(n / 4 % 3))) : random.direction();
    double most = -1e300;
    for (const Vec3& v : soup_.vertices) most = std::max(most, u.dot(v));
    ASSERT_NEAR(grid_->hull().support(u), most, 1e-14);
    ASSERT_NEAR(grid_->hull().foremost(u, 2.0 * random.direction()).dot(u), most, 1e-8);
  }
}

TEST(SignedDistanceGrid, FindsThePlaceOfAForemostEdgeOrFaceThatIsAbreast) {
  const auto grid = grid_of(test::cube(1.0), 0.1);
  EXPECT_LT((grid->hull().foremost({0, 0, 1}, {0.3, -0.2, 4.0}) - Vec3(0.3, -0.2, 1.0)).norm(),
            0.001);  // two passes over its corners
  EXPECT_LT((grid->hull().foremost(Vec3(0, 1, 1).normalized(), {0.3, 3.0, 4.0}) - Vec3(0.3, 1, 1)).norm(), 1e-9);
}

TEST(SignedDistanceGrid, SuggestsSome128NodesAlongAnEdge) {
  for (const Vec3& extent : {Vec3(1, 1, 1), Vec3(0.001, 0.001, 0.01), Vec3(2, 1, 0.4)}) {
    TriangleSoup box = test::cube(0.5);
    for (Vec3& v : box.vertices) v = v.cwiseProduct(extent);
    const auto grid = grid_of(box, SignedDistanceGrid::suggested_spacing(box.vertices));
    EXPECT_GT(grid->nodes().size(), 1u << 20);
    EXPECT_LT(grid->nodes().size(), 1u << 22);
    EXPECT_LT(grid->bytes(), 40u << 20);
  }
}

/// What is said of a mesh that is refused; empty if it is not.
std::string refusal(const TriangleSoup& soup, double spacing = 0.1) {
  try {
    grid_of(soup, spacing);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(SignedDistanceGrid, RefusesBadMeshesWithWhatWasMeasured) {
  EXPECT_EQ(refusal(test::cube()), "");
  TriangleSoup open = test::cube();
  open.triangles.pop_back();
  EXPECT_EQ(refusal(open),
            "the mesh bounds no solid: 3 open edges (a triangle on one side only); the first at [1, -1, 0] m; "
            "close its holes");
  TriangleSoup turned = test::cube();
  std::swap(turned.triangles[0][0], turned.triangles[0][1]);
  EXPECT_NE(refusal(turned).find("3 edges whose triangles are wound against each other"), std::string::npos);
  EXPECT_NE(refusal(test::reversed(test::cube())).find("inside out (volume -8 m^3)"), std::string::npos);
  EXPECT_EQ(refusal(TriangleSoup{}), "the mesh has no triangles");
  TriangleSoup flat = test::cube();
  for (Vec3& v : flat.vertices) v.z() = 0.0;
  EXPECT_NE(refusal(flat).find("encloses no volume"), std::string::npos) << refusal(flat);
  TriangleSoup infinite = test::cube();
  infinite.vertices[3].y() = INFINITY;
  EXPECT_EQ(refusal(infinite), "vertex 3 of the mesh is not finite");
  TriangleSoup stray = test::cube();
  stray.triangles[0][0] = 8;
  EXPECT_NE(refusal(stray), "");
  for (const double spacing : {0.0, -1.0, std::nan("")}) {
    EXPECT_NE(refusal(test::cube(), spacing).find("spacing of a grid must be > 0"), std::string::npos);
  }
}

TEST(SignedDistanceGrid, RefusesMeshesThatPassThroughThemselves) {
  const std::string overlap = refusal(test::together(test::cube(), test::cube(1.0, {0.5, 0.5, 0.5})));
  EXPECT_NE(overlap.find("the mesh passes through itself: it encloses ["), std::string::npos) << overlap;
  EXPECT_NE(overlap.find("2 times, and so "), std::string::npos) << overlap;
  const std::string hollow = refusal(test::together(test::cube(), test::reversed(test::cube(0.5, {3, 0, 0}))));
  EXPECT_NE(hollow.find("-1 times"), std::string::npos) << hollow;
  // A cavity is none.
  EXPECT_EQ(refusal(test::together(test::cube(), test::reversed(test::cube(0.5)))), "");
}

TEST(SignedDistanceGrid, RefusesMeshesThatAreThinnerThanTheirGridOrTooLarge) {
  const std::string thin = refusal(test::cup(20), 0.2);
  EXPECT_NE(thin.find("of its surface is less than two spacings (0.4 m) thick, the thinnest place 0.29"),
            std::string::npos)
      << thin;
  EXPECT_NE(thin.find("set the nodes at most 0.14"), std::string::npos) << thin;
  const std::string large = refusal(test::scaled(test::cube(), 1000.0));
  EXPECT_NE(large.find("is that its scale? If so, set the nodes "), std::string::npos) << large;
  EXPECT_NE(refusal(test::cube(), 1e-300), "");
}

}  // namespace
}  // namespace hapbench::signed_distance_grid_test
