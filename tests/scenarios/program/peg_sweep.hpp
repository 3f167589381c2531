#pragma once

#include <gtest/gtest.h>

#include "tests/results/files.hpp"
#include "tests/scenarios/support/program.hpp"

namespace hapbench::test {

/// A sweep with a directory for what it writes.
class PegSweep : public testing::Test {
 protected:
  /// 24 runs in four environments, some of which end early.
  ProgramRun sweep(const std::string& out, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words = {
        "sweep",  "peg_in_hole_2d_shaped_stiffness",
        "--out",  (directory_ / out).string(),
        "--set",  "expect.outcome=[\"completes\",\"leaves_hole\",\"lost_contact\",\"diverges\"]",
        "--set",  "expect.metrics={}",
        "--vary", "rendering.stiffness_N_per_m=5000:20000:2",
        "--vary", "environment.spacing_m=2e-5:5e-5:4:log",
        "--vary", "rendering.algorithm=mean,summation,exact_shaping"};
    words.insert(words.end(), more.begin(), more.end());
    return hapbench(words);
  }
  std::string table(const std::string& out) const { return read_file(directory_ / out / "sweep.csv"); }
  test::TemporaryDirectory directory_;
};

}  // namespace hapbench::test
