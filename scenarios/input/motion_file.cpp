#include "scenarios/input/motion_file.hpp"

#include <fmt/format.h>

#include "scenarios/input/input_error.hpp"
#include "scenarios/input/number_table.hpp"

namespace hapbench {
namespace {

constexpr std::size_t kMostSamples = 10'000'000;

[[noreturn]] void fail(const std::filesystem::path& file, std::size_t row, const std::string& problem) {
  throw InputError(InputError::Kind::relation, fmt::format("{}, sample {}", file.string(), row + 1), problem);
}

}  // namespace

RecordedMotion motion_in(std::string_view text, const std::filesystem::path& file) {
  const NumberTable table = number_table_in(text, file, "time_s,px_m,py_m,pz_m,axis_x,axis_y,axis_z", kMostSamples);
  if (table.rows() == 0) fail(file, 0, "no samples; allowed: at least one");
  std::vector<RecordedMotion::Sample> samples;
  samples.reserve(table.rows());
  for (std::size_t i = 0; i < table.rows(); ++i) {
    const auto row = table.row(i);
    const Vec3 axis(row[4], row[5], row[6]);
    const double length = axis.norm();
    if (!(length > 1e-12 && length < 1e12)) {
      fail(file, i, fmt::format("got an axis of length {}; allowed: 1e-12 ... 1e12", length));
    }
    if (i > 0 && !(samples.back().time < row[0])) {
      fail(file, i,
           fmt::format("got time {} after {}; allowed: strictly increasing times", row[0], samples.back().time));
    }
    samples.push_back({row[0], {row[1], row[2], row[3]}, axis / length});
  }
  return RecordedMotion(std::move(samples));
}

}  // namespace hapbench
