#include "scenarios/input/loaded_code.hpp"

#include <gtest/gtest.h>
#include <link.h>

#include <sstream>

namespace hapbench {
namespace {

std::size_t loaded_objects() {
  std::size_t count = 0;
  dl_iterate_phdr(
      [](dl_phdr_info*, std::size_t, void* counted) {
        ++*static_cast<std::size_t*>(counted);
        return 0;
      },
      &count);
  return count;
}

TEST(LoadedCodeId, HasAnIdForTheProgramAndEachOfItsLibraries) {
  std::istringstream ids(loaded_code_id());
  std::size_t count = 0;
  for (std::string id; ids >> id; ++count) {
    EXPECT_GE(id.size(), 16u) << id;  // linkers make 64 bits at least
    EXPECT_EQ(id.find_first_not_of("0123456789abcdef"), std::string::npos) << id;
  }
  EXPECT_GT(count, 2u);  // this program, the C and the C++ library
  EXPECT_LE(count, loaded_objects()) << "libraries that others load later do not count";
}

TEST(LoadedCodeId, IsTheSameEachTime) {
  EXPECT_EQ(loaded_code_id(), loaded_code_id());
}

}  // namespace
}  // namespace hapbench
