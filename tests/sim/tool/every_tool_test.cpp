#include <gtest/gtest.h>

#include <cmath>

#include "sim/geometry/point_shell.hpp"
#include "tests/support/scale.hpp"
#include "tests/support/tool_kinds.hpp"

/// Compares the results of every kind of tool with the definition of its body in long double.
namespace hapbench::every_tool_test {
namespace {

using test::cases, test::DefinedTool, test::Vec3L;

class EveryTool : public testing::TestWithParam<test::ToolKind> {
 protected:
  /// Calls check(tool, pose) with random tools of the kind, 0.1 to 1 mm thick.
  template <class Check>
  void for_tools(std::size_t n, Check check) {
    Random random(1);
    for (std::size_t i = 0; i < cases(n) && !HasFatalFailure(); ++i) {
      const DefinedTool tool = GetParam().make(random, 0.001);
      check(tool, test::random_pose(random), random);
    }
  }
};
INSTANTIATE_TEST_SUITE_P(EveryKind, EveryTool, testing::ValuesIn(test::tool_kinds().begin(), test::tool_kinds().end()),
                         [](const auto& kind) { return kind.param.name; });

/// Rounding error of coordinates up to 1 m, in a few operations [m].
constexpr double kRounding = 4e-15;

double slack_at(const DefinedTool& tool, const ToolPose& pose, const Vec3& point) {
  return static_cast<double>(tool.slack(pose, point.cast<long double>()));
}

/// Returns n contacts with random normals. Every second contact is on the tool's surface, the others are inside or near
/// the tool.
ContactBuffer contacts_around(const DefinedTool& tool, const ToolPose& pose, Random& random, std::size_t n) {
  ContactBuffer contacts(n);
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 point = i % 2 == 0 ? tool.near_point(pose, random) : tool.surface_point(pose, random);
    contacts.push(static_cast<std::uint32_t>(i), point, random.direction());
  }
  return contacts;
}

/// Calls `mark`, which sets one mark bit per point, and returns the marks of the contacts.
template <class Mark>
std::vector<bool> marked(const ContactBuffer& contacts, Mark mark) {
  const PackRange all{0, contacts.padded_size() / simd::lanes};
  std::vector<std::uint8_t> marks(all.last);
  mark(PointArrays{contacts.x.data(), contacts.y.data(), contacts.z.data()}, std::span(&all, 1), marks.data());
  std::vector<bool> found(contacts.size());
  for (std::size_t i = 0; i < found.size(); ++i) found[i] = marks[i / 8] >> i % 8 & 1;
  return found;
}

/// Returns the contacts that a search would find and pass to a depth model.
ContactBuffer colliding(const ToolShape& tool, const ToolPose& pose, ContactBuffer contacts) {
  ContactBuffer in(contacts.size());
  for (std::size_t i = contacts.size(); i < contacts.padded_size(); ++i) contacts.x[i] = PointShell::kFarAway;
  tool.push_inside(pose,
                   {contacts.index.data(), contacts.x.data(), contacts.y.data(), contacts.z.data(), contacts.nx.data(),
                    contacts.ny.data(), contacts.nz.data()},
                   contacts.padded_size() / simd::lanes, in);
  return in;
}

TEST_P(EveryTool, HoldsThePointsOfItsDefinition) {
  std::size_t held = 0, missed = 0;
  for_tools(2000, [&](const DefinedTool& tool, const ToolPose& pose, Random& random) {
    const ContactBuffer contacts = contacts_around(tool, pose, random, 100);
    const ContactBuffer found = colliding(*tool.shape, pose, contacts);
    std::size_t next = 0;
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      const double slack = slack_at(tool, pose, contacts.point(i));
      const bool holds = next < found.size() && found.index[next] == i;
      next += holds;
      if (std::abs(slack) <= kRounding) continue;
      ASSERT_EQ(holds, slack > 0.0) << slack;
      ++(holds ? held : missed);
    }
    ASSERT_EQ(next, found.size());
  });
  EXPECT_GT(held, cases(2000) * 5);
  EXPECT_GT(missed, cases(2000) * 5);
}

TEST_P(EveryTool, HasDepthsThatAreDistancesToItsSurface) {
  for_tools(2000, [&](const DefinedTool& tool, const ToolPose& pose, Random& random) {
    ContactBuffer in = colliding(*tool.shape, pose, contacts_around(tool, pose, random, 48));
    tool.shape->shortest_depths(pose, in);
    tool.shape->shortest_gradients(pose, in);
    for (std::size_t i = 0; i < in.size(); ++i) {
      ASSERT_GE(in.depth[i], 0.0);
      ASSERT_NEAR(in.depth[i], std::max(0.0, slack_at(tool, pose, in.point(i))), kRounding);
      ASSERT_NEAR(in.gradient(i).norm(), 1.0, 4 * std::numeric_limits<double>::epsilon());
      // A path of length `depth` from the point ends on the surface only if it follows the gradient.
      const Vec3L out = in.point(i).cast<long double>() + in.depth[i] * in.gradient(i).cast<long double>();
      ASSERT_NEAR(static_cast<double>(tool.slack(pose, out)), 0.0, 2 * kRounding);
    }
  });
}

TEST_P(EveryTool, HasExitsWhereRaysFirstGoOut) {
  std::size_t rays = 0, back_in = 0;
  for_tools(1000, [&](const DefinedTool& tool, const ToolPose& pose, Random& random) {
    ContactBuffer in = colliding(*tool.shape, pose, contacts_around(tool, pose, random, 24));
    for (std::size_t i = 0; i < in.size(); ++i) in.set_gradient(i, -in.normal(i));
    std::vector<double> exits(in.size());
    tool.shape->exit_distances(pose, in, exits.data());
    for (std::size_t i = 0; i < in.size(); ++i) {
      // The thesis defines the exit of a point on a cylinder's surface; other tests check it.
      if (slack_at(tool, pose, in.point(i)) < kRounding) continue;
      ++rays;
      const auto slack_after = [&](long double d) {
        return static_cast<double>(
            tool.slack(pose, in.point(i).cast<long double>() + d * in.gradient(i).cast<long double>()));
      };
      ASSERT_TRUE(exits[i] > 0.0 && std::isfinite(exits[i]));
      ASSERT_NEAR(slack_after(exits[i]), 0.0, kRounding);
      for (int k = 1; k < 50; ++k) ASSERT_GE(slack_after(exits[i] * k / 50.0L), -kRounding);
      back_in += slack_after(exits[i] + 1e-4L * tool.shape->half_width()) > kRounding;
    }
  });
  EXPECT_GT(rays, cases(1000));
  // Few rays enter the body again directly after their exit, because they pass through the air at a corner of a hollow
  // body.
  EXPECT_LE(back_in, rays / 500);
}

TEST_P(EveryTool, MarksAsNearWhateverLiesWithinTheMargin) {
  for_tools(3000, [&](const DefinedTool& tool, const ToolPose& pose, Random& random) {
    const double margin = tool.shape->half_width() * random.uniform();
    ContactBuffer contacts(16);
    for (std::uint32_t i = 0; i < 16; ++i) {
      contacts.push(i, tool.surface_point(pose, random) + margin * std::cbrt(random.uniform()) * random.direction(),
                    Vec3::UnitZ());
    }
    const std::vector<bool> near = marked(contacts, [&](auto points, auto ranges, auto marks) {
      tool.shape->mark_near(pose, margin + kRounding, points, ranges, marks);
    });
    // The argument `bounds` encloses only the first two points, so the box must contain these two points.
    const Box bounds{contacts.point(0).cwiseMin(contacts.point(1)), contacts.point(0).cwiseMax(contacts.point(1))};
    const Box box = tool.shape->box_near(pose, margin + kRounding, bounds);
    const ToolShape::Grown grown = tool.shape->grown(margin + kRounding);
    const ContactBuffer held =
        colliding(*grown.shape, {pose.position + grown.forward * pose.axis, pose.axis, pose.roll}, contacts);
    ASSERT_EQ(held.size(), contacts.size());
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      ASSERT_TRUE(near[i]);
      if (i < 2) {
        ASSERT_EQ(distance_to(box, contacts.point(i)), 0.0);
      }
    }
  });
}

TEST_P(EveryTool, MovesNoPointOfItsBodyFurtherThanItSays) {
  for_tools(5000, [&](const DefinedTool& tool, const ToolPose& from, Random& random) {
    const double turn = std::pow(10.0, random.uniform(-6.0, 0.0));
    const ToolPose to{from.position + turn * 1e-3 * random.direction(),
                      (from.axis + turn * random.direction()).normalized(), random.uniform(-3.0, 3.0)};
    const double moved = tool.shape->displacement_bound(from, to);
    ContactBuffer contacts(1);
    contacts.push(0, tool.surface_point(to, random), Vec3::UnitZ());
    ASSERT_TRUE(marked(contacts, [&](auto points, auto ranges, auto marks) {
      tool.shape->mark_near(from, moved + kRounding, points, ranges, marks);
    })[0]);
  });
}

TEST_P(EveryTool, IsAxisymmetricWhereATurnAboutItsAxisMovesNoPoint) {
  for_tools(20, [&](const DefinedTool& tool, const ToolPose& pose, Random&) {
    ToolPose rolled = pose;
    rolled.roll += 1.0;
    EXPECT_EQ(tool.shape->is_axisymmetric(), tool.shape->displacement_bound(pose, rolled) == 0.0);
  });
}

TEST_P(EveryTool, HasItsForemostPointOnTheSurfaceAndNoneBeyondIt) {
  for_tools(2000, [&](const DefinedTool& tool, const ToolPose& pose, Random& random) {
    const ContactBuffer contacts = contacts_around(tool, pose, random, 8);
    alignas(64) double x[simd::lanes], y[simd::lanes], z[simd::lanes];
    tool.shape->support_points(pose, contacts, {x, y, z});
    for (std::size_t i = 0; i < 8; ++i) {
      const Vec3 point(x[i], y[i], z[i]);
      ASSERT_NEAR(slack_at(tool, pose, point), 0.0, kRounding);
      for (int k = 0; k < 20; ++k) {
        ASSERT_GE((tool.surface_point(pose, random) - point).dot(contacts.normal(i)), -kRounding);
      }
    }
  });
}

TEST_P(EveryTool, HasConstraintsThatAreSignedDistances) {
  std::size_t convex = 0;
  for_tools(2000, [&](const DefinedTool& tool, const ToolPose& pose, Random& random) {
    convex += tool.shape->convex();
    ContactBuffer contacts = contacts_around(tool, pose, random, 16);
    tool.shape->surface_constraints(pose, Vec3::Zero(), 0.0, contacts);
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      const Vec3 point = contacts.point(i);
      const double distance = -contacts.depth[i], slack = slack_at(tool, pose, point);
      if (std::abs(slack) > kRounding) {
        ASSERT_EQ(std::signbit(distance), slack > 0.0);
      }
      ASSERT_NEAR(contacts.gradient(i).norm(), 1.0, kRounding);
      ASSERT_NEAR(slack_at(tool, pose, point - distance * contacts.gradient(i)), 0.0, kRounding);
      if (!tool.shape->convex()) continue;
      for (std::size_t k = 0; k < contacts.size(); ++k) {
        ASSERT_GE(-contacts.depth[k], distance + contacts.gradient(i).dot(contacts.point(k) - point) - kRounding);
      }
    }
  });
  EXPECT_EQ(convex > 0, GetParam().some_convex);
}

TEST_P(EveryTool, KeepsPointsOutByConstraintsIfItIsConvex) {
  std::size_t moves = 0, convex = 0;
  for_tools(5000, [&](const DefinedTool& tool, const ToolPose& pose, Random& random) {
    if (!tool.shape->convex()) return;
    ++convex;
    ContactBuffer contacts(8);
    for (std::uint32_t i = 0; i < 8; ++i) {
      // The surface normal at a contact is random or parallel to the tool's axis. In the second case, the surface is
      // parallel to the flat ends of the tool. For a move towards the surface, a constraint by an edge of the tool may
      // be replaced by the constraint of a face of the tool.
      const Vec3 normal =
          random.below(3) == 0 ? random.direction() : Vec3((random.below(2) == 0 ? 1.0 : -1.0) * pose.axis);
      contacts.push(i, tool.near_point(pose, random), normal);
    }
    const Vec3 move = 2e-3 * random.uniform() * random.direction();
    tool.shape->surface_constraints(pose, move, 1e-5, contacts);
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      if (contacts.gradient(i).dot(move) > -contacts.depth[i]) continue;
      ++moves;
      ASSERT_LE(slack_at(tool, {pose.position + move, pose.axis}, contacts.point(i)), kRounding);
    }
  });
  EXPECT_GE(moves, convex);
}

/// Returns all results of a tool for these contacts: depths, gradients, exits, constraints and support points.
std::vector<double> answers(const DefinedTool& tool, const ToolPose& pose, const ContactBuffer& contacts,
                            const Vec3& move, double slack) {
  ContactBuffer in = colliding(*tool.shape, pose, contacts);
  std::vector<double> all, exits(in.size());
  for (const std::uint32_t index : in.index) all.push_back(index);
  tool.shape->shortest_depths(pose, in);
  tool.shape->shortest_gradients(pose, in);
  tool.shape->exit_distances(pose, in, exits.data());
  ContactBuffer out = contacts;
  tool.shape->surface_constraints(pose, move, slack, out);
  AlignedDoubles x(simd::padded(out.size())), y(x), z(x);
  tool.shape->support_points(pose, out, {x.data(), y.data(), z.data()});
  for (std::size_t i = 0; i < in.size(); ++i) all.insert(all.end(), {in.depth[i], exits[i]});
  for (std::size_t i = 0; i < out.size(); ++i) {
    all.push_back(out.depth[i]);
    all.push_back((Vec3(x[i], y[i], z[i]) - pose.position).norm());
  }
  return all;
}

TEST_P(EveryTool, TwiceAsLargeHasAnswersTwiceAsLarge) {
  for (std::size_t i = 0; i < cases(500); ++i) {
    Random random(i), same(i);
    const DefinedTool tool = GetParam().make(random, 0.001), large = GetParam().make(same, 0.002);
    const ToolPose pose = test::random_pose(random);
    ContactBuffer contacts = contacts_around(tool, pose, random, 16), twice = contacts;
    for (AlignedDoubles* c : {&twice.x, &twice.y, &twice.z}) {
      for (double& value : *c) value *= 2.0;
    }
    const Vec3 move = 1e-4 * random.direction();
    const std::vector<double> once = answers(tool, pose, contacts, move, 1e-5);
    const std::vector<double> all = answers(large, {2.0 * pose.position, pose.axis}, twice, 2.0 * move, 2e-5);
    ASSERT_EQ(once.size(), all.size());
    const std::size_t indices = colliding(*tool.shape, pose, contacts).index.size();
    for (std::size_t k = 0; k < once.size(); ++k) ASSERT_EQ(all[k], (k < indices ? 1.0 : 2.0) * once[k]) << k;
  }
}

}  // namespace
}  // namespace hapbench::every_tool_test
