#include "results/summary/provenance.hpp"

#include <gtest/gtest.h>

#include <regex>
#include <sstream>

namespace hapbench::provenance_test {
namespace {

TEST(Provenance, NamesTheBuild) {
  const Provenance p = provenance();
  EXPECT_TRUE(std::regex_match(p.version, std::regex(R"(\d+\.\d+\.\d+)"))) << p.version;
  EXPECT_TRUE(std::regex_match(p.commit, std::regex("unknown|[-.0-9A-Za-z_/]+"))) << p.commit;
  EXPECT_TRUE(std::regex_match(p.compiler, std::regex(R"([A-Za-z]+ \d+(\.\d+)*)"))) << p.compiler;
  EXPECT_FALSE(p.cpu.empty());
}

TEST(Provenance, NamesTheFlagsThatCanChangeNumbers) {
  EXPECT_NE(provenance().flags.find("-ffp-contract=off"), std::string::npos) << provenance().flags;
}

TEST(Provenance, CpuModelIsTheFirstOneOfCpuinfo) {
  std::istringstream cpuinfo("processor\t: 0\nmodel\t\t: 1\nmodel name\t: Some CPU @ 2 GHz\nmodel name\t: Other\n");
  EXPECT_EQ(cpu_model(cpuinfo), "Some CPU @ 2 GHz");
}

TEST(Provenance, CpuModelIsUnknownWhenCpuinfoHasNone) {
  std::istringstream without("processor\t: 0\nmodel name\t:\n");
  EXPECT_EQ(cpu_model(without), "unknown");
  std::istringstream empty;
  EXPECT_EQ(cpu_model(empty), "unknown");
}

}  // namespace
}  // namespace hapbench::provenance_test
