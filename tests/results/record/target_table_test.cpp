#include "results/record/target_table.hpp"

#include <gtest/gtest.h>

#include "tests/results/files.hpp"

namespace hapbench::target_table_test {
namespace {

TEST(TargetTable, WritesALineForEachTarget) {
  const test::TemporaryDirectory dir;
  TargetRow reached;
  reached.subject = 1;
  reached.trial = 2;
  reached.target = 3;
  reached.result = {1, true, 2.5};
  reached.rows_on_target = 7;
  reached.model_force = 1.5;
  reached.speed = 0.25;
  TargetRow missed;
  missed.result = {0, false, 10.0};
  write_target_table(dir / "targets.csv", {reached, missed});
  EXPECT_EQ(test::read_file(dir / "targets.csv"),
            "subject,trial,target,place,removed,time_s,rows_on_target,model_force_N,speed_m_per_s\n"
            "1,2,3,1,1,2.5,7,1.5,0.25\n"
            "0,0,0,0,0,10,0,,\n");
}

}  // namespace
}  // namespace hapbench::target_table_test
