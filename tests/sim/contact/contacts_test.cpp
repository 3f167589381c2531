#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include "sim/contact/contact_buffer.hpp"
#include "sim/contact/contact_query.hpp"
#include "sim/contact/contact_schedule.hpp"
#include "sim/contact/contact_source.hpp"
#include "sim/contact/multi_rate_contacts.hpp"
#include "sim/contact/spring_source.hpp"
#include "sim/contact/trace_source.hpp"
#include "sim/loop/simulation.hpp"
#include "tests/support/contact_sets.hpp"
#include "tests/support/scale.hpp"
#include "tests/support/searches.hpp"

namespace hapbench::contacts_test {
namespace {

ContactBuffer random_contacts(std::size_t n) {
  Random random(n);
  ContactBuffer contacts(n);
  for (std::size_t i = 0; i < n; ++i) {
    contacts.push(static_cast<std::uint32_t>(10 * i), random.direction(), random.direction());
    contacts.set_gradient(i, random.direction());
    contacts.depth[i] = random.uniform();
    contacts.weight[i] = random.uniform();
  }
  return contacts;
}

TEST(ContactBuffer, HasRoomForWholePacksUpToItsCapacity) {
  for (std::size_t n = 0; n <= 17; ++n) {
    const ContactBuffer contacts = random_contacts(n);
    EXPECT_EQ(contacts.padded_size() % 8, 0u);
    EXPECT_GE(contacts.padded_size(), n);
    EXPECT_GE(contacts.weight.size(), contacts.padded_size());
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(contacts.weight.data()) % 64, 0u);
  }
}

TEST(ContactBuffer, PadZeroesWhatSumsReadBeyondTheLastContact) {
  ContactBuffer contacts = random_contacts(16);
  contacts.shrink(9);
  contacts.pad();
  for (std::size_t i = 9; i < 16; ++i) {
    EXPECT_EQ(contacts.depth[i], 0.0);
    EXPECT_EQ(contacts.gradient(i), Vec3(0, 0, 0));
    EXPECT_EQ(contacts.weight[i], 0.0);
  }
  EXPECT_NE(contacts.weight[8], 0.0);
}

constexpr double kEps = std::numeric_limits<double>::epsilon();

TEST(LambdaMax, IsTheLargestEigenvalue) {
  Random random(4);
  for (std::size_t i = 0; i < test::cases(10000); ++i) {
    const Mat3 Q = test::random_rotation(random);
    Vec3 eigenvalues(random.uniform(-1.0, 2.0), random.uniform(-1.0, 2.0), random.uniform(-1.0, 2.0));
    if (i % 2 == 0) eigenvalues = {1.0, 1.0, random.uniform()};  // the largest eigenvalue is double
    const Mat3 S = Q * eigenvalues.asDiagonal() * Q.transpose();
    // The rounding errors of S and of the eigenvalue iteration change an eigenvalue by a few units in the last place of
    // the largest absolute eigenvalue.
    EXPECT_NEAR(lambda_max(S), eigenvalues.maxCoeff(), 32 * kEps * eigenvalues.cwiseAbs().maxCoeff());
  }
}

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

struct SpringContact {
  std::uint32_t spring;
  double depth;
  Vec3 gradient;
};

// Springs with gradients whose inner products with dyadic positions are exact.
const SpringSet kBilateral{{{1, 0, 0}, {-1, 0, 0}, {0, -1, 0}, {0, 0, 1}}, true};
const SpringSet kUnilateral{kBilateral.gradients, false}, kUnsigned{kBilateral.gradients, true, false};

TEST(SpringSource, HasTheContactsOfItsKindOfSprings) {
  const struct {
    const char* name;
    SpringSet springs;
    Vec3 position;
    std::vector<SpringContact> contacts;
  } kCases[] = {
      {"bilateral springs always act, with depths of either sign",
       kBilateral,
       {0.25, -0.5, 0.125},
       {{0, 0.25, {1, 0, 0}}, {1, -0.25, {-1, 0, 0}}, {2, 0.5, {0, -1, 0}}, {3, 0.125, {0, 0, 1}}}},
      {"unsigned ones have gradients along the displacement; the fourth is at its natural length",
       kUnsigned,
       {0.25, -0.5, 0.0},
       {{0, 0.25, {1, 0, 0}}, {1, 0.25, {1, 0, 0}}, {2, 0.5, {0, -1, 0}}, {3, 0.0, {0, 0, 1}}}},
      {"unilateral springs act when compressed",
       kUnilateral,
       {0.25, 0.5, 0.125},
       {{0, 0.25, {1, 0, 0}}, {3, 0.125, {0, 0, 1}}}},
      {"and not at their natural length", kUnilateral, {0, 0, 0}, {}},
      {"nor at a position that is not finite", kUnilateral, Vec3::Constant(kNaN), {}},
  };
  for (const auto& c : kCases) {
    SCOPED_TRACE(c.name);
    SpringSource source(std::make_shared<const SpringSet>(c.springs));
    EXPECT_EQ(source.capacity(), 4u);
    ContactBuffer contacts(8);
    contacts.depth.assign(16, 1.0);
    source.contacts_at({c.position, -Vec3::UnitZ()}, contacts);
    ASSERT_EQ(contacts.size(), c.contacts.size());
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      EXPECT_EQ(contacts.index[i], c.contacts[i].spring);
      EXPECT_EQ(contacts.depth[i], c.contacts[i].depth);
      EXPECT_EQ(contacts.gradient(i), c.contacts[i].gradient);
      EXPECT_EQ(contacts.normal(i), Vec3(-c.contacts[i].gradient));
      EXPECT_EQ(contacts.point(i), c.position);
    }
    for (std::size_t i = contacts.size(); i < 8; ++i) EXPECT_EQ(contacts.depth[i], 0.0) << "padded";
    EXPECT_EQ(source.work().queries, 1u);
    EXPECT_EQ(source.work().points_tested, 4u);
    source.reset();
    EXPECT_EQ(source.work().queries, 0u);
  }
}

// Compares multi-rate contacts with an independent implementation of their definition, which uses all poses of a run
// and no ring buffers.

/// Source of contacts that are a function of the pose. Their number also depends on the pose.
class PoseSource final : public ContactSource {
 public:
  void contacts_at(const ToolPose& pose, ContactBuffer& contacts) noexcept override {
    Random random(static_cast<std::uint64_t>(1e6 * std::abs(pose.position.x())));
    contacts.clear();
    for (std::uint64_t n = random.below(capacity() + 1), i = 0; i < n; ++i) {
      contacts.push(static_cast<std::uint32_t>(i), pose.position + 0.001 * random.direction(), random.direction());
      contacts.depth[i] = random.uniform(0.0, 1e-4);
      contacts.set_gradient(i, random.direction());
    }
    contacts.pad();
    ++work_.queries;
  }
  std::size_t capacity() const noexcept override { return 20; }
  void reset() noexcept override { work_ = {}; }
  const SearchWork& work() const noexcept override { return work_; }

 private:
  SearchWork work_;
};

std::vector<ToolPose> random_path(std::uint64_t seed, std::size_t rows, bool rolls) {
  Random random(seed);
  std::vector<ToolPose> path(rows);
  for (std::size_t k = 0; k < rows; ++k) {
    const Vec3 axis = (k == 0 ? random.direction() : path[k - 1].axis) + 0.1 * random.direction();
    path[k] = {1e-3 * random.direction(), axis.normalized(), rolls ? random.uniform(-3.0, 3.0) : 0.0};
  }
  return path;
}

/// Returns Q of MultiRateContacts: the shortest rotation between the axes, then the difference of the rolls.
Mat3 smallest_turn(const ToolPose& from, const ToolPose& to) {
  const Vec3 across = from.axis.cross(to.axis);
  const double angle = std::atan2(across.norm(), from.axis.dot(to.axis));
  const Mat3 turn =
      across.norm() > 0.0 ? Eigen::AngleAxisd(angle, across.normalized()).toRotationMatrix() : Mat3(Mat3::Identity());
  return Eigen::AngleAxisd(to.roll - from.roll, to.axis).toRotationMatrix() * turn;
}

TEST(TurnMatrix, IsTheSmallestTurnFollowedByTheRoll) {
  Random random(3);
  for (int i = 0; i < 1000; ++i) {
    const ToolPose from{{}, random.direction(), random.uniform(-3.0, 3.0)};
    const ToolPose near{{}, (from.axis + 1e-7 * random.direction()).normalized(), from.roll};
    const ToolPose to = i % 2 == 0 ? near : ToolPose{{}, random.direction(), random.uniform(-3.0, 3.0)};
    // Allow the rounding of a product of matrices of unit vectors, and of a rotation by an angle up to pi.
    EXPECT_TRUE(turn_matrix(from, to).isApprox(smallest_turn(from, to), 1e-12));
    EXPECT_EQ(turn_matrix(from, {Vec3::Ones(), from.axis, from.roll}), Mat3(Mat3::Identity()));
    const Mat3 over = turn_matrix(from, {{}, -from.axis, from.roll});
    EXPECT_TRUE((over * from.axis).isApprox(-from.axis, 1e-12));
    EXPECT_NEAR(over.determinant(), 1.0, 1e-12);
  }
}

/// Returns, for each step, the step of the query whose contacts are used; -1 before the first query returns.
std::vector<std::int64_t> rows_that_serve(const MultiRateSchedule& schedule, const std::set<std::int64_t>& lost,
                                          std::size_t rows) {
  std::vector<std::int64_t> serve(rows, -1);
  for (std::size_t k = 0; k < rows; ++k)
    for (std::int64_t q = 0; q + schedule.delay <= static_cast<std::int64_t>(k); q += schedule.every)
      if (!lost.contains(q)) serve[k] = q;
  return serve;
}

struct Case {
  MultiRateSchedule schedule;
  bool rolls;
};

class MultiRateContactsOfEverySchedule : public testing::TestWithParam<Case> {};
INSTANTIATE_TEST_SUITE_P(Some, MultiRateContactsOfEverySchedule,
                         testing::Values(Case{{.every = 1, .delay = 0, .dropout = 0.5}, false},
                                         Case{{.every = 4}, false}, Case{{.every = 1, .delay = 9}, false},
                                         Case{{.every = 4, .delay = 3, .linear = true}, false},
                                         Case{{.every = 3, .delay = 14, .linear = true, .dropout = 0.2}, false},
                                         Case{{.every = 5, .delay = 5, .linear = true}, true},
                                         Case{{.every = 7, .delay = 2, .dropout = 1.0}, true}));

// NOLINTNEXTLINE(readability-function-cognitive-complexity): checks every step of each schedule.
TEST_P(MultiRateContactsOfEverySchedule, AreTheFreshOnesOfTheQueryMovedAsTheToolWas) {
  const auto& [schedule, rolls] = GetParam();
  constexpr std::size_t kRows = 300;
  const std::vector<ToolPose> path = random_path(7, kRows, rolls);
  // Draw which queries are lost: one random number for each query after the first query.
  std::set<std::int64_t> lost;
  Random random(42);
  for (std::int64_t q = schedule.every; schedule.dropout > 0.0 && q < static_cast<std::int64_t>(kRows);
       q += schedule.every)
    if (random.uniform() < schedule.dropout) lost.insert(q);
  const auto serve = rows_that_serve(schedule, lost, kRows);

  MultiRateContacts source(std::make_unique<PoseSource>(), schedule, false, 42);
  std::uint64_t row = 0;
  source.follow(&row);
  PoseSource fresh;
  ContactBuffer contacts(source.capacity()), asked(source.capacity());
  std::size_t moved = 0, dropped = 0;
  for (int again = 0; again < 2; ++again, source.reset()) {
    for (row = 0; row < kRows; ++row) {
      source.contacts_at(path[row], contacts);
      ASSERT_EQ(source.schedule()->used() == nullptr, serve[row] < 0);
      if (serve[row] < 0) {
        EXPECT_TRUE(contacts.empty());
        continue;
      }
      const ToolPose &then = path[static_cast<std::size_t>(serve[row])], &now = path[row];
      ASSERT_EQ(source.schedule()->used()->row, static_cast<std::uint64_t>(serve[row]));
      fresh.contacts_at(then, asked);
      std::size_t next = 0;
      for (std::size_t i = 0; i < asked.size(); ++i) {
        const Vec3 x = asked.point(i);
        const Vec3 delta =
            now.position - then.position + smallest_turn(then, now) * (x - then.position) - (x - then.position);
        const double depth = asked.depth[i] + (schedule.linear ? asked.gradient(i).dot(delta) : 0.0);
        if (schedule.linear && depth <= 0.0) {
          ++dropped;
          continue;
        }
        ASSERT_LT(next, contacts.size());
        EXPECT_EQ(contacts.index[next], asked.index[i]);
        EXPECT_EQ(contacts.point(next), x);
        EXPECT_EQ(contacts.gradient(next), asked.gradient(i));
        // Allow a few roundings of lengths of a millimetre.
        EXPECT_NEAR(contacts.depth[next], depth, 1e-16);
        moved += static_cast<std::size_t>(depth != asked.depth[i]);
        ++next;
      }
      EXPECT_EQ(contacts.size(), next);
      // A second query within the step gives the same contacts.
      const ContactBuffer before = contacts;
      source.contacts_at(now, contacts);
      EXPECT_TRUE(test::same_contacts(before, contacts));
      for (std::size_t i = 0; i < contacts.size(); ++i) EXPECT_EQ(before.depth[i], contacts.depth[i]);
    }
    EXPECT_EQ(source.schedule()->queries, 1 + (kRows - 1) / static_cast<std::uint64_t>(schedule.every));
    EXPECT_EQ(source.schedule()->lost, lost.size());
  }
  EXPECT_EQ(moved > 0, schedule.linear);
  EXPECT_EQ(dropped > 0, schedule.linear);
}

/// Checks linear extrapolation of contacts for springs that may pull, whose contacts with a negative depth are not
/// dropped. The depth of a spring is linear in the position of the tool. If contacts are found in every eighth step and
/// their depths are extrapolated linearly between these steps, they therefore equal contacts found in every step.
TEST(MultiRateContacts, OfSpringsThatPullAreFreshWhenLinear) {
  const auto springs = std::make_shared<SpringSet>();
  Random random(1);
  for (int i = 0; i < 20; ++i) springs->gradients.push_back(random.direction());
  MultiRateContacts source(std::make_unique<SpringSource>(springs), {.every = 8, .linear = true}, true, 1);
  SpringSource fresh(springs);
  ContactBuffer a(20), b(20);
  for (const ToolPose& pose : random_path(5, 50, false)) {
    source.contacts_at(pose, a);
    fresh.contacts_at(pose, b);
    ASSERT_EQ(a.size(), 20u);
    for (std::size_t i = 0; i < 20; ++i) EXPECT_NEAR(a.depth[i], b.depth[i], 1e-18);
  }
}

TEST(TraceSource, GivesEachRowTheContactsOfTheNearestTimeWithinHalfAStep) {
  const auto trace = std::make_shared<ContactTrace>();
  const auto add = [&](double time, std::size_t n) {
    trace->times.push_back({time, trace->contacts.size()});
    for (std::size_t i = 0; i < n; ++i) trace->contacts.push_back({Vec3::UnitX(), -Vec3::UnitZ(), time});
  };
  add(-0.3, 1), add(0.9, 2), add(1.05, 3), add(1.4, 1), add(3.5, 4), add(9.0, 1);
  TraceSource source(trace, 1.0);
  EXPECT_EQ(source.capacity(), 4u);
  std::uint64_t row = 0;
  source.follow(&row);
  ContactBuffer contacts(4);
  const double times[] = {-0.3, 1.05, 0.0, 3.5, 3.5, 0.0, 0.0};
  const std::size_t sizes[] = {1, 3, 0, 4, 4, 0, 0};
  for (row = 0; row < 7; ++row) {
    source.contacts_at({}, contacts);
    ASSERT_EQ(contacts.size(), sizes[row]) << row;
    for (std::size_t i = 0; i < contacts.size(); ++i) {
      EXPECT_EQ(contacts.index[i], i);
      EXPECT_EQ(contacts.depth[i], times[row]);
      EXPECT_EQ(contacts.normal(i), Vec3::UnitZ());
    }
  }
  TraceSource empty(std::make_shared<ContactTrace>(), 1.0);
  empty.contacts_at({}, contacts);
  EXPECT_TRUE(contacts.empty());
}

}  // namespace
}  // namespace hapbench::contacts_test
