#pragma once

#include <gtest/gtest.h>

#include "scenarios/thesis_claims/claims.hpp"

/// Judging claims by numbers that are made up.
namespace hapbench::test {

inline const Claim& claim(const std::string& id) {
  static const std::vector<Claim> claims = all_claims();
  for (const Claim& c : claims) {
    if (c.id == id) return c;
  }
  throw std::out_of_range(id);
}

inline const PublishedNumbers& published() {
  static const PublishedNumbers numbers(HAPBENCH_SCENARIOS "/../results/reference/published");
  return numbers;
}

inline void expect_verdict(const std::string& id, const Measured& measured, Verdict verdict) {
  const Finding finding = claim(id).judge(measured, published());
  EXPECT_EQ(finding.verdict, verdict) << id << ": " << finding.measured << " / " << finding.why;
  EXPECT_FALSE(finding.measured.empty()) << id;
  EXPECT_FALSE(finding.why.empty()) << id;
}

/// Of a claim with a single case.
inline void expect_verdict(const std::string& id, const std::map<std::string, double>& values, Verdict verdict) {
  MeasuredCase single;
  for (const auto& [name, value] : values) single.values[name] = {value};
  expect_verdict(id, Measured{single}, verdict);
}

}  // namespace hapbench::test
