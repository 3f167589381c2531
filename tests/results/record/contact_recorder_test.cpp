#include "results/record/contact_recorder.hpp"

#include <gtest/gtest.h>

#include "results/allocations/allocations.hpp"
#include "tests/results/files.hpp"
#include "tests/results/rows.hpp"

namespace hapbench::contact_recorder_test {
namespace {

using test::read_file;
using test::TemporaryDirectory;

const std::string kColumns = "step,time_s,index,x_m,y_m,z_m,nx,ny,nz,depth_m,gradient_x,gradient_y,gradient_z,weight";

TEST(ContactRecorder, WritesOneLineForEachRenderedContact) {
  const TemporaryDirectory dir;
  ContactBuffer contacts = test::contacts_along({{1, 2, 3}, {4, 5, 6}});
  contacts.depth[1] = 0.002;
  contacts.weight[1] = 0.5;
  ContactRecorder recorder(dir / "contacts.csv");
  recorder.on_step(test::row(7, 0.25, contacts));
  recorder.finish();
  EXPECT_EQ(read_file(dir / "contacts.csv"), kColumns +
                                                 "\n7,0.25,10,0.5,0.25,0,-1,-2,-3,0.001,1,2,3,1"
                                                 "\n7,0.25,11,0.5,0.25,0,-4,-5,-6,0.002,4,5,6,0.5\n");
}

TEST(ContactRecorder, WritesNothingForRowsWithoutContactAndRowsBetween) {
  const TemporaryDirectory dir;
  const ContactBuffer none(1);
  const ContactBuffer one = test::contacts_along({Vec3::UnitX()});
  ContactRecorder recorder(dir / "contacts.csv", 2);
  recorder.on_step(test::row(0, 0.0, none));
  recorder.on_step(test::row(1, 0.0, one));
  recorder.on_step(test::row(2, 0.0, one));
  recorder.finish();
  const auto lines = test::lines_of(read_file(dir / "contacts.csv"));
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_TRUE(lines[1].starts_with("2,"));
}

TEST(ContactRecorder, AllocatesNothingInAStep) {
  const TemporaryDirectory dir;
  const ContactBuffer contacts = test::contacts_along(std::vector<Vec3>(100, Vec3::UnitX()));
  ContactRecorder recorder(dir / "contacts.csv");
  const StepRecord r = test::row(0, 0.0, contacts);
  const std::size_t before = heap_allocations();
  for (int k = 0; k < 100; ++k) recorder.on_step(r);
  EXPECT_EQ(heap_allocations(), before);
}

}  // namespace
}  // namespace hapbench::contact_recorder_test
